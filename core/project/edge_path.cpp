#include "core/project/edge_path.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace flowcage {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();
constexpr double reach_in_edges = 0.75;
constexpr double stretch_weight = 0.1, edge_weight = 0.002, flatness_weight = 0.1;
constexpr std::size_t most_loop_starts = 6;
constexpr int most_splits = 4;  // depth of the search for a path that visits no vertex twice

/// Half the area of a polygon as a vector along its normal (Newell).
Vec3 area_vector(std::span<const Index> face, std::span<const Vec3> points) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = 1; i + 1 < face.size(); ++i) {
    sum += (points[face[i]] - points[face[0]]).cross(points[face[i + 1]] - points[face[0]]);
  }
  return sum;
}

}  // namespace

CageShape cage_shape(const SurfaceLevel& level, std::span<const Vec3> points, const TargetSurface& target) {
  CageShape shape{level, points, std::vector<double>(points.size(), 0.0),
                  std::vector<double>(level.edge_vertices.size(), 0.0)};
  for (Index v = 0; v < level.vertex_count(); ++v) {
    for (const Index e : level.vertex_edges[v]) {
      const auto& [a, b] = level.edge_vertices[e];
      shape.scales[v] += (points[a] - points[b]).norm() / level.vertex_edges.row_size(v);
    }
  }
  std::vector<Vec3> centres, normals;
  for (Index f = 0; f < level.face_count(); ++f) {
    Vec3 centre = Vec3::Zero();
    for (const Index v : level.face_vertices[f]) centre += points[v] / level.face_vertices.row_size(f);
    centres.push_back(centre);
    const Vec3 normal = area_vector(level.face_vertices[f], points);
    normals.push_back(normal.norm() > 0 ? Vec3(normal.normalized()) : Vec3::UnitZ());
  }
  std::vector<SurfacePoint> feet(centres.size());
  target.closest_compatible(centres, normals, 0.5, target.diagonal(), feet);
  for (Index e = 0; e < level.edge_count(); ++e) {
    if (level.is_boundary_edge(e)) continue;
    const auto& [f, g] = level.edge_faces[e];
    const bool same_face = feet[f].status != FootStatus::failed && feet[f].face == feet[g].face;
    shape.flatness[e] = 0.25 * (1 + normals[f].dot(normals[g])) + (same_face ? 0.5 : 0.0);
  }
  return shape;
}

struct EdgePathSearch::Table {
  const SurfaceLevel& level;
  std::span<const Vec3> points;
  std::span<const double> scales;
  std::span<const double> flatness;
  const ChainRun& run;
  Index steps = 0;                   // N
  std::vector<Index> near;           // vertices that take part
  std::vector<Index> local;          // #V: place in `near`, or no_index
  std::vector<double> squared;       // #near rows of N + 1: distance to each sample
  std::vector<Index> nearest;        // #near: sample
  std::vector<double> nearest_cost;  // #near: distance in mean edge lengths

  Index sample_at(Index i) const { return run.closed ? i % steps : i; }
  double step() const { return run.length / steps; }

  struct EdgeCost {
    double distance = 0, effort = 0;
  };
  /// Of the edge from `a` at sample i to `b` at sample k > i (unwrapped numbers).
  EdgeCost edge_cost(Index a, Index i, Index b, Index k, Index e) const {
    const Vec3 middle = 0.5 * (points[near[a]] + points[near[b]]);
    const Vec3& low = run.samples[sample_at((i + k) / 2)];
    const Vec3& high = run.samples[sample_at((i + k + 1) / 2)];
    const double ds = step() * (k - i);
    const Index row = steps + 1;
    const double mean = (squared[a * row + sample_at(i)] + squared[b * row + sample_at(k)] +
                         4 * (middle - 0.5 * (low + high)).squaredNorm()) /
                        6;
    const double length = (points[near[a]] - points[near[b]]).norm();
    return {ds * mean, ds * mean + stretch_weight * length * (length - ds) * (length - ds) +
                           (edge_weight + flatness_weight * flatness[e]) * length * length * length};
  }
};

EdgePathSearch::EdgePathSearch(const CageShape& cage, const ChainRun& run) {
  const std::span<const Vec3> points = cage.points;
  const std::span<const double> scales = cage.scales;
  auto table =
      std::make_unique<Table>(Table{cage.level, points, scales, cage.flatness, run, {}, {}, {}, {}, {}, {}});
  table->steps = static_cast<Index>(run.samples.size()) - 1;
  table->local.assign(points.size(), no_index);
  Box3 box;
  for (const Vec3& p : run.samples) box.extend(p);
  for (Index v = 0; v < static_cast<Index>(points.size()); ++v) {
    const double reach = reach_in_edges * scales[v];
    if (box.exteriorDistance(points[v]) > reach) continue;
    std::vector<double> row;
    for (const Vec3& sample : run.samples) row.push_back((points[v] - sample).squaredNorm());
    const auto nearest = std::min_element(row.begin(), row.end());
    if (*nearest > reach * reach) continue;
    table->local[v] = static_cast<Index>(table->near.size());
    table->near.push_back(v);
    table->nearest.push_back(static_cast<Index>(nearest - row.begin()));
    table->nearest_cost.push_back(std::sqrt(*nearest) / scales[v]);
    table->squared.insert(table->squared.end(), row.begin(), row.end());
  }
  table_ = std::move(table);
}

EdgePathSearch::~EdgePathSearch() = default;
EdgePathSearch::EdgePathSearch(EdgePathSearch&&) noexcept = default;

