#include "core/refit/deviation.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "core/base/parallel.hpp"

namespace flowcage {
namespace {

void keep_worst(std::span<const Vec3> places, std::span<const SurfacePoint> nearest, Deviation& result) {
  for (std::size_t i = 0; i < nearest.size(); ++i) {
    if (nearest[i].status == FootStatus::failed || !(nearest[i].distance > result.max)) continue;
    result.max = nearest[i].distance;
    result.worst_place = places[i];
  }
}

/// The faces with the largest distance at one of their nine samples, worst first.
std::vector<Index> worst_faces(const SurfaceLevel& level, std::span<const SurfacePoint> nearest,
                               Index count) {
  const Index edges = level.vertex_count();
  const Index faces = edges + level.edge_count();
  std::vector<double> worst(static_cast<std::size_t>(level.face_count()));
  for (Index f = 0; f < level.face_count(); ++f) {
    worst[f] = nearest[faces + f].distance;
    for (const Index v : level.face_vertices[f]) worst[f] = std::max(worst[f], nearest[v].distance);
    for (const Index e : level.face_edges[f]) worst[f] = std::max(worst[f], nearest[edges + e].distance);
  }
  std::vector<Index> order(worst.size());
  std::iota(order.begin(), order.end(), 0);
  const auto kept = order.begin() + std::min<Index>(count, level.face_count());
  std::partial_sort(order.begin(), kept, order.end(),
                    [&](Index a, Index b) { return worst[a] != worst[b] ? worst[a] > worst[b] : a < b; });
  order.erase(kept, order.end());
  return order;
}

/// Searches the faces: first on grids of 9 x 9 places, then twice on grids of 9 x 9 places round the worst
/// ones, each an eighth of a grid's cell apart.
class FaceSearch {
 public:
  FaceSearch(const MeasuredSurface& surface, const TargetSurface& target)
      : surface_(surface), target_(target) {}

  void run(std::span<const Index> faces, Deviation& result) const {
    std::vector<LimitLocation> centres;
    for (const Index f : faces) centres.push_back({f, 0.5, 0.5, 0});
    double reach = 0.5;
    for (int round = 0; round < 3; ++round) {
      const std::vector<LimitLocation> locations = grids(centres, reach);
      std::vector<Vec3> places(locations.size());
      parallel_for(static_cast<Offset>(places.size()), 512, [&](Offset begin, Offset end) {
        for (Offset i = begin; i < end; ++i) places[i] = surface_.at(locations[i]).position;
      });
      std::vector<SurfacePoint> feet(places.size());
      target_.closest_points(places, {}, feet);
      keep_worst(places, feet, result);
      centres = worst_of_each(locations, feet);
      reach /= steps / 2;
    }
  }

 private:
  static constexpr int steps = 8;
  static constexpr std::size_t kept = 48;

  static std::vector<LimitLocation> grids(std::span<const LimitLocation> centres, double reach) {
    std::vector<LimitLocation> locations;
    for (const LimitLocation& at : centres) {
      for (int i = 0; i <= steps; ++i) {
        for (int k = 0; k <= steps; ++k) {
          locations.push_back({at.face, at.u + reach * (2.0 * i / steps - 1),
                               at.v + reach * (2.0 * k / steps - 1), at.corner});
        }
      }
    }
    return locations;  // the evaluator moves what lies outside of a face to its edge
  }

  /// The worst place of each grid, of the worst grids.
  static std::vector<LimitLocation> worst_of_each(std::span<const LimitLocation> locations,
                                                  std::span<const SurfacePoint> feet) {
    constexpr std::size_t per_grid = (steps + 1) * (steps + 1);
    std::vector<std::size_t> worst;
    for (std::size_t first = 0; first < locations.size(); first += per_grid) {
      std::size_t best = first;
      for (std::size_t i = first; i < first + per_grid; ++i) {
        if (feet[i].distance > feet[best].distance) best = i;
      }
      worst.push_back(best);
    }
    std::sort(worst.begin(), worst.end(), [&](std::size_t a, std::size_t b) {
      return feet[a].distance != feet[b].distance ? feet[a].distance > feet[b].distance : a < b;
    });
    worst.resize(std::min(worst.size(), kept));
    std::vector<LimitLocation> result;
    for (const std::size_t i : worst) result.push_back(locations[i]);
    return result;
  }

  const MeasuredSurface& surface_;
  const TargetSurface& target_;
};

}  // namespace

Deviation measure_deviation(MeasuredSurface& surface, const DeviationSettings& settings) {
  const std::vector<Vec3>& limits = surface.samples;
  std::vector<SurfacePoint> nearest(limits.size());
  settings.target.closest_points(limits, {}, nearest);
  Deviation result;
  double sum = 0;
  for (const SurfacePoint& p : nearest) sum += p.distance * p.distance;
  result.rms = std::sqrt(sum / static_cast<double>(std::max<std::size_t>(nearest.size(), 1)));
  keep_worst(limits, nearest, result);
  if (!(result.max <= settings.search_below)) return result;

  surface.prepare_evaluation();
  const std::vector<Index> faces = worst_faces(surface.level, nearest, settings.searched_faces);
  FaceSearch(surface, settings.target).run(faces, result);
  return result;
}

}  // namespace flowcage
