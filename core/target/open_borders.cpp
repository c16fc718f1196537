#include "core/target/open_borders.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace flowcage {

namespace {

constexpr int sample_count = 33;

struct Chain {
  Index number = 0;  ///< in the features
  double length = 0;
  std::vector<Vec3> points{};  ///< from start to end
  Box3 bounds{};
  std::array<Index, 2> node{no_index, no_index};  ///< ends; both no_index where it is closed in itself
  bool closed() const { return node[0] == no_index; }
};

struct Step {
  Index chain = 0;  ///< into the boundary chains
  bool reversed = false;
};
struct Loop {
  std::vector<Step> steps{};
  bool closed = false;
};

struct Plane {
  Vec3 normal = Vec3::UnitX();
  double value = 0;
};

/// What a chain turned out to be.
struct Verdict {
  BorderKind kind = BorderKind::sheet;
  std::optional<Plane> plane{};
  double width = 0;
  bool same_run(const Verdict& other) const {
    if (kind != other.kind || plane.has_value() != other.plane.has_value()) return false;
    return !plane || (plane->value == other.plane->value && plane->normal == other.plane->normal);
  }
};

class Finder {
 public:
  Finder(const TargetSurface& surface, const BorderSettings& settings)
      : surface_(surface), settings_(settings), diagonal_(surface.diagonal()) {
    collect();
    trace();
    verdicts_.resize(chains_.size());
    decided_.assign(chains_.size(), false);
  }

  std::vector<OpenBorder> find() {
    for (const Loop& loop : loops_) judge_plane_of_loop(loop);
    for (const Loop& loop : loops_) judge_small(loop);
    for (std::size_t c = 0; c < chains_.size(); ++c) judge_gap(c);
    for (const Loop& loop : loops_) judge_ends_of_gaps(loop);
    for (const Loop& loop : loops_) judge_rim_or_hole(loop);
    judge_axis_planes();
    return runs();
  }

 private:
  void collect() {
    const FeatureGraph& graph = surface_.features();
    std::vector<Vec3> nodes;
    const auto node_at = [&](const Vec3& position) {
      for (std::size_t n = 0; n < nodes.size(); ++n) {
        if ((nodes[n] - position).norm() <= settings_.join * diagonal_) return static_cast<Index>(n);
      }
      nodes.push_back(position);
      return static_cast<Index>(nodes.size()) - 1;
    };
    for (Index c = 0; c < static_cast<Index>(graph.chains.size()); ++c) {
      const FeatureChain& known = graph.chains[c];
      if (known.kind != ChainKind::boundary || !(known.length > 0)) continue;
      Chain chain{.number = c, .length = known.length};
      for (int i = 0; i < sample_count; ++i) {
        // A closed chain wraps: its last point is its first.
        chain.points.push_back(surface_.chain_point(c, known.length * i / (sample_count - 1)).position);
        chain.bounds.extend(chain.points.back());
      }
      if (known.start != no_index) chain.node = {node_at(chain.points.front()), node_at(chain.points.back())};
      chains_.push_back(std::move(chain));
    }
    node_count_ = static_cast<Index>(nodes.size());
  }

  /// Paths from loose ends first, closed walks after them.
  void trace() {
    std::vector<std::vector<Step>> leaving(static_cast<std::size_t>(node_count_));
    for (std::size_t c = 0; c < chains_.size(); ++c) {
      if (chains_[c].closed()) continue;
      leaving[chains_[c].node[0]].push_back({static_cast<Index>(c), false});
      leaving[chains_[c].node[1]].push_back({static_cast<Index>(c), true});
    }
    std::vector<bool> used(chains_.size(), false);
    const auto walk = [&](Step step) {
      Loop loop;
      const Index start = chains_[step.chain].node[step.reversed ? 1 : 0];
      for (;;) {
        used[step.chain] = true;
        loop.steps.push_back(step);
        const Index node = chains_[step.chain].node[step.reversed ? 0 : 1];
        loop.closed = node == start;
        const Step* next = nullptr;
        for (const Step& candidate : leaving[node]) {
          if (used[candidate.chain]) continue;
          if (next == nullptr ||
              (shares_face(step.chain, candidate.chain) && !shares_face(step.chain, next->chain))) {
            next = &candidate;
          }
        }
        if (loop.closed || next == nullptr) break;
        step = *next;
      }
      loops_.push_back(std::move(loop));
    };
    for (const auto& steps : leaving) {
      if (steps.size() % 2 == 1 && !used[steps.front().chain]) walk(steps.front());
    }
    for (std::size_t c = 0; c < chains_.size(); ++c) {
      if (used[c]) continue;
      if (chains_[c].closed()) {
        used[c] = true;
        loops_.push_back({{{static_cast<Index>(c), false}}, true});
      } else {
        walk({static_cast<Index>(c), false});
      }
    }
  }

