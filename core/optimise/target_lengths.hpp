#pragma once
#include <span>
#include <vector>

#include "core/optimise/hex_corner.hpp"

namespace flowcage {

/// What shape the optimiser draws each cell toward; its target is a box, right-angled.
enum class TargetShape : std::uint8_t {
  /// Box of the input's own edge lengths, edge by edge: keeps spacing, growth and anisotropy along every
  /// line,
  /// so a cell near the wall keeps its height and only angles are evened out. Lengths of bad cells' edges are
  /// filled in from good cells across their layer. Right for shells and everything with a graded size.
  own_lengths,
  /// Cube of the mean cell size: evens out sizes as well. Right for uniform grids only.
  equal_cubes,
};

struct TargetLengthSettings {
  TargetShape shape = TargetShape::own_lengths;
  double good_scaled_jacobian = 0.2;  ///< edges of which every cell has more keep their own length
  int fill_sweeps = 20;               ///< averaging sweeps over the lengths that were filled in
  int smoothing_sweeps = 0;  ///< sweeps over all lengths but those between two points that cannot move
};

/// 1 / target length of the 12 edges (order of hex_edges) of each cell.
///
/// own_lengths: an edge is reliable when all its cells are good or neither end moves. Logarithms of lengths
/// spread from reliable edges to the others through the four parallel edges of each cell, front by front,
/// then are averaged by `fill_sweeps`. A geometric growth across layers is linear in the logarithm, hence
/// kept. `moves`: #points, not 0 where the point may move. Precondition: finite positions.
std::vector<std::array<float, 12>> inverse_target_lengths(std::span<const Vec3> positions,
                                                          std::span<const HexPoints> cells,
                                                          std::span<const std::uint8_t> moves,
                                                          const TargetLengthSettings& settings);

}  // namespace flowcage
