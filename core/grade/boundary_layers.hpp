#pragma once
#include "core/blocks/wall_blocks.hpp"
#include "core/grade/line_cells.hpp"

namespace flowcage {

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
/// Where the sheet of blocks goes on beyond the wall (a wake, the space past a tip; mesh/chord_sheet) the
/// layers end within two diagonals of the wall's bounding box (grade/blend_layers); farther out lines have
/// relaxed_spacing.
/// Precondition: the lines are turned to the wall (volume/wall_normals). Parallel; the same bits for any
/// number of threads. Throws Error(input) when Index cannot number the points and as chord_sheet does.
BlockMesh insert_boundary_layers(const BlockMesh& mesh, const WallBlocks& blocks,
                                 const LayerSettings& settings, LayerReport& report);

}  // namespace flowcage
