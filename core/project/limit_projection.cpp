#include "core/project/limit_projection.hpp"

#include <algorithm>
#include <cassert>

namespace flowcage {
namespace {

/// Runs `query` on the chosen samples, grouped by their reach (the seam takes one distance a call).
template <typename Query>
void for_each_reach(const std::vector<Index>& chosen, std::span<const double> lengths, double factor,
                    const Query& query) {
  // Octaves of length: a reach at most twice as far as asked for, cut back exactly by the caller.
  std::vector<Index> sorted = chosen;
  std::sort(sorted.begin(), sorted.end(),
            [&](Index a, Index b) { return lengths[a] != lengths[b] ? lengths[a] > lengths[b] : a < b; });
  std::size_t begin = 0;
  while (begin < sorted.size()) {
    const double reach = factor * lengths[sorted[begin]];
    std::size_t end = begin;
    while (end < sorted.size() && factor * lengths[sorted[end]] >= 0.5 * reach) ++end;
    if (end == begin) return;  // lengths of zero or NaN: nothing is within reach
    query(std::span<const Index>(sorted).subspan(begin, end - begin), reach);
    begin = end;
  }
}

}  // namespace

std::vector<SurfacePoint> project_limit_points(const TargetSurface& target, const LimitQueries& queries,
                                               const LimitProjectionSettings& settings) {
  const std::size_t count = queries.points.size();
  assert(queries.normals.size() == count && queries.lengths.size() == count);
  std::vector<SurfacePoint> nearest(count);
  target.closest_points(queries.points, queries.hints, nearest);

  std::vector<SurfacePoint> result(count);
  std::vector<Index> open;
  for (std::size_t i = 0; i < count; ++i) {
    const bool no_normal = queries.normals[i].isZero(0);
    const bool found = nearest[i].status != FootStatus::failed;
    const double cosine = found ? queries.normals[i].dot(nearest[i].normal) : -1;
    const bool close = found && nearest[i].distance <= settings.near * queries.lengths[i];
    if (found && (no_normal ||
                  (close && cosine >= settings.min_cosine && nearest[i].status == FootStatus::interior))) {
      result[i] = nearest[i];
    } else if (!no_normal) {
      open.push_back(static_cast<Index>(i));
    }
  }

  // Along the limit normal and, beside it, the nearest compatible point.
  std::vector<SurfacePoint> hit(count);
  std::vector<SurfacePoint> compatible(count);
  for_each_reach(open, queries.lengths, settings.reach, [&](std::span<const Index> some, double reach) {
    std::vector<Vec3> points, normals;
    for (const Index i : some) {
      points.push_back(queries.points[i]);
      normals.push_back(queries.normals[i]);
    }
    std::vector<SurfacePoint> found(some.size());
    target.intersect_lines(points, normals, settings.min_cosine, reach, found);
    for (std::size_t k = 0; k < some.size(); ++k) hit[some[k]] = found[k];
    target.closest_compatible(points, normals, settings.min_cosine, reach, found);
    for (std::size_t k = 0; k < some.size(); ++k) compatible[some[k]] = found[k];
  });
  for (const Index i : open) {
    const double reach = settings.reach * queries.lengths[i];
    const auto within = [&](const SurfacePoint& p) {
      return p.status != FootStatus::failed && p.distance <= reach;
    };
    // A line that grazes the target travels far past the nearest compatible point: then that one is right.
    if (within(hit[i]) && (!within(compatible[i]) || hit[i].distance <= 2 * compatible[i].distance)) {
      result[i] = hit[i];
    } else if (within(compatible[i])) {
      result[i] = compatible[i];
    } else if (within(nearest[i]) && queries.normals[i].dot(nearest[i].normal) > 0) {
      result[i] = nearest[i];
    }
  }
  return result;
}

}  // namespace flowcage
