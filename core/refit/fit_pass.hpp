#pragma once
#include <span>
#include <vector>

#include "core/project/limit_projection.hpp"
#include "core/refit/level_system.hpp"

namespace flowcage {

/// What a pass of the loop sees: limit points, their places on the target, errors and folds. Metres.
struct FitPass {
  std::vector<Vec3> control_points;  ///< #V
  LimitState limit;
  std::vector<SurfacePoint> feet;  ///< #samples; of relaxed points while relaxing
  std::vector<Vec3> targets;       ///< #samples, the paper's L^s
  ChainPlaces places;
  std::vector<Vec3> chain_tangents;  ///< #samples; the path's direction there, zero elsewhere
  double rms = 0, max = 0;
  std::vector<Index> folded;  ///< faces, ascending

  /// What has to fall from pass to pass: the mean error, with a share of the largest one.
  double score() const { return rms + 0.2 * max; }
  Index folds() const { return static_cast<Index>(folded.size()); }
};

struct PassMode {
  double relaxation = 0;  ///< share of the way to evened-out places that is taken before projecting
  bool slide = false;     ///< chain samples move along their paths to the nearest place
};

/// The places of the chains' samples moved along their paths to the nearest of the limit points (#samples);
/// corners at the ends stay. A chain stays as it is if neighbours would come closer than a quarter of their
/// distance, or of that at the level's start, and where its path turns corners.
ChainPlaces slid_places(const LevelSystem& level, const FeatureMatch& match, const TargetSurface& target,
                        const ChainPlaces& places, std::span<const Vec3> limits);

/// Projects the limit points of `control_points` to the target. `previous` (hints, places on chains) may be
/// null: chain samples then start at the level's.
FitPass evaluate_pass(const LevelSystem& level, const FeatureMatch& match, const TargetSurface& target,
                      std::vector<Vec3> control_points, const PassMode& mode, const FitPass* previous);

/// Distances to tangent planes and tangent lines for the next solve: the way along the target counts only
/// tangential_weight (the damping of the Gauss-Newton step; Wang, Pottmann & Liu 2006).
StageMetrics tangent_metrics(const LevelSystem& level, const FitPass& pass, double tangential_weight);

/// project_limit_points for the samples that have no place on a feature; the others stay `failed`.
std::vector<SurfacePoint> project_samples(const LevelSystem& level, const TargetSurface& target,
                                          std::span<const Vec3> queries, const LimitState& limit,
                                          std::span<const SurfacePoint> hints,
                                          const LimitProjectionSettings& settings = {});

}  // namespace flowcage
