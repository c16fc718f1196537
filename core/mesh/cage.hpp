#pragma once
#include <array>
#include <string>
#include <vector>

#include "core/base/csr.hpp"

namespace flowcage {

/// The coarse polyhedron that a user draws (Rom & Brakhage 2011, section 2): any polygons, any genus, open or
/// closed. Plain data; `find_manifold_defect` and `build_surface_level` say whether it is a usable manifold.
struct Cage {
  struct Crease {
    Index a = no_index, b = no_index;  ///< end vertices of an edge of the cage
    double sharpness = infinitely_sharp;
    bool operator==(const Crease&) const = default;
  };
  struct Corner {
    Index vertex = no_index;
    double sharpness = infinitely_sharp;
    bool operator==(const Corner&) const = default;
  };

  std::vector<Vec3> points;  ///< #V, in metres once `scale_cage` was called with the file's unit
  Csr<Index> faces;          ///< #F rows of vertices, counter-clockwise seen from the fluid's side of a body
  std::vector<Crease> creases;  ///< #C, in the file's order
  std::vector<Corner> corners;
  std::vector<Index> face_patch;  ///< #F, into patch_names
  std::vector<std::string>
      patch_names;     ///< in the file's order; one unnamed patch ("") if the file has no groups
  std::string source;  ///< the file as the user named it, for messages; empty if made in code
};

}  // namespace flowcage
