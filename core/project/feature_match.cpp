#include "core/project/feature_match.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <tuple>

#include "core/base/error.hpp"
#include "core/project/feature_graph_samples.hpp"
#include "core/project/side_normals.hpp"

namespace flowcage {
namespace {

std::size_t piece_at(const FeaturePath& path, double s) {
  const auto above = std::upper_bound(path.offsets.begin() + 1, path.offsets.end() - 1, s);
  return static_cast<std::size_t>(above - path.offsets.begin()) - 1;
}

double wrapped(const FeaturePath& path, double s) {
  const double length = path.length();
  if (!path.closed || !(length > 0)) return std::clamp(s, 0.0, length);
  s = std::fmod(s, length);
  return s < 0 ? s + length : s;
}

CurvePoint point_on_piece(const TargetSurface& target, const FeaturePiece& piece, double along) {
  const bool forward = piece.s_end >= piece.s_begin;
  CurvePoint point = target.chain_point(piece.chain, piece.s_begin + (forward ? along : -along));
  if (!forward) point.tangent = -point.tangent;
  return point;
}

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
  query.closed = chain.closed;
  const Index n = chain.segment_count();
  for (Index i = 0; i <= n; ++i) query.controls.push_back(points[chain.vertex(i)]);
  for (Index i = 0; i < n; ++i) {
    query.lengths.push_back(
        std::max((query.controls[i + 1] - query.controls[i]).norm(), std::numeric_limits<double>::min()));
  }
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

/// Joints of the path where it turns by more than the angle: path lengths, ascending.
std::vector<double> kinks_of(const TargetSurface& target, const FeaturePath& path, double angle) {
  std::vector<double> kinks;
  const std::size_t n = path.pieces.size();
  for (std::size_t p = 0; p < n; ++p) {
    if (p + 1 == n && !path.closed) break;
    const double length = path.offsets[p + 1] - path.offsets[p];
    const Vec3 before = point_on_piece(target, path.pieces[p], length).tangent;
    const Vec3 after = point_on_piece(target, path.pieces[(p + 1) % n], 0).tangent;
    if (before.dot(after) < std::cos(angle)) kinks.push_back(path.offsets[p + 1]);
  }
  return kinks;
}

/// Moves the free places along the path so that distances to the cage and stretch against it are least
/// squares, in Gauss-Seidel sweeps: Viterbi's places are samples of the graph.
void relax_places(const TargetSurface& target, const MatchQuery& query, const std::vector<bool>& pinned,
                  ChainMatch& match) {
  const std::size_t n = query.lengths.size();
  const double total = match.path.length();
  double drawn = 0;
  for (const double length : query.lengths) drawn += length;
  const double ratio = total / drawn;
  std::vector<double>& s = match.s;
  double moved_most = total;
  for (int sweep = 0; sweep < 200 && moved_most > 1e-10 * total; ++sweep) {
    moved_most = 0;
    for (std::size_t k = query.closed ? 0 : 1; k < n; ++k) {
      if (pinned[k]) continue;
      const double before = k == 0 ? s[n - 1] - total : s[k - 1];
      const double after = s[k + 1];
      const double length_before = ratio * query.lengths[k == 0 ? n - 1 : k - 1];
      const double length_after = ratio * query.lengths[k];
      const CurvePoint at = point_on_path(target, match.path, s[k]);
      const double to_control = (query.controls[k] - at.position).dot(at.tangent);
      const double stretch = before + length_before - s[k] + after - length_after - s[k];
      const double margin = 0.1 * (after - before);
      const double moved = std::clamp(s[k] + (to_control + stretch) / 3, before + margin, after - margin);
      moved_most = std::max(moved_most, std::abs(moved - s[k]));
      s[k] = moved;
      if (query.closed && k == 0) s[n] = s[0] + total;
    }
  }
}

/// Slopes of the cubic spline through s (natural at ends, periodic on loops), cut back where Fritsch and
/// Carlson's condition for a monotone cubic asks for it.
std::vector<double> monotone_slopes(const std::vector<double>& s, bool closed) {
  const std::size_t n = s.size() - 1;
  std::vector<double> step(n);
  for (std::size_t i = 0; i < n; ++i) step[i] = s[i + 1] - s[i];
  std::vector<double> m(n + 1);
  m[0] = step[0];
  m[n] = step[n - 1];
  for (std::size_t i = 1; i < n; ++i) m[i] = 0.5 * (step[i - 1] + step[i]);
  if (closed) m[0] = m[n] = 0.5 * (step[0] + step[n - 1]);
  // m[i-1] + 4 m[i] + m[i+1] = 3 (step[i-1] + step[i]) inside, 2 m[0] + m[1] = 3 step[0] at natural ends:
  // diagonally dominant, so sweeps converge by a factor 4 each.
  for (int sweep = 0; sweep < 60; ++sweep) {
    if (closed) {
      m[0] = m[n] = n == 1 ? step[0] : (3 * (step[n - 1] + step[0]) - m[n - 1] - m[1]) / 4;
    } else {
      m[0] = (3 * step[0] - m[1]) / 2;
      m[n] = (3 * step[n - 1] - m[n - 1]) / 2;
    }
    for (std::size_t i = 1; i < n; ++i) m[i] = (3 * (step[i - 1] + step[i]) - m[i - 1] - m[i + 1]) / 4;
  }
  for (std::size_t i = 0; i <= n; ++i) {
    double limit = 3 * std::min(i > 0 ? step[i - 1] : (closed ? step[n - 1] : step[0]),
                                i < n ? step[i] : (closed ? step[0] : step[n - 1]));
    m[i] = std::clamp(m[i], 0.05 * limit, limit);
  }
  return m;
}

/// Fills w, slope and the table of a match whose places s are final.
void weigh_places(const TargetSurface& target, bool closed, double kink_angle, ChainMatch& match) {
  constexpr std::size_t steps_per_segment = 256;
  const std::size_t segments = match.s.size() - 1;
  const std::size_t n = steps_per_segment * segments;
  const double first = match.s.front();
  const double step = (match.s.back() - first) / static_cast<double>(n);
  const double edge = step * steps_per_segment;
  std::vector<Vec3> tangents(n + 1);
  for (std::size_t i = 0; i <= n; ++i) {
    match.table_s.push_back(first + step * static_cast<double>(i));
    tangents[i] = point_on_path(target, match.path, match.table_s[i]).tangent;
  }
  // Curvature per step; a joint where the path turns a corner is no curvature.
  std::vector<double> curvature(n);
  for (std::size_t i = 0; i < n; ++i) curvature[i] = (tangents[i + 1] - tangents[i]).norm() / step;
  for (const double kink : kinks_of(target, match.path, kink_angle)) {
    const double from_first = closed ? wrapped(match.path, kink - first) : kink - first;
    const Offset at = static_cast<Offset>(std::floor(from_first / step));
    for (Offset i = std::max<Offset>(at - 1, 0); i <= std::min<Offset>(at + 1, static_cast<Offset>(n) - 1);
         ++i) {
      curvature[i] = 0;
    }
  }
  std::vector<double> density(n + 1, 1.0);
  for (std::size_t i = 0; i <= n; ++i) {
    const double before = i > 0 ? curvature[i - 1] : (closed ? curvature[n - 1] : curvature[0]);
    const double after = i < n ? curvature[i] : (closed ? curvature[0] : curvature[n - 1]);
    density[i] += std::pow(0.5 * (before + after) * edge, 0.75);
  }
  // Twice a running mean over a thirtieth of an edge: jumps of curvature must not become kinks of s(t).
  for (int pass = 0; pass < 2; ++pass) {
    constexpr Offset half = 4;
    std::vector<double> smooth(n + 1);
    for (Offset i = 0; i <= static_cast<Offset>(n); ++i) {
      double sum = 0;
      for (Offset k = i - half; k <= i + half; ++k) {
        Offset at = k;
        if (closed) {
          at = (k + static_cast<Offset>(n)) % static_cast<Offset>(n);
        } else if (k < 0 || k > static_cast<Offset>(n)) {
          at = k < 0 ? -k : 2 * static_cast<Offset>(n) - k;
        }
        sum += density[at];
      }
      smooth[i] = sum / (2 * half + 1);
    }
    density = std::move(smooth);
  }
  match.table_w.push_back(0);
  for (std::size_t i = 1; i <= n; ++i) {
    match.table_w.push_back(match.table_w.back() + 0.5 * step * (density[i - 1] + density[i]));
  }
  match.table_density = std::move(density);
  for (const double s : match.s) {
    const double x = std::clamp((s - first) / step, 0.0, static_cast<double>(n));
    const std::size_t i = std::min(static_cast<std::size_t>(x), n - 1);
    const double part = x - static_cast<double>(i);
    const double d = match.table_density[i];
    match.w.push_back(match.table_w[i] + step * part * (d + 0.5 * part * (match.table_density[i + 1] - d)));
  }
  match.slope = monotone_slopes(match.w, closed);
}

struct Attempt {
  Index chain = no_index;
  MatchedRun run;
};

}  // namespace

CurvePoint point_on_path(const TargetSurface& target, const FeaturePath& path, double s) {
  s = wrapped(path, s);
  const std::size_t p = piece_at(path, s);
  CurvePoint point = point_on_piece(target, path.pieces[p], s - path.offsets[p]);
  point.s = s;
  return point;
}

Index chain_on_path(const FeaturePath& path, double s) {
  return path.pieces[piece_at(path, wrapped(path, s))].chain;
}

double parameter_at(const ChainMatch& match, double t) {
  const std::size_t n = match.w.size() - 1;
  const std::size_t i = std::min(static_cast<std::size_t>(std::max(t, 0.0)), n - 1);
  const double x = t - static_cast<double>(i);
  const double y = 1 - x;
  const double w = match.w[i] * y * y * (1 + 2 * x) + match.w[i + 1] * x * x * (1 + 2 * y) +
                   match.slope[i] * x * y * y - match.slope[i + 1] * x * x * y;
  // s from w: within a step of the table the density is linear, so w is a quadratic of s.
  const std::vector<double>& table = match.table_w;
  const auto above = std::upper_bound(table.begin() + 1, table.end() - 1, w);
  const std::size_t k = static_cast<std::size_t>(above - table.begin()) - 1;
  const double step = match.table_s[k + 1] - match.table_s[k];
  const double d = match.table_density[k];
  const double growth = (match.table_density[k + 1] - d) / step;
  const double rest = std::max(0.0, w - table[k]);
  return match.table_s[k] + 2 * rest / (d + std::sqrt(std::max(d * d + 2 * growth * rest, 0.0)));
}

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
    const std::size_t n = match.s.size() - 1;
    std::vector<bool> pinned(n + 1, false);
    const double angle = settings.kink_angle_degrees * std::numbers::pi / 180;
    const std::vector<double> kinks = kinks_of(target, match.path, angle);
    match.turns = !kinks.empty();
    for (const double kink : kinks) {
      std::size_t nearest = 0;
      double distance = std::numeric_limits<double>::infinity();
      for (std::size_t k = chain.closed ? 0 : 1; k < n; ++k) {
        const double d = std::abs(chain.closed ? std::remainder(match.s[k] - kink, match.path.length())
                                               : match.s[k] - kink);
        if (d < distance && !pinned[k]) {
          distance = d;
          nearest = k;
        }
      }
      const Vec3 at = point_on_path(target, match.path, kink).position;
      const double reach = 0.5 * match.path.length() / static_cast<double>(n);
      if (distance > reach) {
        result.warnings.push_back(
            fmt::format("no vertex of the cage's crease lies near the CAD's corner at {}: it will be rounded",
                        place(at)));
        continue;
      }
      if (chain.closed && nearest == 0) {
        const double shift = std::remainder(kink - match.s[0], match.path.length());
        match.s[0] += shift;
        match.s[n] += shift;
        pinned[n] = true;
      } else {
        match.s[nearest] = kink;
      }
      pinned[nearest] = true;
      result.warnings.push_back(fmt::format(
          "the crease turns a corner of the CAD at {}: tag that vertex of the cage as a corner", place(at)));
    }
    relax_places(target, query_of(chain, points, scales, edge_sides), pinned, match);
    weigh_places(target, chain.closed, angle, match);
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
