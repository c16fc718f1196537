#pragma once
#include <memory>
#include <span>
#include <vector>

#include "core/refit/level_fit.hpp"

namespace flowcage {

/// Level 0 of the loop: what the cage's creases follow, and the fitted cage.
struct CageFit {
  FeatureMatch match;
  std::vector<ChainPlane> planes;
  std::unique_ptr<LevelSystem> level;
  LevelFitResult fitted;
};

/// Matches a cage's creases and fits its level 0, from the vertices as they are drawn and from vertices
/// evened out between the creases' places; the better one is kept. If faces still fold, places that the
/// drawing may mean as well (other_places) are tried for the creases round those faces, one at a time, for as
/// long as fewer faces fold.
CageFit fit_cage(const Cage& cage, const TargetSurface& target, const FitSettings& settings);

}  // namespace flowcage
