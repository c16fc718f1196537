#pragma once
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/blocks/match_polyhedra.hpp"
#include "core/blocks/symmetry_plane.hpp"

namespace flowcage {

/// The faces of a polyhedron as triangles (fans about the faces' centroids; quads are rarely plane), with
/// the mirror images on the other side of the symmetry plane, so that a half model's surface is
/// closed (its rim lies in the plane).
struct TriangleSoup {
  std::vector<std::array<Vec3, 3>> triangles;
};
TriangleSoup closed_triangles(const Polyhedron& polyhedron, const std::optional<SymmetryPlane>& plane);

/// Volume inside (divergence theorem); negative when inside out.
double signed_volume(const TriangleSoup& surface);

/// How often the closed surface winds round p: 1 inside, 0 outside (van Oosterom & Strackee 1983).
double winding_number(const TriangleSoup& surface, const Vec3& p);

/// Why `outer` does not enclose `inner` without touching it, as one line with numbers; none if it does.
/// Checks: each vertex of inner is inside of outer, each of outer outside of inner, no edge of one passes
/// through a face of the other. O(#E #F).
std::optional<std::string> enclosure_defect(const Polyhedron& inner, const Polyhedron& outer,
                                            const std::optional<SymmetryPlane>& plane);

}  // namespace flowcage
