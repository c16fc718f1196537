#pragma once
#include <optional>
#include <span>
#include <vector>

#include "core/blocks/outer_shape.hpp"
#include "core/blocks/symmetry_plane.hpp"
#include "core/mesh/surface_level.hpp"

namespace flowcage {

/// A surface laid out on a box so that the box's edges run along the surface's own edges.
struct BoxLayout {
  std::vector<Vec3> points;                              ///< #V, on the box
  std::vector<double> edge_sharpness, vertex_sharpness;  ///< #E, #V: creases on the box's edges, its corners
};

/// Finds vertices for the box's corners (nearest in direction, at most 40 degrees off), disjoint shortest
/// paths of edges for its edges, and lays the faces between them out by Tutte's barycentric map. None where
/// the connectivity does not allow it: no such vertex or path, a region that is no side of the box, a quad
/// with a straight or inverted corner, or a line from the wall (normals `wall_normals`, one a quad corner, 4
/// f
/// + c) that would leave the fluid's side. Then the far field is the central projection: its points lie on
/// the box, and the cells that cross a box edge cut it.
/// `directions` is a fold-free map to the sphere.
std::optional<BoxLayout> lay_out_on_box(const SurfaceLevel& level, std::span<const Vec3> directions,
                                        const OuterShape& box, const std::optional<SymmetryPlane>& plane,
                                        std::span<const Vec3> wall_normals);

}  // namespace flowcage