  bool shares_face(Index a, Index b) const {
    const auto& graph = surface_.features();
    const auto& left = graph.chains[chains_[a].number].faces;
    const auto& right = graph.chains[chains_[b].number].faces;
    return std::ranges::any_of(left,
                               [&](Index face) { return std::ranges::find(right, face) != right.end(); });
  }

  std::vector<Vec3> points_of(const Loop& loop) const {
    std::vector<Vec3> points;
    for (const Step& step : loop.steps) {
      std::vector<Vec3> part = chains_[step.chain].points;
      if (step.reversed) std::ranges::reverse(part);
      points.insert(points.end(), part.begin(), part.end() - 1);
      if (!loop.closed && &step == &loop.steps.back()) points.push_back(part.back());
    }
    return points;
  }

  double tolerance() const { return settings_.planar * diagonal_; }

  bool in_plane(const std::vector<Vec3>& points, const Plane& plane) const {
    return std::ranges::all_of(
        points, [&](const Vec3& p) { return std::abs(plane.normal.dot(p) - plane.value) <= tolerance(); });
  }

  /// Least-squares plane; none where the points are not in one, or on a line.
  std::optional<Plane> plane_through(const std::vector<Vec3>& points) const {
    Vec3 mean = Vec3::Zero();
    for (const Vec3& p : points) mean += p;
    mean /= static_cast<double>(points.size());
    Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
    for (const Vec3& p : points) scatter += (p - mean) * (p - mean).transpose();
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(scatter);
    const double across =
        std::sqrt(std::max(0.0, solver.eigenvalues()[1]) / static_cast<double>(points.size()));
    if (across <= tolerance()) return std::nullopt;
    Vec3 normal = solver.eigenvectors().col(0);
    for (int k = 0; k < 3; ++k) {  // an exact axis where the fit is one within its own accuracy
      if (std::abs(normal[k]) > 1 - 1e-8) normal = Vec3::Unit(k);
    }
    Index largest = 0;
    normal.cwiseAbs().maxCoeff(&largest);
    if (normal[largest] < 0) normal = -normal;
    const Plane plane{normal, normal.dot(mean)};
    if (!in_plane(points, plane)) return std::nullopt;
    return plane;
  }

  bool supports_the_model(const Plane& plane) const {
    bool above = false, below = false;
    for (const Vec3& p : surface_.tessellation().points) {
      const double height = plane.normal.dot(p) - plane.value;
      above = above || height > tolerance();
      below = below || height < -tolerance();
    }
    return !(above && below);
  }

  /// The faces beside most of the chain are not in the plane.
  bool faces_leave(const Chain& chain, const Plane& plane) const {
    const std::vector<Vec3> queries(chain.points.begin() + 1, chain.points.end() - 1);
    std::vector<SurfacePoint> feet(queries.size());
    surface_.closest_points(queries, {}, feet);
    const double almost_along = 0.9962;  // 5 degrees
    std::size_t leaving = 0;
    for (const SurfacePoint& foot : feet) {
      leaving += std::abs(foot.normal.dot(plane.normal)) < almost_along ? 1 : 0;
    }
    return 2 * leaving > feet.size();
  }

  void decide(std::size_t chain, const Verdict& verdict) {
    verdicts_[chain] = verdict;
    decided_[chain] = true;
  }

  void judge_plane_of_loop(const Loop& loop) {
    const std::optional<Plane> plane = plane_through(points_of(loop));
    if (!plane || !supports_the_model(*plane)) return;
    for (const Step& step : loop.steps) {
      if (!faces_leave(chains_[step.chain], *plane)) return;
    }
    decide_all(loop, {.kind = BorderKind::plane, .plane = plane});
  }

