#include "core/project/find_creases.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <set>
#include <tuple>
#include <utility>

#include "core/base/error.hpp"
#include "core/project/chain_runs.hpp"
#include "core/project/crease_chains.hpp"
#include "core/project/feature_match.hpp"

namespace flowcage {
namespace {

constexpr int most_trials = 200;  // routings tried to improve the first one

/// The paths of all runs, under one assignment of corners.
struct Routing {
  std::vector<EdgePath> paths;
  Index failed = 0;   // sharp runs without a path
  double effort = 0;  // sum of the others'
};

bool better(const Routing& a, const Routing& b) {
  return a.failed != b.failed ? a.failed < b.failed : a.effort < b.effort * (1 - 1e-9);
}

class CreaseFinder {
 public:
  CreaseFinder(const Cage& cage, const TargetSurface& target, const CreaseSearchSettings& settings)
      : cage_(cage),
        level_(build_surface_level(cage)),
        target_(target),
        features_(target.features()),
        settings_(settings),
        shape_(cage_shape(level_, cage.points, target)),
        scales_(shape_.scales),
        ends_(chain_ends(features_)),
        vertex_of_(features_.corners.size(), no_index),
        on_boundary_(cage.points.size(), false) {
    for (Index v = 0; v < level_.vertex_count(); ++v) {
      on_boundary_[v] = level_.vertex_edges.row_size(v) > level_.vertex_faces.row_size(v);
      is_open_ = is_open_ || on_boundary_[v];
    }
  }

  FoundCreases run() {
    FoundCreases found;
    found.cage = cage_;
    if (features_.chains.empty()) return found;
    assign_corners();
    share_vertices();
    prepare_runs();
    Routing routing = improved(route({}));
    do {
      found = {};
      found.cage = cage_;
      add_creases(routing, found);
      add_corners(found);
    } while (take_back(found.cage, routing));
    for (const FeatureChain& chain : features_.chains) found.sharp_chains += chain.kind == ChainKind::sharp;
    report(routing, found);
    return found;
  }

 private:
  /// Vertices that may stand for a corner, with their distances in mean edge lengths, nearest first.
  struct Candidate {
    double cost = 0;
    Index corner = no_index, vertex = no_index;
    auto key() const { return std::tie(cost, corner, vertex); }
  };
  std::vector<Candidate> candidates(Index corner) const {
    const bool open = is_open_ && std::any_of(ends_[corner].begin(), ends_[corner].end(), [&](const auto& e) {
                        return features_.chains[e.chain].kind == ChainKind::boundary;
                      });
    std::vector<Candidate> list;
    for (Index v = 0; v < level_.vertex_count(); ++v) {
      if (open && !on_boundary_[v]) continue;
      const double cost = (cage_.points[v] - features_.corners[corner]).norm() / scales_[v];
      if (cost < settings_.corner_reach) list.push_back({cost, corner, v});
    }
    std::sort(list.begin(), list.end(), [](const auto& a, const auto& b) { return a.key() < b.key(); });
    return list;
  }

  /// The corners that a chain of at most `length` joins to this one.
  template <typename Visit>
  void for_neighbours(Index corner, double length, const Visit& visit) const {
    for (const ChainEnd& end : ends_[corner]) {
      const FeatureChain& chain = features_.chains[end.chain];
      const Index other = end.at_start ? chain.end : chain.start;
      if (other != corner && chain.length <= length) visit(other, chain.length);
    }
  }

  void assign_corners() {
    std::vector<Candidate> pairs;
    for (Index c = 0; c < static_cast<Index>(features_.corners.size()); ++c) {
      const std::vector<Candidate> list = candidates(c);
      pairs.insert(pairs.end(), list.begin(), list.end());
    }
    std::sort(pairs.begin(), pairs.end(), [](const auto& a, const auto& b) { return a.key() < b.key(); });
    std::vector<bool> taken(cage_.points.size(), false);
    for (const Candidate& pair : pairs) {
      if (vertex_of_[pair.corner] != no_index || taken[pair.vertex]) continue;
      if (pair.cost > settings_.detail_reach && has_close_neighbour(pair.corner)) continue;
      vertex_of_[pair.corner] = pair.vertex;
      taken[pair.vertex] = true;
    }
  }
  bool has_close_neighbour(Index corner) const {
    bool close = false;
    for_neighbours(corner, std::numeric_limits<double>::infinity(), [&](Index other, double length) {
      const Index v = vertex_of_[other];
      close = close || (v != no_index && length < settings_.detail_reach * scales_[v]);
    });
    return close;
  }

