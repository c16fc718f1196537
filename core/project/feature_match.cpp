#include "core/project/feature_match.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <tuple>

#include "core/base/error.hpp"
#include "core/project/chain_places.hpp"
#include "core/project/feature_graph_samples.hpp"
#include "core/project/side_normals.hpp"
#include "core/project/tip_vertices.hpp"

namespace flowcage {
namespace {

/// Mean length of the crease edges at each end vertex: the scale of distances there.
std::vector<double> end_scales(std::span<const CreaseChain> chains, std::span<const Vec3> points) {
  std::vector<double> sum(points.size(), 0.0);
  std::vector<int> count(points.size(), 0);
  for (const CreaseChain& chain : chains) {
    for (Index i = 0; i < chain.segment_count(); ++i) {
      const Index a = chain.vertex(i);
      const Index b = chain.vertex(i + 1);
      const double length = (points[a] - points[b]).norm();
      for (const Index v : {a, b}) {
        sum[v] += length;
        ++count[v];
      }
    }
  }
  for (std::size_t v = 0; v < sum.size(); ++v) {
    if (count[v] > 0) sum[v] /= count[v];
  }
  return sum;
}

/// One-to-one assignment of the cage's crease ends to the target's corners: greedy by relative distance, then
/// exchanges that shorten the sum of squared distances and of squared errors of the connecting vectors (a
/// blunt trailing edge's two corners lie closer together than the cage's noise; the faces round them and
/// their chain tell which is which).
class CornerAssignment {
 public:
  /// sides: #V, normals of the faces round each vertex; corner_normals: a row a corner.
  struct Input {
    std::span<const CreaseChain> chains;
    std::span<const Vec3> points;
    std::span<const double> scales;
    const std::vector<Vec3>& corners;
    std::span<const std::vector<SideNormal>> sides;
    const Csr<Vec3>& corner_normals;
  };
  explicit CornerAssignment(const Input& input)
      : points_(input.points),
        scales_(input.scales),
        corners_(input.corners),
        sides_(input.sides),
        corner_normals_(input.corner_normals) {
    const std::span<const Vec3> points = points_;
    corner_of_.assign(points.size(), no_index);
    for (const CreaseChain& chain : input.chains) {
      if (chain.closed) continue;
      const Index a = chain.vertices.front();
      const Index b = chain.vertices.back();
      for (const Index v : {a, b}) {
        if (std::find(ends_.begin(), ends_.end(), v) == ends_.end()) ends_.push_back(v);
      }
      if (a != b) links_.push_back({a, b});
    }
    std::sort(ends_.begin(), ends_.end());
  }

  std::vector<Index> run(double limit) {
    struct Pair {
      double cost;
      Index vertex, corner;
    };
    std::vector<Pair> pairs;
    for (const Index v : ends_) {
      for (Index c = 0; c < static_cast<Index>(corners_.size()); ++c) {
        const double distance = (points_[v] - corners_[c]).norm() / scales_[v];
        if (distance < limit) pairs.push_back({place_cost(v, c), v, c});
      }
    }
    std::sort(pairs.begin(), pairs.end(), [](const Pair& a, const Pair& b) {
      return std::tie(a.cost, a.vertex, a.corner) < std::tie(b.cost, b.vertex, b.corner);
    });
    std::vector<bool> taken(corners_.size(), false);
    for (const Pair& pair : pairs) {
      if (corner_of_[pair.vertex] != no_index || taken[pair.corner]) continue;
      corner_of_[pair.vertex] = pair.corner;
      taken[pair.corner] = true;
    }
    for (bool improved = true; improved;) {
      improved = false;
      double best = total();
      for (const auto& [a, b] : links_) {
        if (corner_of_[a] == no_index && corner_of_[b] == no_index) continue;
        std::swap(corner_of_[a], corner_of_[b]);
        const double swapped = total();
        if (swapped < best * (1 - 1e-12)) {
          best = swapped;
          improved = true;
        } else {
          std::swap(corner_of_[a], corner_of_[b]);
        }
      }
    }
    return corner_of_;
  }

 private:
  double place_cost(Index v, Index corner) const {
    constexpr double side_weight = 0.5;
    return (points_[v] - corners_[corner]).squaredNorm() / (scales_[v] * scales_[v]) +
           side_weight * normal_mismatch(sides_[v], corner_normals_[corner]);
  }

