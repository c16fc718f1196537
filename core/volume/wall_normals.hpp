#pragma once
#include <vector>

#include "core/blocks/wall_blocks.hpp"
#include "core/volume/wall_columns.hpp"

namespace flowcage {

/// How far and how strictly the block lines are turned toward the wall's normals.
struct NormalSettings {
  double reach = 0.25;       ///< R of every line at first, in diagonals of the wall's bounding box
  double keep = 0.9;         ///< a cell may lose a tenth of its scaled Jacobian to the turn,
  double good_enough = 0.3;  ///< or more as long as it stays above this
  int max_passes = 40;       ///< of cutting back
};

struct NormalReport {
  double min_cosine_before = 1, min_cosine = 1;  ///< of the angle between a line and the wall's normal there
  double mean_cosine_before = 1, mean_cosine = 1;  ///< 1: orthogonal
  double mean_reach = 0;  ///< mean of weight times R, in diagonals; 0: no line could be turned
  int passes = 0;
};

/// Turns the lines that leave the wall toward its normal. A point at distance r along its line moves by
///   w r / (1 + (r / R)^2) * (1 - r / length) * (n - t),
/// t the line's own direction at the wall, n the direction in which the worst of the cells there gets the
/// best scaled Jacobian (volume/corner_fan; on smooth walls the normal, at an edge the middle of its cone), w
/// the line's weight, 1 at first, R its reach. Where a cell would fall below min(good_enough, keep x its
/// value before), weight and reach of its lines are cut back, at last to 0, and those of lines nearby follow
/// with a bounded slope: no cell becomes inverted. Wall, outer boundary and symmetry plane stay exactly.
/// Deterministic for any number of threads. Layers (grade/boundary_layers) come afterwards: then the first
/// height is that along the turned line.
NormalReport turn_lines_to_wall(BlockMesh& mesh, const WallBlocks& blocks, const NormalSettings& settings);

/// The direction n above for each of the columns' lines; inside the plane for lines in a symmetry plane; zero
/// where there is none.
std::vector<Vec3> line_normals(const BlockMesh& mesh, const WallBlocks& blocks, const WallColumns& columns);

}  // namespace flowcage