  /// What lies closer together than the cage resolves shares a vertex.
  void share_vertices() {
    for (bool changed = true; changed;) {
      changed = false;
      for (Index c = 0; c < static_cast<Index>(vertex_of_.size()); ++c) {
        if (vertex_of_[c] != no_index) continue;
        double nearest = std::numeric_limits<double>::infinity();
        Index vertex = no_index;
        for_neighbours(c, nearest, [&](Index other, double length) {
          const Index v = vertex_of_[other];
          if (v == no_index || length > settings_.corner_reach * scales_[v] || length >= nearest) return;
          if ((cage_.points[v] - features_.corners[c]).norm() > settings_.corner_reach * scales_[v]) return;
          nearest = length;
          vertex = v;
        });
        if (vertex == no_index) continue;
        vertex_of_[c] = vertex;
        changed = true;
      }
    }
  }

  void prepare_runs() {
    std::vector<double> lengths;
    for (const auto& [a, b] : level_.edge_vertices)
      lengths.push_back((cage_.points[a] - cage_.points[b]).norm());
    const auto quartile = lengths.begin() + static_cast<Offset>(lengths.size() / 4);
    std::nth_element(lengths.begin(), quartile, lengths.end());
    const double spacing = std::max(*quartile / 8, 1e-6 * target_.diagonal());
    std::vector<bool> is_used(vertex_of_.size());
    for (std::size_t c = 0; c < is_used.size(); ++c) is_used[c] = vertex_of_[c] != no_index;
    runs_ = chain_runs(target_, is_used, spacing);
    searches_.reserve(runs_.size());
    for (const ChainRun& run : runs_) searches_.emplace_back(shape_, run);
  }

  /// A run that the cage has no room for: both ends in one vertex, and short.
  bool is_detail(const ChainRun& run) const {
    if (run.start == no_index || run.end == no_index || run.start == run.end) return false;
    const Index v = vertex_of_[run.start];
    return v != no_index && v == vertex_of_[run.end] && run.length < scales_[v];
  }
  bool counts(const ChainRun& run) const { return run.kind == ChainKind::sharp && !is_detail(run); }

  EdgePath path_of(Index r, const EdgePathBlocks& blocks) const {
    const ChainRun& run = runs_[r];
    if (is_detail(run)) return {};
    Index first = no_index, last = no_index;
    if (!run.closed) {
      first = vertex_of_[run.start];
      last = vertex_of_[run.end];
      if (first == no_index || last == no_index) return {};
    }
    EdgePath path = searches_[r].find(first, last, blocks);
    path.found = path.found && path.cost <= settings_.cost_limit;
    return path;
  }