  /// A chain may be in two of the planes (a vertical stem): the plane with most to claim chooses first.
  void judge_axis_planes() {
    const Box3 bounds = surface_.bounds();
    std::vector<Plane> planes;
    for (int k = 0; k < 3; ++k) {
      for (const double value : {bounds.min()[k], bounds.max()[k]}) planes.push_back({Vec3::Unit(k), value});
    }
    while (!planes.empty()) {
      std::size_t best = 0;
      double best_length = 0;
      std::vector<std::size_t> best_chains;
      for (std::size_t p = 0; p < planes.size(); ++p) {
        double length = 0;
        std::vector<std::size_t> claimed;
        for (std::size_t c = 0; c < chains_.size(); ++c) {
          if (decided_[c] || !in_plane(chains_[c].points, planes[p])) continue;
          if (!faces_leave(chains_[c], planes[p])) continue;
          claimed.push_back(c);
          length += chains_[c].length;
        }
        if (length > best_length) {
          best = p;
          best_length = length;
          best_chains = std::move(claimed);
        }
      }
      if (best_chains.empty()) return;
      // The bounds are only as good as the tolerance: the border's own points say where the plane is.
      Plane plane = planes[best];
      double sum = 0;
      for (const std::size_t c : best_chains) {
        for (const Vec3& p : chains_[c].points) sum += plane.normal.dot(p);
      }
      plane.value = sum / static_cast<double>(best_chains.size() * sample_count);
      for (const std::size_t c : best_chains) decide(c, {.kind = BorderKind::plane, .plane = plane});
      planes.erase(planes.begin() + static_cast<std::ptrdiff_t>(best));
    }
  }

  void judge_gap(std::size_t c) {
    if (decided_[c]) return;
    const Chain& chain = chains_[c];
    const double reach = std::min(settings_.gap_width * diagonal_, 0.05 * chain.length);
    int near = 0, count = 0;
    double width = 0;
    for (double fraction = 0.15; fraction < 0.86;
         fraction += 0.05) {  // the ends meet their neighbours anyway
      const CurvePoint here = surface_.chain_point(chain.number, fraction * chain.length);
      double nearest = reach;
      bool found = false;
      for (std::size_t other = 0; other < chains_.size(); ++other) {
        if (other == c || chains_[other].bounds.exteriorDistance(here.position) > nearest) continue;
        const CurvePoint foot = surface_.closest_on_chain(chains_[other].number, here.position);
        const double least_cosine = 0.7;  // sides of a gap run along each other
        if (foot.distance > nearest || std::abs(foot.tangent.dot(here.tangent)) < least_cosine) continue;
        nearest = foot.distance;
        found = true;
      }
      ++count;
      if (!found) continue;
      ++near;
      width = std::max(width, nearest);
    }
    if (10 * near >= 8 * count) decide(c, {.kind = BorderKind::gap, .width = width});
  }

  /// The short edge between the two sides of a slit.
  void judge_ends_of_gaps(const Loop& loop) {
    const std::size_t count = loop.steps.size();
    for (std::size_t i = 0; i < count; ++i) {
      const auto c = static_cast<std::size_t>(loop.steps[i].chain);
      if (decided_[c] || chains_[c].length > settings_.gap_width * diagonal_) continue;
      if (!loop.closed && (i == 0 || i + 1 == count)) continue;
      const Verdict& before = verdicts_[loop.steps[(i + count - 1) % count].chain];
      const Verdict& after = verdicts_[loop.steps[(i + 1) % count].chain];
      if (before.kind == BorderKind::gap && after.kind == BorderKind::gap) decide(c, before);
    }
  }

  bool undecided(const Loop& loop) const {
    return std::ranges::none_of(loop.steps, [&](const Step& step) { return decided_[step.chain]; });
  }
  void decide_all(const Loop& loop, const Verdict& verdict) {
    for (const Step& step : loop.steps) decide(step.chain, verdict);
  }

  void judge_small(const Loop& loop) {
    Box3 bounds;
    for (const Step& step : loop.steps) bounds.extend(chains_[step.chain].bounds);
    const double extent = bounds.diagonal().norm();
    if (!loop.closed || !undecided(loop) || extent > settings_.gap_width * diagonal_) return;
    decide_all(loop, {.kind = BorderKind::gap, .width = extent});
  }

