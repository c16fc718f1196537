#pragma once
#include "core/blocks/shell.hpp"
#include "core/mesh/block_mesh.hpp"

namespace flowcage {

/// How far and how strictly the block lines are turned toward the wall's normals.
struct NormalSettings {
  double reach =
      0.25;           ///< distance at which half of the turn is left, in diagonals of the wall's bounding box
  double keep = 0.9;  ///< a cell may lose this share of its scaled Jacobian to the turn,
  double good_enough = 0.3;  ///< unless it stays above this
  int max_passes = 20;       ///< of cutting back at one reach; then the reach is halved, three times at most
};

struct NormalReport {
  double min_cosine_before = 1, min_cosine = 1;  ///< of the angle between a line and the wall's normal there
  double mean_cosine_before = 1, mean_cosine = 1;  ///< 1: orthogonal
  double mean_weight = 0;                          ///< 1: every line was turned fully
  double reach = 0;  ///< that was used, as in the settings; 0: no line could be turned
  int passes = 0;
};

/// Turns the lines that leave the wall toward its normal. A point at distance r along its line moves by
///   weight * r / (1 + (r / R)^2) * (1 - r / length) * (n - t),
/// t the line's own direction at the wall, n the direction with the largest least cosine to the normals of
/// the wall's faces there (at an edge or corner of the body the middle of its cone), R the reach. The weight
/// of each line starts at 1 and is cut back, with those of its neighbours smoothed after it, wherever a cell
/// would fall below min(good_enough, keep x its value before): no cell becomes inverted. If that does not
/// settle, a shorter reach is tried. Wall, outer boundary and symmetry plane stay exactly. Deterministic for
/// any number of threads. Call it when the points are spread as they shall be (respace_lines) and re-space
/// afterwards: the first height is then that along the turned line.
NormalReport turn_lines_to_wall(BlockMesh& mesh, const Shell& shell, const NormalSettings& settings);

}  // namespace flowcage
