#include "core/project/feature_graph_samples.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <numeric>
#include <queue>
#include <utility>

namespace flowcage {
namespace {

/// A place of the run so far: a point of the graph and the point it was entered from (the run may not turn
/// back).
using State = std::pair<Index, Index>;

struct StateRecord {
  double cost = std::numeric_limits<double>::infinity();
  State from{no_index, no_index};
  std::vector<const SampledFeatures::Arc*> arcs;  ///< from the previous state's point to this one
};

struct Reached {
  Index node = no_index;
  double distance = 0;
};

bool allowed(const SampledFeatures& graph, const GraphFilter& filter, Index piece) {
  if (!filter.used.empty() && filter.used[piece]) return false;
  return graph.piece_kind[piece] == ChainKind::sharp ? filter.sharp : filter.boundary;
}

/// Dijkstra's algorithm from one state, up to `reach`; scratch arrays are reset on leaving.
class BoundedSearch {
 public:
  explicit BoundedSearch(const SampledFeatures& graph)
      : graph_(graph),
        distance_(graph.points.size(), std::numeric_limits<double>::infinity()),
        entered_(graph.points.size(), nullptr),
        parent_(graph.points.size(), no_index) {}

  const std::vector<Reached>& run(const State& start, double reach, const GraphFilter& filter) {
    clear();
    using Entry = std::pair<double, Index>;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
    start_ = start.first;
    const auto relax = [&](Index node, double base) {
      for (const SampledFeatures::Arc& arc : graph_.arcs[node]) {
        if (!allowed(graph_, filter, arc.piece)) continue;
        if (arc.to == (node == start.first ? start.second : parent_[node])) continue;  // no turning back
        const double d = base + arc.length;
        if (d > reach || d >= distance_[arc.to]) continue;
        if (!std::isfinite(distance_[arc.to])) touched_.push_back(arc.to);
        distance_[arc.to] = d;
        entered_[arc.to] = &arc;
        parent_[arc.to] = node;
        queue.emplace(d, arc.to);
      }
    };
    relax(start.first, 0.0);  // the start itself may be reached again: a loop through one corner
    while (!queue.empty()) {
      const auto [d, node] = queue.top();
      queue.pop();
      if (d > distance_[node]) continue;
      reached_.push_back({node, d});
      if (node != start.first) relax(node, d);
    }
    return reached_;
  }

  Index parent(Index node) const { return parent_[node]; }

  std::vector<const SampledFeatures::Arc*> arcs_to(Index node) const {
    std::vector<const SampledFeatures::Arc*> arcs;
    do {
      arcs.push_back(entered_[node]);
      node = parent_[node];
    } while (node != start_);
    std::reverse(arcs.begin(), arcs.end());
    return arcs;
  }

 private:
  void clear() {
    for (const Index node : touched_) {
      distance_[node] = std::numeric_limits<double>::infinity();
      entered_[node] = nullptr;
      parent_[node] = no_index;
    }
    touched_.clear();
    reached_.clear();
  }