  /// Open boundaries first, then sharp runs, the best first; `order` lists runs that precede all others of
  /// their kind.
  Routing route(const std::vector<Index>& order) const {
    Routing routing;
    routing.paths.resize(runs_.size());
    EdgePathBlocks blocks{std::vector<bool>(cage_.points.size(), false),
                          std::vector<bool>(level_.edge_vertices.size(), false)};
    for (const Index v : vertex_of_) {
      if (v != no_index) blocks.vertex[v] = true;
    }
    std::vector<bool> used(level_.edge_vertices.size(), false);
    // Sharp edges of the CAD may also lie along the cage's open boundary, where the CAD is not open itself.
    enum class Pass { boundary, sharp, sharp_on_boundary };
    for (const Pass pass : {Pass::boundary, Pass::sharp, Pass::sharp_on_boundary}) {
      if (pass != Pass::sharp && !is_open_) continue;
      for (Index e = 0; e < level_.edge_count(); ++e) {
        blocks.edge[e] = used[e] || level_.is_boundary_edge(e) != (pass != Pass::sharp);
      }
      const ChainKind kind = pass == Pass::boundary ? ChainKind::boundary : ChainKind::sharp;
      std::vector<Index> waiting = order;
      for (Index r = 0; r < static_cast<Index>(runs_.size()); ++r) {
        if (std::find(order.begin(), order.end(), r) == order.end()) waiting.push_back(r);
      }
      std::erase_if(waiting, [&](Index r) { return runs_[r].kind != kind || routing.paths[r].found; });
      std::vector<EdgePath> attempts;
      for (const Index r : waiting) attempts.push_back(path_of(r, blocks));
      const auto urgency = [&](std::size_t k) {
        const auto at = std::find(order.begin(), order.end(), waiting[k]) - order.begin();
        return std::tuple(!attempts[k].found, at, attempts[k].cost, waiting[k]);
      };
      while (!waiting.empty()) {
        std::size_t best = 0;
        for (std::size_t k = 1; k < waiting.size(); ++k) {
          if (urgency(k) < urgency(best)) best = k;
        }
        if (!attempts[best].found) break;
        EdgePath path = std::move(attempts[best]);
        const Index r = waiting[best];
        waiting.erase(waiting.begin() + static_cast<Offset>(best));
        attempts.erase(attempts.begin() + static_cast<Offset>(best));
        for (const Index e : path.edges) used[e] = blocks.edge[e] = true;
        for (const Index v : path.vertices) blocks.vertex[v] = true;
        for (std::size_t k = 0; k < waiting.size(); ++k) {
          if (attempts[k].found && meets(attempts[k], path, runs_[waiting[k]])) {
            attempts[k] = path_of(waiting[k], blocks);
          }
        }
        routing.paths[r] = std::move(path);
      }
    }
    for (Index r = 0; r < static_cast<Index>(runs_.size()); ++r) {
      if (!counts(runs_[r])) continue;
      routing.failed += !routing.paths[r].found;
      if (routing.paths[r].found) routing.effort += routing.paths[r].effort;
    }
    return routing;
  }
  /// Whether a path became impossible through another one.
  static bool meets(const EdgePath& path, const EdgePath& other, const ChainRun& run) {
    const std::size_t skip = run.closed ? 0 : 1;
    for (std::size_t i = skip; i + skip < path.vertices.size(); ++i) {
      if (std::find(other.vertices.begin(), other.vertices.end(), path.vertices[i]) != other.vertices.end()) {
        return true;
      }
    }
    return std::any_of(path.edges.begin(), path.edges.end(), [&](Index e) {
      return std::find(other.edges.begin(), other.edges.end(), e) != other.edges.end();
    });
  }

