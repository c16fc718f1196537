#pragma once
#include <vector>

#include "core/refit/fit_pass.hpp"

namespace flowcage {

/// Control points (#V) near those of `pass` whose limit quads round the pass's folded faces are convex: each
/// corner's sine is brought to a small positive value by the least change of the control vertices between
/// creases (cyclic projection onto the linearised constraints; Kaczmarz 1937). Creases stay. Where it does
/// not succeed in a fixed number of sweeps the points are as far as it came: evaluate them. Metres.
std::vector<Vec3> unfolded_points(const LevelSystem& level, const FitPass& pass);

}  // namespace flowcage