  double total() const {
    double sum = 0;
    for (const Index v : ends_) {
      if (corner_of_[v] == no_index) continue;
      sum += place_cost(v, corner_of_[v]);
    }
    for (const auto& [a, b] : links_) {
      if (corner_of_[a] == no_index || corner_of_[b] == no_index) continue;
      const Vec3 drawn = points_[b] - points_[a];
      const Vec3 cad = corners_[corner_of_[b]] - corners_[corner_of_[a]];
      const double scale = drawn.norm() + 0.25 * std::min(scales_[a], scales_[b]);
      sum += (drawn - cad).squaredNorm() / (scale * scale);
    }
    return sum;
  }

  std::span<const Vec3> points_;
  std::span<const double> scales_;
  const std::vector<Vec3>& corners_;
  std::span<const std::vector<SideNormal>> sides_;
  const Csr<Vec3>& corner_normals_;
  std::vector<Index> corner_of_;
  std::vector<Index> ends_;
  std::vector<std::pair<Index, Index>> links_;
};

MatchQuery query_of(const CreaseChain& chain, std::span<const Vec3> points, std::span<const double> scales,
                    std::span<const std::vector<SideNormal>> edge_sides) {
  MatchQuery query;
  static_cast<DrawnChain&>(query) = drawn_chain(chain, points);
  const Index n = chain.segment_count();
  for (const double length : query.lengths) query.scale += length / n;
  for (Index i = 0; i <= n; ++i) {
    std::vector<SideNormal>& sides = query.sides.emplace_back();
    for (const Index k : {i - 1, i}) {
      if (!chain.closed && (k < 0 || k >= n)) continue;
      const auto& beside = edge_sides[chain.edges[static_cast<std::size_t>((k + n) % n)]];
      sides.insert(sides.end(), beside.begin(), beside.end());
    }
  }
  if (!chain.closed) {
    const double ends = std::min(scales[chain.vertices.front()], scales[chain.vertices.back()]);
    query.scale = std::max(query.scale, 0.5 * ends);
  }
  query.limits = query.controls;
  for (Index i = 0; i <= n; ++i) {
    if (!chain.closed && (i == 0 || i == n)) continue;
    const Vec3& before = points[chain.vertex(i == 0 ? n - 1 : i - 1)];
    const Vec3& after = points[chain.vertex(i == n ? 1 : i + 1)];
    query.limits[i] = (before + 4 * query.controls[i] + after) / 6;
  }
  return query;
}

struct Attempt {
  Index chain = no_index;
  MatchedRun run;
};

}  // namespace

FeatureMatch match_features(const SurfaceLevel& level, std::span<const Vec3> points,
                            std::span<const CreaseChain> chains, const TargetSurface& target,
                            const FeatureMatchSettings& settings) {
  const FeatureGraph& features = target.features();
  FeatureMatch result;
  const std::size_t vertex_count = static_cast<std::size_t>(level.vertex_count());
  result.chains.resize(chains.size());
  result.end_is_fixed.assign(vertex_count, false);
  result.end_position.assign(vertex_count, Vec3::Zero());
  result.end_corner.assign(vertex_count, no_index);

  // The graph's samples: eight a cage edge.
  std::vector<double> lengths;
  for (const CreaseChain& chain : chains) {
    for (Index i = 0; i < chain.segment_count(); ++i) {
      lengths.push_back((points[chain.vertex(i)] - points[chain.vertex(i + 1)]).norm());
    }
  }
  double spacing = 0;
  if (!lengths.empty()) {
    std::nth_element(lengths.begin(), lengths.begin() + static_cast<Offset>(lengths.size() / 4),
                     lengths.end());
    spacing = lengths[lengths.size() / 4] / 8;
  }
  const SampledFeatures graph = sample_features(target, spacing);
  const std::vector<double> scales = end_scales(chains, points);
  const std::vector<SideNormal> normals = face_normals(level, points);
  std::vector<std::vector<SideNormal>> vertex_sides(vertex_count), edge_sides(level.edge_faces.size());
  for (Index v = 0; v < level.vertex_count(); ++v) {
    for (const Index f : level.vertex_faces[v]) vertex_sides[v].push_back(normals[f]);
  }
  for (Index e = 0; e < level.edge_count(); ++e) {
    for (const Index f : level.edge_faces[e]) {
      if (f != no_index) edge_sides[e].push_back(normals[f]);
    }
  }
  result.end_corner =
      CornerAssignment({chains, points, scales, features.corners, vertex_sides, graph.normals}).run(0.5);
  std::vector<Index> end_node = result.end_corner;  // corners are the graph's first points

  GraphFilter filter;
  filter.used.assign(static_cast<std::size_t>(graph.piece_count), false);
  std::vector<Index> open_chains(chains.size());
  std::iota(open_chains.begin(), open_chains.end(), 0);

  const auto attempt = [&](Index c, bool other_kind) {
    const CreaseChain& chain = chains[c];
    MatchQuery query = query_of(chain, points, scales, edge_sides);
    if (!chain.closed) {
      query.first_node = end_node[chain.vertices.front()];
      query.last_node = end_node[chain.vertices.back()];
    }
    filter.sharp = !chain.boundary || other_kind;
    filter.boundary = chain.boundary || other_kind;
    MatchedRun run = find_run(graph, query, filter);
    run.found = run.found && run.cost <= settings.cost_limit;
    return run;
  };
  const auto accept = [&](Index c, const MatchedRun& run) {
    const CreaseChain& chain = chains[c];
    for (const Index piece : run.pieces) filter.used[piece] = true;
    if (!chain.closed) {
      end_node[chain.vertices.front()] = run.nodes.front();
      end_node[chain.vertices.back()] = run.nodes.back();
    }
    ChainMatch& match = result.chains[c];
    match.matched = true;
    match.path = run.path;
    match.s = run.s;
    match.cost = run.cost;
    const std::vector<std::string> warnings =
        place_vertices(target, drawn_chain(chain, points), settings, match);
    result.warnings.insert(result.warnings.end(), warnings.begin(), warnings.end());
  };

  // Best first; a run that meets a taken one is sought again without it.
  for (const bool other_kind : {false, true}) {
    std::vector<Attempt> attempts;
    attempts.reserve(open_chains.size());
    for (const Index c : open_chains) attempts.push_back({c, attempt(c, other_kind)});
    std::vector<Index> failed;
    while (!attempts.empty()) {
      const auto best = std::min_element(attempts.begin(), attempts.end(), [](const auto& a, const auto& b) {
        if (a.run.found != b.run.found) return a.run.found;
        return a.run.cost < b.run.cost;
      });
      Attempt now = std::move(*best);
      attempts.erase(best);
      if (!now.run.found) {
        failed.push_back(now.chain);
        continue;
      }
      const CreaseChain& chain = chains[now.chain];
      const bool taken = std::any_of(now.run.pieces.begin(), now.run.pieces.end(),
                                     [&](Index piece) { return filter.used[piece]; });
      const auto moved = [&](Index vertex, Index node) {
        return end_node[vertex] != no_index && end_node[vertex] != node;
      };
      const bool ends_moved = !chain.closed && (moved(chain.vertices.front(), now.run.nodes.front()) ||
                                                moved(chain.vertices.back(), now.run.nodes.back()));
      if (taken || ends_moved) {
        attempts.push_back({now.chain, attempt(now.chain, other_kind)});
        continue;
      }
      if (other_kind) {
        result.warnings.push_back(
            fmt::format("{} of the cage at {} follows {} of the CAD",
                        chain.boundary ? "open edges" : "a crease", place(points[chain.vertices[0]]),
                        chain.boundary ? "sharp edges (no open boundary is there)" : "an open boundary"));
      }
      accept(now.chain, now.run);
    }
    std::sort(failed.begin(), failed.end());
    open_chains = failed;
  }
  for (const Index c : open_chains) {
    const CreaseChain& chain = chains[c];
    result.warnings.push_back(fmt::format(
        "{} of the cage from {} to {} follows no sharp edge of the CAD: it is laid on the nearest surface",
        chain.boundary ? "the open boundary" : "a crease", place(points[chain.vertices.front()]),
        place(points[chain.vertices.back()])));
  }

  for (std::size_t v = 0; v < vertex_count; ++v) {
    if (end_node[v] == no_index) continue;
    result.end_is_fixed[v] = true;
    result.end_position[v] = graph.points[end_node[v]];
    result.end_corner[v] = end_node[v] < graph.corner_count ? end_node[v] : no_index;
  }
  const std::vector<Index> at_tips = tip_vertices(level, points, features.tips);
  for (std::size_t t = 0; t < at_tips.size(); ++t) {
    const Index v = at_tips[t];
    if (v == no_index || end_node[v] != no_index || level.vertex_sharpness[v] < infinitely_sharp) continue;
    result.end_is_fixed[v] = true;
    result.end_position[v] = features.tips[t];
  }
  std::vector<double> followed(features.chains.size(), 0.0);
  for (Index p = 0; p < graph.piece_count; ++p) {
    if (filter.used[p]) followed[graph.piece_chain[p]] += graph.piece_length[p];
  }
  for (Index c = 0; c < static_cast<Index>(features.chains.size()); ++c) {
    if (followed[c] < 0.5 * features.chains[c].length) result.unmatched_chains.push_back(c);
  }
  return result;
}

}  // namespace flowcage
