#include "core/refit/boundary_planes.hpp"

#include <cmath>

namespace flowcage {

std::vector<ChainPlane> chain_planes(std::span<const CreaseChain> chains, const FeatureMatch& match,
                                     const TargetSurface& target) {
  const double tolerance = 1e-7 * target.diagonal();
  std::vector<ChainPlane> planes;
  for (Index c = 0; c < static_cast<Index>(chains.size()); ++c) {
    if (!chains[c].boundary || !match.chains[c].matched) continue;
    Box3 box;
    for (const FeaturePiece& piece : match.chains[c].path.pieces) {
      constexpr int samples = 64;
      for (int i = 0; i <= samples; ++i) {
        const double s = piece.s_begin + (piece.s_end - piece.s_begin) * i / samples;
        box.extend(target.chain_point(piece.chain, s).position);
      }
    }
    for (int axis = 0; axis < 3; ++axis) {
      if (!(box.sizes()[axis] <= tolerance)) continue;
      const double value = box.center()[axis];
      planes.push_back({c, axis, std::abs(value) <= tolerance ? 0.0 : value});
    }
  }
  return planes;
}

void impose_planes(std::span<const ChainPlane> planes, std::span<const CreaseChain> chains,
                   std::span<Vec3> control_points) {
  for (const ChainPlane& plane : planes) {
    for (const Index v : chains[plane.chain].vertices) control_points[v][plane.axis] = plane.value;
  }
}

}  // namespace flowcage
