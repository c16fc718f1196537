#pragma once
#include <array>
#include <functional>
#include <span>
#include <vector>

#include "core/blocks/voxel_grid.hpp"
#include "core/target/target_surface.hpp"

namespace flowcage {

/// The CAD as triangles that enclose something: its tessellation, and fans that close its open rims.
struct AmbientBody {
  std::vector<Vec3> points;
  std::vector<std::array<Index, 3>> triangles;  ///< the CAD's first, in its order
  std::vector<Index> triangle_face;             ///< #CAD triangles: the CAD's face
  Index cad_triangles() const { return static_cast<Index>(triangle_face.size()); }
};
AmbientBody ambient_body(const TargetSurface& target);

/// How much of each cell lies in the body, [0, 1]: the share of samples^3 points of the cell about which the
/// triangles wind at least half a time either way (so parts that pass through each other are one, and open
/// shells of either side count).
std::vector<double> body_fractions(const VoxelGrid& grid, std::span<const Vec3> points,
                                   std::span<const std::array<Index, 3>> triangles, int samples = 3);

}  // namespace flowcage
