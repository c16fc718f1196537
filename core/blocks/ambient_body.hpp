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
  std::vector<std::array<Index, 3>> triangles;
  std::vector<Index> parent;  ///< #triangles: of the target's tessellation, or no_index on a fan
};

/// Triangles are split until no edge is longer than `longest`, so that a map can bend them.
AmbientBody ambient_body(const TargetSurface& target, double longest);

/// How much of each cell belongs to the body, [0, 1], seen along each of the three axes: columns run through
/// the grid along the axis (samples^2 a cell) and are inside of the body where the triangles were crossed
/// inward more often than outward (the other way round for a body turned inside out). A column counts in a
/// cell by its length inside, but fully where it enters and leaves the body in this one cell: so something
/// thinner than a cell (a trailing edge) is not lost. Columns whose crossings do not add up are left out.
std::array<std::vector<double>, 3> body_fractions(const VoxelGrid& grid, std::span<const Vec3> points,
                                                  std::span<const std::array<Index, 3>> triangles,
                                                  int samples = 4);

}  // namespace flowcage
