#pragma once
#include "core/blocks/shell.hpp"
#include "core/mesh/block_mesh.hpp"

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
/// t the line's own direction at the wall, n the direction with the largest least cosine to the normals of
/// the wall's faces there (at an edge or corner of the body the middle of its cone), w the line's weight, 1
/// at first, R its reach. Where a cell would fall below min(good_enough, keep x its value before), weight and
/// reach of its lines are cut back, at last to 0, and those of lines nearby follow with a bounded slope: no
/// cell becomes inverted. Wall, outer boundary and symmetry plane stay exactly. Deterministic for any number
/// of threads. Call it when the points are spread as they shall be (respace_lines) and re-space afterwards:
/// then the first height is that along the turned line.
NormalReport turn_lines_to_wall(BlockMesh& mesh, const Shell& shell, const NormalSettings& settings);

}  // namespace flowcage
