#pragma once
#include <optional>
#include <string>

#include "core/mesh/cage.hpp"

namespace flowcage {

/// The first reason why a cage is no oriented 2-manifold (with boundary) that can be subdivided.
struct CageDefect {
  enum class Kind : std::uint8_t {
    empty,                  ///< no face
    bad_patch,              ///< face_patch has neither 0 nor #F entries, or one outside of patch_names
    point_not_finite,       ///< NaN or infinity
    face_too_small,         ///< fewer than three vertices
    index_out_of_range,     ///< a face, crease or corner names a vertex that does not exist
    face_repeats_vertex,    ///< one vertex twice in a face
    edge_overused,          ///< an edge with more than two faces
    inconsistent_faces,     ///< two faces run along an edge in the same direction
    unused_vertex,          ///< in no face
    repeated_point,         ///< two vertices with exactly the same coordinates
    several_fans,           ///< the faces at a vertex are not one fan: parts that touch in a point
    crease_is_no_edge,      ///< a crease between vertices that no face joins
    sharpness_not_positive  ///< of a crease or corner: negative or NaN
  };
  /// What `index` counts.
  enum class Element : std::uint8_t { cage, vertex, face, crease, corner };

  Kind kind = Kind::empty;
  Element element = Element::cage;
  Index index = no_index;  ///< into points, faces, creases or corners; of a pair the later one
  std::string message;  ///< one line with the place; vertices and faces are counted from 1, as in OBJ files
  std::string remedy;
};

/// The first defect, in the order of CageDefect::Kind; none if the cage is usable. Any content is safe to
/// pass. O(n log n) in the number of face corners.
std::optional<CageDefect> find_manifold_defect(const Cage& cage);

/// Throws the first defect as Error(input), "SOURCE: MESSAGE" with the cage's `source`.
void require_manifold(const Cage& cage);

}  // namespace flowcage
