#pragma once
#include <span>

#include "core/refit/boundary_planes.hpp"

namespace flowcage {

/// The cage's level with the edges of its planar boundaries mirrored (core/mesh/mirror.hpp) where the target
/// meets the plane at a right angle: there it goes on smoothly into its mirror image. Where a part of such a
/// boundary meets the plane at another angle its edges are creases of the whole body; ends of creases that
/// pass through the plane at another angle, and ends of boundary chains without a crease, are corners. Planes
/// without any right angle (the root of a swept wing) stay plain boundaries. Of parallel planes the first is
/// taken.
SurfaceLevel symmetric_level(SurfaceLevel level, std::span<const CreaseChain> chains,
                             const FeatureMatch& match, std::span<const ChainPlane> planes,
                             const TargetSurface& target);

/// Sharp edges at each vertex of the whole body: those that run into a mirror plane go on behind it.
std::vector<Index> whole_sharp_counts(const SurfaceLevel& level);

}  // namespace flowcage