  const SampledFeatures& graph_;
  std::vector<double> distance_;
  std::vector<const SampledFeatures::Arc*> entered_;
  std::vector<Index> parent_;
  std::vector<Index> touched_;
  std::vector<Reached> reached_;
  Index start_ = no_index;
};

/// Places along a chain where the normals beside it are known: more where it bends (round a nose).
int side_sample_count(const FeatureChain& chain) {
  const std::vector<Vec3>& p = chain.polyline;
  double turn = 0;
  for (std::size_t i = 2; i < p.size(); ++i) {
    const Vec3 before = p[i - 1] - p[i - 2], after = p[i] - p[i - 1];
    turn += std::atan2(before.cross(after).norm(), before.dot(after));
  }
  constexpr double turn_a_sample = std::numbers::pi / 12;
  return static_cast<int>(std::min(5 + turn / turn_a_sample, 25.0));
}

double squared_distance(const SampledFeatures& graph, const MatchQuery& query, std::size_t k, Index node) {
  return std::min((query.controls[k] - graph.points[node]).squaredNorm(),
                  (query.limits[k] - graph.points[node]).squaredNorm());
}

/// What it costs that vertex k lies at a node: distance, and the faces on the chain's sides.
double place_cost(const SampledFeatures& graph, const MatchQuery& query, std::size_t k, Index node) {
  constexpr double side_weight = 0.5;
  return squared_distance(graph, query, k, node) / (query.scale * query.scale) +
         side_weight * normal_mismatch(query.sides[k], graph.normals[graph.point_normals[node]]);
}

/// Points of the graph where vertex k may lie.
std::vector<Index> candidates(const SampledFeatures& graph, const MatchQuery& query, std::size_t k,
                              const GraphFilter& filter) {
  const std::size_t last = query.controls.size() - 1;
  if (k == 0 && query.first_node != no_index) return {query.first_node};
  if (k == last && query.last_node != no_index) return {query.last_node};
  double reach = 0;
  if (k > 0) reach = query.lengths[k - 1];
  if (k < last) reach = std::max(reach, query.lengths[k]);
  if (query.closed && (k == 0 || k == last)) reach = std::max(query.lengths.front(), query.lengths.back());
  std::vector<Index> found;
  for (Index node = 0; node < static_cast<Index>(graph.points.size()); ++node) {
    if (squared_distance(graph, query, k, node) > reach * reach) continue;
    const auto arcs = graph.arcs[node];
    if (std::any_of(arcs.begin(), arcs.end(),
                    [&](const auto& arc) { return allowed(graph, filter, arc.piece); })) {
      found.push_back(node);
    }
  }
  return found;
}

FeaturePath path_of(const std::vector<const SampledFeatures::Arc*>& arcs,
                    const std::vector<double>& chain_length) {
  FeaturePath path;
  for (const SampledFeatures::Arc* arc : arcs) {
    const FeaturePiece& next = arc->along;
    bool joined = false;
    if (!path.pieces.empty()) {
      FeaturePiece& piece = path.pieces.back();
      const bool same_way = (piece.s_end > piece.s_begin) == (next.s_end > next.s_begin);
      if (piece.chain == next.chain && same_way) {
        const double gap = std::remainder(piece.s_end - next.s_begin, chain_length[next.chain]);
        if (std::abs(gap) < 1e-9 * chain_length[next.chain]) {
          piece.s_end += next.s_end - next.s_begin;
          joined = true;
        }
      }
    }
    if (!joined) {
      path.pieces.push_back(next);
      path.offsets.push_back(path.offsets.back());
    }
    path.offsets.back() += arc->length;
  }
  return path;
}

/// Viterbi's algorithm over places [0, n) of the query; the states chosen and the arcs between them.
struct Chosen {
  bool found = false;
  std::vector<Index> nodes;
  std::vector<std::vector<const SampledFeatures::Arc*>> arcs;  ///< #nodes - 1
};

Chosen viterbi(const SampledFeatures& graph, const MatchQuery& query, const GraphFilter& filter) {
  const std::size_t n = query.controls.size();
  BoundedSearch search(graph);
  std::vector<std::map<State, StateRecord>> steps(n);
  std::vector<char> is_candidate(graph.points.size(), 0);
  for (const Index node : candidates(graph, query, 0, filter)) {
    steps[0][{node, no_index}].cost = place_cost(graph, query, 0, node);
  }
  for (std::size_t k = 1; k < n; ++k) {
    const std::vector<Index> next = candidates(graph, query, k, filter);
    for (const Index node : next) is_candidate[node] = 1;
    const double length = query.lengths[k - 1];
    for (const auto& [state, record] : steps[k - 1]) {
      for (const Reached& reached : search.run(state, 3 * length + query.scale, filter)) {
        if (!is_candidate[reached.node]) continue;
        const double stretch = (reached.distance - length) / (length + 0.1 * query.scale);
        const double cost = record.cost + stretch * stretch + place_cost(graph, query, k, reached.node);
        StateRecord& target = steps[k][{reached.node, search.parent(reached.node)}];
        if (cost >= target.cost) continue;
        target.cost = cost;
        target.from = state;
        target.arcs = search.arcs_to(reached.node);
      }
    }
    for (const Index node : next) is_candidate[node] = 0;
    if (steps[k].empty()) return {};
  }
  Chosen chosen;
  State state{no_index, no_index};
  double best = std::numeric_limits<double>::infinity();
  for (const auto& [candidate, record] : steps[n - 1]) {
    if (record.cost < best) {
      best = record.cost;
      state = candidate;
    }
  }
  chosen.found = true;
  for (std::size_t k = n; k-- > 0;) {
    const StateRecord& record = steps[k].at(state);
    chosen.nodes.push_back(state.first);
    if (k > 0) chosen.arcs.push_back(record.arcs);
    state = record.from;
  }
  std::reverse(chosen.nodes.begin(), chosen.nodes.end());
  std::reverse(chosen.arcs.begin(), chosen.arcs.end());
  return chosen;
}

/// The query run through twice: its middle is free of the start's arbitrariness.
MatchQuery unrolled_twice(const MatchQuery& loop) {
  MatchQuery twice = loop;
  twice.closed = false;
  twice.controls.insert(twice.controls.end(), loop.controls.begin() + 1, loop.controls.end());
  twice.limits.insert(twice.limits.end(), loop.limits.begin() + 1, loop.limits.end());
  twice.sides.insert(twice.sides.end(), loop.sides.begin() + 1, loop.sides.end());
  twice.lengths.insert(twice.lengths.end(), loop.lengths.begin(), loop.lengths.end());
  return twice;
}

}  // namespace

SampledFeatures sample_features(const TargetSurface& target, double spacing) {
  const FeatureGraph& features = target.features();
  SampledFeatures graph;
  graph.points = features.corners;
  graph.corner_count = static_cast<Index>(features.corners.size());
  graph.point_normals.resize(graph.points.size());
  std::iota(graph.point_normals.begin(), graph.point_normals.end(), 0);
  std::vector<Vec3> probes = features.corners;
  struct Link {
    Index from, to;
    FeaturePiece along;
  };
  std::vector<Link> links;
  for (Index c = 0; c < static_cast<Index>(features.chains.size()); ++c) {
    const FeatureChain& chain = features.chains[c];
    const bool loop = chain.start == no_index;
    if (!(chain.length > 0)) continue;
    const Index first_probe = static_cast<Index>(probes.size());
    const int side_samples = side_sample_count(chain);
    for (int i = 0; i < side_samples; ++i) {
      probes.push_back(target.chain_point(c, chain.length * (i + 0.5) / side_samples).position);
    }
    const double wanted = spacing > 0 ? chain.length / spacing : 2048.0;
    const int count = static_cast<int>(std::clamp(std::ceil(wanted), 16.0, 2048.0));
    Index previous = chain.start;
    Index first = chain.start;
    for (int j = loop ? 0 : 1; j <= count; ++j) {
      Index node = no_index;
      if (j == count) {
        node = loop ? first : chain.end;
      } else {
        node = static_cast<Index>(graph.points.size());
        graph.points.push_back(target.chain_point(c, chain.length * j / count).position);
        graph.point_normals.push_back(first_probe + std::min(side_samples * j / count, side_samples - 1));
      }
      if (j == 0) {
        first = node;
      } else {
        links.push_back({previous, node, {c, chain.length * (j - 1) / count, chain.length * j / count}});
        graph.piece_chain.push_back(c);
        graph.piece_kind.push_back(chain.kind);
        graph.piece_length.push_back(chain.length / count);
      }
      previous = node;
    }
  }
  graph.piece_count = static_cast<Index>(links.size());
  std::vector<std::vector<SampledFeatures::Arc>> arcs(graph.points.size());
  for (Index p = 0; p < graph.piece_count; ++p) {
    const Link& link = links[p];
    const double length = graph.piece_length[p];
    arcs[link.from].push_back({link.to, p, link.along, length});
    arcs[link.to].push_back({link.from, p, {link.along.chain, link.along.s_end, link.along.s_begin}, length});
  }
  for (const auto& row : arcs) graph.arcs.push_row(row);
  graph.normals = normals_at(target, probes);
  return graph;
}

MatchedRun find_run(const SampledFeatures& graph, const MatchQuery& query, const GraphFilter& filter) {
  MatchQuery fixed = query;
  if (query.closed) {
    const Chosen twice = viterbi(graph, unrolled_twice(query), filter);
    if (!twice.found) return {};
    fixed.first_node = fixed.last_node = twice.nodes[query.controls.size() - 1];
  }
  const Chosen chosen = viterbi(graph, fixed, filter);
  MatchedRun run;
  if (!chosen.found) return run;

  std::vector<const SampledFeatures::Arc*> all;
  run.nodes = chosen.nodes;
  run.s.push_back(0);
  for (const auto& step : chosen.arcs) {
    double s = run.s.back();
    for (const SampledFeatures::Arc* arc : step) {
      s += arc->length;
      run.pieces.push_back(arc->piece);
      all.push_back(arc);
    }
    run.s.push_back(s);
  }
  // A run that uses an arc twice went back on itself: the chain has no place here.
  std::vector<Index> sorted = run.pieces;
  std::sort(sorted.begin(), sorted.end());
  if (std::adjacent_find(sorted.begin(), sorted.end()) != sorted.end()) return run;

  std::vector<double> chain_length(
      graph.piece_chain.empty()
          ? 0
          : static_cast<std::size_t>(*std::max_element(graph.piece_chain.begin(), graph.piece_chain.end())) +
                1,
      0.0);
  for (Index p = 0; p < graph.piece_count; ++p) chain_length[graph.piece_chain[p]] += graph.piece_length[p];
  run.path = path_of(all, chain_length);
  run.path.closed = query.closed;

  double total = 0;
  for (const double length : query.lengths) total += length;
  // Fixed ends were judged when they were assigned.
  const bool first_fixed = query.first_node != no_index, last_fixed = query.last_node != no_index;
  const std::size_t begin = first_fixed ? 1 : 0, end = query.controls.size() - (last_fixed ? 1 : 0);
  double sum = 0;
  for (std::size_t k = begin; k < end; ++k) sum += squared_distance(graph, query, k, run.nodes[k]);
  run.cost = end > begin ? std::sqrt(sum / static_cast<double>(end - begin)) / query.scale : 0;
  // Lengths may differ by a factor, and by a fifth of the scale where the chain is shorter than that. Between
  // fixed ends the run may be as short as it likes: the base of a blunt trailing edge is.
  const double slack = 0.2 * query.scale;
  const bool too_short = !(first_fixed && last_fixed) && run.path.length() <= 0.4 * (total - slack);
  run.found = !too_short && run.path.length() < 2.5 * std::max(total, slack);
  return run;
}

}  // namespace flowcage
