#pragma once
#include <span>

#include "core/project/feature_match.hpp"
#include "core/refit/measured_surface.hpp"

namespace flowcage {

/// Largest distance, in metres, of matched creases and open edges from the CAD edges that they follow: at
/// places of the limit curve halfway between the samples of the level above, which were not fitted.
/// surface, chains: one level below the fitted one.
double crease_deviation(const MeasuredSurface& surface, std::span<const CreaseChain> chains,
                        const FeatureMatch& match, const TargetSurface& target);

/// Longest by shortest edge of a face of the limit mesh, the largest over all faces; infinite where an edge
/// has no length. points: #V limit points.
double edge_length_ratio(const SurfaceLevel& level, std::span<const Vec3> points);

}  // namespace flowcage