  /// Tries what may be better than the nearest vertex for each corner and the best path first. Corners that
  /// lie close together change their vertices, for a cage drawn roughly tells not which is which. For a run
  /// without a path: it goes first, or its corners change with others or move to free vertices.
  Routing improved(Routing best) {
    int trials = 0;
    std::vector<Index> order;
    const auto attempt = [&](const std::vector<Index>& with_order) {
      if (++trials > most_trials) return false;
      Routing next = route(with_order);
      if (!better(next, best)) return false;
      best = std::move(next);
      order = with_order;
      return true;
    };
    for (Index a = 0; a < static_cast<Index>(vertex_of_.size()); ++a) {
      if (vertex_of_[a] == no_index) continue;
      for_neighbours(a, settings_.corner_reach * scales_[vertex_of_[a]], [&](Index b, double) {
        if (a < b && vertex_of_[b] != no_index && vertex_of_[a] != vertex_of_[b]) {
          exchanged(a, b, order, attempt);
        }
      });
    }
    std::set<Index> given_up;
    while (best.failed > 0 && trials < most_trials) {
      Index run = no_index;
      for (Index r = 0; r < static_cast<Index>(runs_.size()) && run == no_index; ++r) {
        const bool has_ends = runs_[r].closed || (runs_[r].start != no_index && runs_[r].end != no_index &&
                                                  vertex_of_[runs_[r].start] != no_index &&
                                                  vertex_of_[runs_[r].end] != no_index);
        if (counts(runs_[r]) && !best.paths[r].found && has_ends && given_up.count(r) == 0) run = r;
      }
      if (run == no_index) break;
      std::vector<Index> first = order;
      std::erase(first, run);
      first.insert(first.begin(), run);
      if (attempt(first) || (!runs_[run].closed && moved_corner(run, order, attempt))) {
        given_up.clear();
      } else {
        given_up.insert(run);
      }
    }
    return best;
  }
  /// Two corners change their vertices, alone or with the strip that they are a rung of.
  template <typename Attempt>
  bool exchanged(Index a, Index b, const std::vector<Index>& order, const Attempt& attempt) {
    std::swap(vertex_of_[a], vertex_of_[b]);
    if (attempt(order)) return true;
    const std::vector<std::pair<Index, Index>> others = ladder(a, b);
    for (const auto& [c, d] : others) std::swap(vertex_of_[c], vertex_of_[d]);
    if (!others.empty() && attempt(order)) return true;
    for (const auto& [c, d] : others) std::swap(vertex_of_[c], vertex_of_[d]);
    std::swap(vertex_of_[a], vertex_of_[b]);
    return false;
  }
  /// The other pairs of a strip between two runs of the target (a blunt trailing edge): rungs that chains
  /// join to the rung a-b on both sides.
  std::vector<std::pair<Index, Index>> ladder(Index a, Index b) const {
    constexpr double any = std::numeric_limits<double>::infinity();
    std::vector<std::pair<Index, Index>> rungs{{a, b}};
    std::set<Index> seen{a, b};
    for (std::size_t k = 0; k < rungs.size(); ++k) {
      const auto [left, right] = rungs[k];
      for_neighbours(left, any, [&](Index next_left, double) {
        for_neighbours(right, any, [&, from = right](Index next_right, double rail) {
          for_neighbours(next_left, 0.5 * rail, [&](Index across, double) {
            if (across != next_right || across == from || vertex_of_[next_left] == no_index ||
                vertex_of_[next_right] == no_index || seen.count(next_left) + seen.count(next_right) > 0) {
              return;
            }
            rungs.emplace_back(next_left, next_right);
            seen.insert({next_left, next_right});
          });
        });
      });
    }
    rungs.erase(rungs.begin());
    return rungs;
  }
  template <typename Attempt>
  bool moved_corner(Index run, const std::vector<Index>& order, const Attempt& attempt) {
    for (const Index corner : {runs_[run].start, runs_[run].end}) {
      std::vector<std::pair<double, Index>> neighbours;
      for_neighbours(corner, std::numeric_limits<double>::infinity(), [&](Index other, double length) {
        if (vertex_of_[other] != no_index) neighbours.emplace_back(length, other);
      });
      std::sort(neighbours.begin(), neighbours.end());
      for (const auto& [length, other] : neighbours) {
        if (exchanged(corner, other, order, attempt)) return true;
      }
      for (const Candidate& candidate : candidates(corner)) {
        if (std::find(vertex_of_.begin(), vertex_of_.end(), candidate.vertex) != vertex_of_.end()) continue;
        const Index before = std::exchange(vertex_of_[corner], candidate.vertex);
        if (attempt(order)) return true;
        vertex_of_[corner] = before;
      }
    }
    return false;
  }

  void add_creases(const Routing& routing, FoundCreases& found) const {
    std::set<std::pair<Index, Index>> creases;
    for (Index r = 0; r < static_cast<Index>(runs_.size()); ++r) {
      if (!routing.paths[r].found || runs_[r].kind != ChainKind::sharp) continue;
      found.followed += static_cast<Index>(runs_[r].chains.size());
      for (const Index e : routing.paths[r].edges) {
        if (!level_.is_boundary_edge(e))
          creases.insert({level_.edge_vertices[e][0], level_.edge_vertices[e][1]});
      }
    }
    for (const auto& [a, b] : creases) found.cage.creases.push_back({a, b, infinitely_sharp});
    found.crease_edges = static_cast<Index>(creases.size());
  }

  /// Tags where the target has a corner, but the creases alone make none.
  void add_corners(FoundCreases& found) const {
    const SurfaceLevel level = build_surface_level(found.cage);
    const std::vector<Index> sharp_edges = sharp_edge_counts(level);
    std::set<Index> corners;
    for (Index c = 0; c < static_cast<Index>(vertex_of_.size()); ++c) {
      const Index v = vertex_of_[c];
      if (v == no_index || level.vertex_sharpness[v] >= infinitely_sharp) continue;
      if (sharp_edges[v] != 1 && sharp_edges[v] != 2) continue;
      const double turn = settings_.turn_degrees * std::numbers::pi / 180;
      if (ends_.row_size(c) == 2 && sharp_edges[v] == 2 && turn_at(target_, ends_[c]) < turn) continue;
      corners.insert(v);
    }
    for (const Index v : corners) found.cage.corners.push_back({v, infinitely_sharp});
    found.corners.assign(corners.begin(), corners.end());
  }

