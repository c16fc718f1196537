#pragma once
#include <span>

#include "core/blocks/shell.hpp"
#include "core/mesh/block_mesh.hpp"

namespace flowcage {

/// Moves the wall's and the outer boundary's points to the given places (vertices of the surface level that
/// blocks/shell_lines matches with the mesh) and carries the displacements into the volume along the block
/// lines: at k of n layers by (1 - k/n) of the wall's plus k/n of the outer one. An empty span leaves that
/// side where it is. Points of the symmetry patch are put exactly into its plane.
struct BoundaryPlaces {
  std::span<const Vec3> wall, outer;
};
void place_boundary(BlockMesh& mesh, const Shell& shell, const SurfaceLevel& level,
                    const BoundaryPlaces& places);

/// How points are spread along the lines from wall to outer boundary.
struct LineSpacing {
  double first_height = 0;  ///< metres along the line; 0: the local size of the wall's cells
  double growth = 1.2;      ///< from cell to cell in the layers, after two constant cells
  Index layers = 0;  ///< cells that follow first_height and growth exactly; 0: growth follows from the rest
  double max_growth =
      1.5;  ///< with first_height 0: the first cell is enlarged until the growth keeps to this
};

/// What came out of it.
struct SpacingReport {
  double min_first = 0, max_first = 0;  ///< first cell along its line
  double max_growth = 1;                ///< largest ratio of neighbouring cells along a line
};

/// Spreads the points of each line anew on the line's own curve (a C1 cubic through its points, by chord
/// length): first two cells of the first height, then geometric growth. The ends stay. With first_height 0
/// the local wall cell size, smoothed over the wall in its logarithm, is the first height.
SpacingReport respace_lines(BlockMesh& mesh, const Shell& shell, const LineSpacing& spacing);

/// How many layers start_volume needs so that, after `refinements`, the cells of a typical line (median
/// length, median wall cell or spacing.first_height) grow by at most `growth`: 1 to 16. With one layer the
/// lines of a far field grow by 1.5 and more, which makes skewed cells.
Index layers_for_growth(const Shell& shell, int refinements, const LineSpacing& spacing,
                        double growth = 1.25);

/// Lengths of `count` cells that fill `length`: the first two `first`, then a constant ratio; with `layers`
/// the first that many cells grow by `growth` and the ratio holds for the rest. Where first * count exceeds
/// the length: equal cells. Exposed for its tests.
std::vector<double> geometric_cells(double length, Index count, const LineSpacing& spacing);

}  // namespace flowcage