EdgePath EdgePathSearch::find_from(const Ends& ends, const EdgePathBlocks& blocks, Windows windows,
                                   int splits) const {
  const Table& t = *table_;
  const auto [first, first_sample, last] = ends;
  const Index n = t.steps, begin = t.local[first], end = t.local[last];
  EdgePath path;
  if (begin == no_index || end == no_index) return path;
  struct Record {
    double effort = infinite;
    Index from = no_index, from_sample = no_index, edge = no_index;
  };
  const auto at = [n](Index v, Index i) { return static_cast<std::size_t>(v) * (n + 1) + i; };
  std::vector<Record> records(t.near.size() * (static_cast<std::size_t>(n) + 1));
  records[at(begin, 0)].effort = 0;
  for (Index i = 0; i < n; ++i) {
    for (Index a = 0; a < static_cast<Index>(t.near.size()); ++a) {
      const Record here = records[at(a, i)];
      if (!std::isfinite(here.effort)) continue;
      const Index v = t.near[a];
      for (const Index e : t.level.vertex_edges[v]) {
        if (blocks.edge[e]) continue;
        const auto& pair = t.level.edge_vertices[e];
        const Index w = pair[0] == v ? pair[1] : pair[0], b = t.local[w];
        if (b == no_index || (b != end && (b == begin || blocks.vertex[w]))) continue;
        const double length = (t.points[v] - t.points[w]).norm();
        const double farthest = (2.5 * length + 0.5 * std::min(t.scales[v], t.scales[w])) / t.step();
        const Index limit = farthest < n - i ? i + std::max<Index>(1, static_cast<Index>(farthest)) : n;
        const double reach = reach_in_edges * t.scales[w];
        // The last vertex is reached at the run's end, any other before it.
        const auto& [low, high] = windows[b];
        for (Index k = b == end ? n : std::max(i + 1, low);
             k <= (b == end ? limit : std::min({limit, n - 1, high})); ++k) {
          if (b != end && t.squared[at(b, t.sample_at(first_sample + k))] > reach * reach) continue;
          const double effort = here.effort + t.edge_cost(a, first_sample + i, b, first_sample + k, e).effort;
          Record& there = records[at(b, k)];
          if (effort < there.effort) there = {effort, a, i, e};
        }
      }
    }
  }
  const Record* record = &records[at(end, n)];
  if (!std::isfinite(record->effort)) return path;
  path.effort = record->effort;
  double distance = 0, drawn = 0;
  Index v = end, i = n;
  path.vertices.push_back(last);
  std::vector<Index> seen_at(t.near.size(), no_index);
  while (record->edge != no_index) {
    const Index a = record->from, from = record->from_sample;
    path.edges.push_back(record->edge);
    path.vertices.push_back(t.near[a]);
    distance += t.edge_cost(a, first_sample + from, v, first_sample + i, record->edge).distance;
    drawn += (t.points[t.near[a]] - t.points[t.near[v]]).norm();
    v = a;
    i = from;
    if (seen_at[v] != no_index && record->edge != no_index && splits < most_splits) {
      // The path went back: the vertex belongs either to its earlier or to its later visit.
      const Index middle = (i + seen_at[v]) / 2;
      Windows early = windows, late = std::move(windows);
      early[v].second = std::min(early[v].second, middle);
      late[v].first = std::max(late[v].first, middle + 1);
      EdgePath a_path = find_from(ends, blocks, std::move(early), splits + 1);
      EdgePath b_path = find_from(ends, blocks, std::move(late), splits + 1);
      const bool a_best = a_path.found && (!b_path.found || a_path.effort <= b_path.effort);
      return a_best ? a_path : b_path;
    }
    seen_at[v] = i;
    record = &records[at(v, i)];
  }
  std::reverse(path.vertices.begin(), path.vertices.end());
  std::reverse(path.edges.begin(), path.edges.end());
  double scale = drawn / static_cast<double>(path.edges.size());
  const bool one_edge = path.edges.size() == 1;
  if (!t.run.closed) {
    scale = std::max(scale, (one_edge ? 1.0 : 0.5) * std::min(t.scales[first], t.scales[last]));
  }
  path.cost = std::sqrt(distance / t.run.length) / scale;
  // Once round a loop takes three edges; lengths may differ by a factor, and by a fifth of the scale where
  // the run is shorter than that. A vertex twice is a path that went back.
  const double slack = 0.2 * scale;
  std::vector<Index> sorted(path.vertices.begin() + 1, path.vertices.end());
  std::sort(sorted.begin(), sorted.end());
  path.found = std::adjacent_find(sorted.begin(), sorted.end()) == sorted.end() &&
               (first != last || path.edges.size() >= 3) &&
               (one_edge || t.run.length > 0.4 * (drawn - slack)) &&
               t.run.length < 2.5 * std::max(drawn, slack);
  return path;
}

EdgePath EdgePathSearch::find(Index first, Index last, const EdgePathBlocks& blocks) const {
  const Table& t = *table_;
  const Windows free(t.near.size(), {0, t.steps});
  if (!t.run.closed) return find_from({first, 0, last}, blocks, free, 0);
  std::vector<Index> order;
  for (Index a = 0; a < static_cast<Index>(t.near.size()); ++a) {
    if (!blocks.vertex[t.near[a]]) order.push_back(a);
  }
  std::sort(order.begin(), order.end(), [&](Index a, Index b) {
    return t.nearest_cost[a] != t.nearest_cost[b] ? t.nearest_cost[a] < t.nearest_cost[b] : a < b;
  });
  EdgePath best;
  for (std::size_t k = 0; k < std::min(order.size(), most_loop_starts); ++k) {
    const Index v = t.near[order[k]];
    EdgePath path = find_from({v, t.nearest[order[k]], v}, blocks, free, 0);
    if (path.found && (!best.found || path.effort < best.effort)) best = std::move(path);
  }
  return best;
}

}  // namespace flowcage
