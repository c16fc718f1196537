#include "core/refit/level_figures.hpp"

#include <algorithm>
#include <limits>

namespace flowcage {

double crease_deviation(const MeasuredSurface& surface, std::span<const CreaseChain> chains,
                        const FeatureMatch& match, const TargetSurface& target) {
  double worst = 0;
  for (std::size_t c = 0; c < chains.size(); ++c) {
    if (!match.chains[c].matched) continue;
    std::vector<Index> followed;  // a path may run over several chains of the target
    for (const FeaturePiece& piece : match.chains[c].path.pieces) followed.push_back(piece.chain);
    std::sort(followed.begin(), followed.end());
    followed.erase(std::unique(followed.begin(), followed.end()), followed.end());
    for (const Index edge : chains[c].edges) {
      const Vec3& at = surface.samples[surface.level.vertex_count() + edge];
      double nearest = std::numeric_limits<double>::infinity();
      for (const Index chain : followed) {
        nearest = std::min(nearest, target.closest_on_chain(chain, at).distance);
      }
      worst = std::max(worst, nearest);
    }
  }
  return worst;
}

double edge_length_ratio(const SurfaceLevel& level, std::span<const Vec3> points) {
  double worst = 1;
  for (Index f = 0; f < level.face_count(); ++f) {
    double longest = 0, shortest = std::numeric_limits<double>::infinity();
    for (const Index e : level.face_edges[f]) {
      const auto& [a, b] = level.edge_vertices[e];
      const double length = (points[a] - points[b]).norm();
      longest = std::max(longest, length);
      shortest = std::min(shortest, length);
    }
    worst = std::max(worst, shortest > 0 ? longest / shortest : std::numeric_limits<double>::infinity());
  }
  return worst;
}

}  // namespace flowcage
