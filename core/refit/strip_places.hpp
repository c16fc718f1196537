#pragma once
#include "core/refit/level_system.hpp"

namespace flowcage {

/// Places of the chains' samples, moved so that across strips narrower than half the samples' distance
/// opposite places lie square to each other: spread independently, they slip by more than the strip is wide,
/// and its faces fold. Both give way alike. Chains whose samples would come closer than a quarter of their
/// distance stay as they are.
ChainPlaces paired_places(const LevelSystem& level, const FeatureMatch& match, const TargetSurface& target,
                          const ChainPlaces& places);

}  // namespace flowcage