  /// A closed loop in a plane is the rim of what fills it, or a hole.
  void judge_rim_or_hole(const Loop& loop) {
    if (!loop.closed || !undecided(loop)) return;
    const std::vector<Vec3> points = points_of(loop);
    const std::optional<Plane> plane = plane_through(points);
    if (!plane) return;
    if (surface_fills(points, *plane)) {
      decide_all(loop, {.kind = BorderKind::sheet});
    } else {
      decide_all(loop, {.kind = BorderKind::hole, .plane = plane});
    }
  }

  /// The surface goes on in the plane on the inner side of the loop: then the loop is its rim.
  bool surface_fills(const std::vector<Vec3>& points, const Plane& plane) const {
    Box3 bounds;
    for (const Vec3& p : points) bounds.extend(p);
    Vec3 area = Vec3::Zero();
    for (std::size_t i = 0; i < points.size(); ++i) {
      area += points[i].cross(points[(i + 1) % points.size()]);
    }
    const double turn = area.dot(plane.normal) > 0 ? 1 : -1;
    const double step = 1e-3 * bounds.diagonal().norm();
    std::vector<Vec3> queries;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Vec3 along = points[(i + 1) % points.size()] - points[i];
      if (!(along.norm() > 0)) continue;
      const Vec3 inward = turn * plane.normal.cross(along.normalized());
      queries.push_back(0.5 * (points[i] + points[(i + 1) % points.size()]) + step * inward);
    }
    std::vector<SurfacePoint> feet(queries.size());
    surface_.closest_points(queries, {}, feet);
    const auto on =
        std::ranges::count_if(feet, [&](const SurfacePoint& foot) { return foot.distance < 0.1 * step; });
    return 2 * static_cast<std::size_t>(on) > feet.size();
  }

  std::vector<OpenBorder> runs() const {
    std::vector<OpenBorder> borders;
    for (std::size_t l = 0; l < loops_.size(); ++l) {
      std::vector<Step> steps = loops_[l].steps;
      if (loops_[l].closed) {  // start where one run ends and another begins
        for (std::size_t i = 1; i < steps.size(); ++i) {
          if (verdicts_[steps[i].chain].same_run(verdicts_[steps[i - 1].chain])) continue;
          std::ranges::rotate(steps, steps.begin() + static_cast<std::ptrdiff_t>(i));
          break;
        }
      }
      for (std::size_t i = 0; i < steps.size(); ++i) {
        const Verdict& verdict = verdicts_[steps[i].chain];
        if (i == 0 || !verdict.same_run(verdicts_[steps[i - 1].chain])) {
          OpenBorder border{.kind = verdict.kind, .loop = static_cast<Index>(l), .closed = loops_[l].closed};
          if (verdict.plane) {
            border.normal = verdict.plane->normal;
            border.value = verdict.plane->value;
            for (int k = 0; k < 3; ++k) border.axis = border.normal == Vec3::Unit(k) ? k : border.axis;
          }
          borders.push_back(std::move(border));
        }
        OpenBorder& border = borders.back();
        const Chain& chain = chains_[steps[i].chain];
        border.chains.push_back(chain.number);
        border.length += chain.length;
        border.bounds.extend(chain.bounds);
        border.width = std::max(border.width, verdict.width);
      }
    }
    for (OpenBorder& border : borders) border.place = border.bounds.center();
    return borders;
  }

  const TargetSurface& surface_;
  BorderSettings settings_;
  double diagonal_;
  std::vector<Chain> chains_;
  Index node_count_ = 0;
  std::vector<Loop> loops_;
  std::vector<Verdict> verdicts_;
  std::vector<bool> decided_;
};

}  // namespace

std::vector<OpenBorder> find_open_borders(const TargetSurface& surface, const BorderSettings& settings) {
  return Finder(surface, settings).find();
}

std::string_view name_of(BorderKind kind) {
  static constexpr std::array<std::string_view, 4> names{"plane", "gap", "hole", "sheet"};
  return names[static_cast<std::size_t>(kind)];
}

}  // namespace flowcage