  /// Gives up doubtful paths that the fit would not match to the target: a crease without a partner spoils
  /// the surface. True if there were any.
  bool take_back(const Cage& cage, Routing& routing) const {
    const SurfaceLevel level = build_surface_level(cage);
    const std::vector<CreaseChain> chains = crease_chains(level);
    const FeatureMatch match = match_features(level, cage.points, chains, target_);
    std::vector<bool> unmatched(level_.edge_vertices.size(), false);
    for (std::size_t c = 0; c < chains.size(); ++c) {
      if (match.chains[c].matched || chains[c].boundary) continue;
      for (const Index e : chains[c].edges) unmatched[e] = true;
    }
    bool any = false;
    for (std::size_t r = 0; r < runs_.size(); ++r) {
      EdgePath& path = routing.paths[r];
      const bool doubtful = path.cost > 0.5 * settings_.cost_limit && path.edges.size() > 1;
      if (!path.found || !doubtful || runs_[r].kind != ChainKind::sharp) continue;
      path.found = std::none_of(path.edges.begin(), path.edges.end(), [&](Index e) { return unmatched[e]; });
      any = any || !path.found;
    }
    return any;
  }

  void report(const Routing& routing, FoundCreases& found) const {
    const auto along = [&](const ChainRun& run) {
      return fmt::format("from {} over {}, {:.4g} m long", place(run.samples.front()),
                         place(run.samples[run.samples.size() / 2]), run.length);
    };
    const ChainRun* longest_detail = nullptr;
    Index details = 0, missed = 0;
    std::string places;
    for (Index r = 0; r < static_cast<Index>(runs_.size()); ++r) {
      const ChainRun& run = runs_[r];
      if (run.kind != ChainKind::sharp || routing.paths[r].found) continue;
      if (is_detail(run) || run.length < settings_.corner_reach * edge_length_near(run)) {
        ++details;
        if (longest_detail == nullptr || run.length > longest_detail->length) longest_detail = &run;
        continue;
      }
      constexpr Index most_places = 3;
      if (++missed <= most_places) places += (missed > 1 ? "; " : "") + along(run);
    }
    if (missed > 0) {
      found.warnings.push_back(
          fmt::format("no edges of the cage follow {} sharp edge{} of the CAD ({}{}): the surface is rounded "
                      "there; draw edges of the cage along them, with a vertex at each of their corners",
                      missed, missed > 1 ? "s" : "", places, missed > 3 ? "; ..." : ""));
    }
    if (details > 0) {
      found.warnings.push_back(
          fmt::format("{} sharp edge{} left out, shorter than the cage's edges there (the longest "
                      "{}): draw a finer cage there if the detail matters",
                      details, details > 1 ? "s of the CAD are" : " of the CAD is", along(*longest_detail)));
    }
  }
  double edge_length_near(const ChainRun& run) const {
    const Vec3& middle = run.samples[run.samples.size() / 2];
    Index nearest = 0;
    for (Index v = 1; v < level_.vertex_count(); ++v) {
      if ((cage_.points[v] - middle).norm() < (cage_.points[nearest] - middle).norm()) nearest = v;
    }
    return scales_[nearest];
  }

  const Cage& cage_;
  const SurfaceLevel level_;
  const TargetSurface& target_;
  const FeatureGraph& features_;
  const CreaseSearchSettings& settings_;
  const CageShape shape_;
  const std::vector<double>& scales_;
  const Csr<ChainEnd> ends_;
  std::vector<Index> vertex_of_;  // of the target's corners; several may share one
  std::vector<bool> on_boundary_;
  bool is_open_ = false;
  std::vector<ChainRun> runs_;
  std::vector<EdgePathSearch> searches_;
};

}  // namespace

FoundCreases find_creases(const Cage& cage, const TargetSurface& target,
                          const CreaseSearchSettings& settings) {
  return CreaseFinder(cage, target, settings).run();
}

}  // namespace flowcage
