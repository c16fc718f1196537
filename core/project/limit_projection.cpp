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

  const auto ask = [&](const std::vector<Index>& chosen, const auto& query, std::vector<SurfacePoint>& out) {
    for_each_reach(chosen, queries.lengths, settings.reach, [&](std::span<const Index> some, double reach) {
      std::vector<Vec3> points, normals;
      for (const Index i : some) {
        points.push_back(queries.points[i]);
        normals.push_back(queries.normals[i]);
      }
      std::vector<SurfacePoint> found(some.size());
      query(points, normals, reach, found);
      for (std::size_t k = 0; k < some.size(); ++k) {
        const double exact_reach = settings.reach * queries.lengths[some[k]];
        if (found[k].status != FootStatus::failed && found[k].distance <= exact_reach)
          out[some[k]] = found[k];
      }
    });
  };

  // Along the limit normal. A line that grazes the target travels far past the nearest compatible point: then
  // that one is right. No compatible point is nearer than the nearest of all, so most hits need no
  // comparison.
  std::vector<SurfacePoint> hit(count);
  ask(
      open,
      [&](const auto& points, const auto& normals, double reach, auto& found) {
        target.intersect_lines(points, normals, settings.min_cosine, reach, found);
      },
      hit);
  constexpr double grazing = 2;
  std::vector<Index> doubtful;
  for (const Index i : open) {
    const bool sure = hit[i].status != FootStatus::failed && nearest[i].status != FootStatus::failed &&
                      hit[i].distance <= grazing * nearest[i].distance;
    if (sure) {
      result[i] = hit[i];
    } else {
      doubtful.push_back(i);
    }
  }
  std::vector<SurfacePoint> compatible(count);
  ask(
      doubtful,
      [&](const auto& points, const auto& normals, double reach, auto& found) {
        target.closest_compatible(points, normals, settings.min_cosine, reach, found);
      },
      compatible);
  for (const Index i : doubtful) {
    const bool has_hit = hit[i].status != FootStatus::failed;
    const bool has_compatible = compatible[i].status != FootStatus::failed;
    if (has_hit && (!has_compatible || hit[i].distance <= grazing * compatible[i].distance)) {
      result[i] = hit[i];
    } else if (has_compatible) {
      result[i] = compatible[i];
    } else if (nearest[i].status != FootStatus::failed &&
               nearest[i].distance <= settings.reach * queries.lengths[i] &&
               queries.normals[i].dot(nearest[i].normal) > 0) {
      result[i] = nearest[i];
    }
  }
  return result;
}

}  // namespace flowcage
