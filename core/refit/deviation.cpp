#include "core/refit/deviation.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "core/base/parallel.hpp"
#include "core/limit/evaluate.hpp"

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

std::vector<Vec3> grid_points(const SurfaceLevel& level, std::span<const Vec3> points,
                              std::span<const Index> faces) {
  constexpr Index steps = 8;
  constexpr Index per_face = (steps + 1) * (steps + 1);
  const LimitEvaluator evaluator(level);
  std::vector<Vec3> places(faces.size() * per_face);
  parallel_for(static_cast<Offset>(faces.size()), 16, [&](Offset begin, Offset end) {
    for (Offset f = begin; f < end; ++f) {
      for (Index k = 0; k < per_face; ++k) {
        const double u = static_cast<double>(k % (steps + 1)) / steps;
        const double v = static_cast<double>(k / (steps + 1)) / steps;
        places[f * per_face + k] = evaluator.evaluate(points, {faces[f], u, v, 0}).position;
      }
    }
  });
  return places;
}

}  // namespace

Deviation measure_deviation(const SurfaceLevel& level, const StencilTable& samples,
                            std::span<const Vec3> points, const DeviationSettings& settings) {
  const std::vector<Vec3> limits = apply_stencils(samples, points);
  std::vector<SurfacePoint> nearest(limits.size());
  settings.target.closest_points(limits, {}, nearest);
  Deviation result;
  double sum = 0;
  for (const SurfacePoint& p : nearest) sum += p.distance * p.distance;
  result.rms = std::sqrt(sum / static_cast<double>(std::max<std::size_t>(nearest.size(), 1)));
  keep_worst(limits, nearest, result);
  if (!(result.max <= settings.search_below)) return result;

  const std::vector<Index> faces = worst_faces(level, nearest, settings.searched_faces);
  const std::vector<Vec3> places = grid_points(level, points, faces);
  std::vector<SurfacePoint> feet(places.size());
  settings.target.closest_points(places, {}, feet);
  keep_worst(places, feet, result);
  return result;
}

}  // namespace flowcage
