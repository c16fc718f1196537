#pragma once
#include <span>

#include "core/blocks/shell.hpp"
#include "core/mesh/block_mesh.hpp"

namespace flowcage {

/// Moves the wall's points, and the points at the other ends of its lines, to the given places (vertices of
/// the surface level that blocks/wall_blocks matches with the mesh) and carries the displacements along the
/// lines: at k of n layers by (1 - k/n) of the wall's plus k/n of the other. An empty span leaves that side
/// where it is. Points of symmetry patches are put exactly into their plane.
struct BoundaryPlaces {
  std::span<const Vec3> wall, outer;
};
void place_boundary(BlockMesh& mesh, const WallBlocks& blocks, const SurfaceLevel& level,
                    const BoundaryPlaces& places);

/// Spreads the points of each line anew on the line's own curve: first two cells of the local wall cell size
/// (smoothed over the wall in its logarithm), then geometric growth, at most `max_growth` (the first cells
/// are enlarged until it is kept). The ends stay. The start of a mesh that the optimiser then shapes.
void spread_lines(BlockMesh& mesh, const WallBlocks& blocks, double max_growth = 1.5);

/// A typical line of a shell: median length, and the median edge of its wall after `refinements`, metres.
struct TypicalLine {
  double length = 0, wall_cell = 0;
};
TypicalLine typical_line(const Shell& shell, int refinements);

/// How many layers start_volume needs so that, after `refinements`, the cells of a typical line grow by at
/// most `growth`: 1 to 16. With one layer the lines of a far field grow by 1.5 and more, which makes skewed
/// cells.
Index layers_for_growth(const Shell& shell, int refinements, double growth = 1.25);

/// Lengths of `count` cells that fill `length`: the first two `first`, then a constant ratio, at most
/// `max_growth`: `first` is enlarged until that holds. Where first * count exceeds the length: equal cells.
/// Exposed for its tests.
std::vector<double> geometric_cells(double length, Index count, double first, double max_growth);

}  // namespace flowcage
