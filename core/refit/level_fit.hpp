#pragma once
#include <span>
#include <string>
#include <vector>

#include "core/refit/boundary_planes.hpp"
#include "core/refit/fit_pass.hpp"
#include "core/refit/fit_surface.hpp"

namespace flowcage {

/// What the passes of one level work with.
struct LevelFitInput {
  const LevelSystem& level;
  const FeatureMatch& match;
  const TargetSurface& target;
  std::span<const ChainPlane> planes;
  const FitSettings& settings;
};

/// The paper's interpolating start (level 0): projects the cage's own vertices and solves limit = projection.
/// cage_points: #V.
std::vector<Vec3> interpolating_start(const LevelFitInput& input, const std::vector<Vec3>& cage_points);

/// Passes of projection and refit on one level, from control points to the best ones found: relaxed passes
/// first on coarse levels, then distances to points or to tangent planes. A pass is kept only if nothing more
/// folds and the error falls.
struct LevelFitResult {
  FitPass best;
  int passes = 0, iterations = 0;  ///< refits; CGLS steps
  std::vector<PassReport> history;
  std::string stopped_because;
};
LevelFitResult fit_level(const LevelFitInput& input, const std::vector<Vec3>& control_points);

}  // namespace flowcage
