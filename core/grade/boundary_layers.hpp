#pragma once
#include <span>
#include <vector>

#include "core/blocks/wall_blocks.hpp"

namespace flowcage {

/// Wall spacing that was asked for.
struct LayerSettings {
  double first_height = 0;  ///< metres, > 0: distance of the first points from the wall
  double growth = 1.2;      ///< > 1, from cell to cell after two constant cells
  Index layers = 0;         ///< cells that follow first_height and growth exactly; 0: the first two
};

/// What came out of it.
struct LayerReport {
  Index cells = 0;                        ///< along each line
  double min_height = 0, max_height = 0;  ///< first cell along its line, metres
  double max_growth = 1;                  ///< largest ratio of neighbouring cells along a line, either way
};

/// Grades the lines that leave the wall: cells start with the first height, grow geometrically and pass into
/// the sizes that the mesh has there where they meet them; farther out the mesh keeps its layers. The result
/// has the same blocks and more divisions.
///
/// Spacing is made on the mean line (S(t), t = 0 .. n, the geometric mean of the lines' lengths to their
/// layers) and carried to each line by the layer coordinate: with sigma(k) the mean line's new lengths and
/// t(k) = S^-1(sigma(k)), line i has
///   s_i(k) = S_i(t(k)) rho_i(k),   rho_i(k) = sigma(k) / S_i(t(k)) as long as cells are thin,
/// from there log rho_i falls to 0 with log S_i, within three of the mesh's own layers or more slowly. So all
/// lines have the same first cells, outer layers stay as smooth as they are, and the growth differs little
/// between lines. A line leaves the wall along its normal where it did not lean by more than 60 degrees.
///
/// The first height is a distance from the wall: along a line that leans, it is divided by the least cosine
/// to the wall's normals, up to 1.19, the root of the factor at a concave right angle, where distance and
/// length along the line are then off by 16 and 19 %. On convex edges the line's length is the distance.
/// Precondition: the lines are turned to the wall (volume/wall_normals). Parallel; the same bits for any
/// number of threads. Throws Error(input) when Index cannot number the points.
BlockMesh insert_boundary_layers(const BlockMesh& mesh, const WallBlocks& blocks,
                                 const LayerSettings& settings, LayerReport& report);

/// Cell sizes along one line: `lengths` (ascending from 0) is where its points are. With f(s) the wanted size
/// at s, first height, growth, then the line's own sizes, cell limits are where the integral of 1 / f is a
/// whole number; the growth is lowered until it is one at the end.
std::vector<double> graded_cells(std::span<const double> lengths, const LayerSettings& settings);

}  // namespace flowcage
