#include "core/blocks/label_expansion.hpp"

#include <algorithm>
#include <limits>

namespace flowcage {
namespace {

/// Minimum cut by Dinic's algorithm (1970): shortest augmenting paths, level by level.
class MinimumCut {
 public:
  explicit MinimumCut(Index nodes)
      : out_(static_cast<std::size_t>(nodes) + 2), source_(nodes), sink_(nodes + 1) {}
  void add_edge(Index from, Index to, double capacity) {
    out_[from].push_back(static_cast<Index>(edges_.size()));
    edges_.push_back({to, capacity});
    out_[to].push_back(static_cast<Index>(edges_.size()));
    edges_.push_back({from, 0});
  }
  /// Cost `keep` if the node stays with the source, `turn` if it goes to the sink.
  void add_costs(Index node, double keep, double turn) {
    const double least = std::min(keep, turn);
    if (turn > least) add_edge(source_, node, turn - least);
    if (keep > least) add_edge(node, sink_, keep - least);
  }
  /// True for nodes on the sink's side.
  std::vector<char> solve() {
    while (make_levels()) {
      next_.assign(out_.size(), 0);
      while (push(source_, std::numeric_limits<double>::infinity()) > 0) {
      }
    }
    std::vector<char> turned(out_.size() - 2);
    for (std::size_t n = 0; n < turned.size(); ++n) turned[n] = level_[n] < 0 ? 1 : 0;
    return turned;
  }

 private:
  struct Edge {
    Index to;
    double capacity;
  };
  static constexpr double nothing = 1e-12;

  bool make_levels() {
    level_.assign(out_.size(), -1);
    std::vector<Index> queue{source_};
    level_[source_] = 0;
    for (std::size_t head = 0; head < queue.size(); ++head) {
      for (const Index e : out_[queue[head]]) {
        const Edge& edge = edges_[e];
        if (edge.capacity <= nothing || level_[edge.to] >= 0) continue;
        level_[edge.to] = level_[queue[head]] + 1;
        queue.push_back(edge.to);
      }
    }
    return level_[sink_] >= 0;
  }
  double push(Index node, double amount) {
    if (node == sink_) return amount;
    for (std::size_t& i = next_[node]; i < out_[node].size(); ++i) {
      const Index e = out_[node][i];
      if (edges_[e].capacity <= nothing || level_[edges_[e].to] != level_[node] + 1) continue;
      const double pushed = push(edges_[e].to, std::min(amount, edges_[e].capacity));
      if (pushed <= 0) continue;
      edges_[e].capacity -= pushed;
      edges_[e ^ 1].capacity += pushed;
      return pushed;
    }
    return 0;
  }

  std::vector<std::vector<Index>> out_;
  std::vector<Edge> edges_;
  std::vector<int> level_;
  std::vector<std::size_t> next_;
  Index source_, sink_;
};

double site_cost(const LabelProblem& problem, Index site, Index label) {
  for (const LabelProblem::Choice& c : problem.choices[site]) {
    if (c.label == label) return c.cost;
  }
  return problem.refused;
}

double pair_cost(const LabelProblem& problem, Index pair, Index a, Index b) {
  return a == b ? 0 : problem.pair_cost(pair, a, b);
}

}  // namespace

double label_cost(const LabelProblem& problem, const std::vector<Index>& labels) {
  double sum = 0;
  for (Index s = 0; s < static_cast<Index>(labels.size()); ++s) sum += site_cost(problem, s, labels[s]);
  for (Index n = 0; n < static_cast<Index>(problem.neighbours.size()); ++n) {
    sum += pair_cost(problem, n, labels[problem.neighbours[n][0]], labels[problem.neighbours[n][1]]);
  }
  return sum;
}

std::vector<Index> expand_labels(const LabelProblem& problem, std::vector<Index> start) {
  constexpr int most_rounds = 8;
  std::vector<Index> labels = std::move(start);
  const auto sites = static_cast<Index>(labels.size());
  double cost = label_cost(problem, labels);
  for (int round = 0; round < most_rounds; ++round) {
    bool changed = false;
    for (Index alpha = 0; alpha < problem.label_count; ++alpha) {
      MinimumCut cut(sites);
      std::vector<double> keep(labels.size()), turn(labels.size());
      for (Index s = 0; s < sites; ++s) {
        keep[s] = site_cost(problem, s, labels[s]);
        turn[s] = site_cost(problem, s, alpha);
      }
      for (Index n = 0; n < static_cast<Index>(problem.neighbours.size()); ++n) {
        const auto& [p, q] = problem.neighbours[n];
        const double p_turns = pair_cost(problem, n, alpha, labels[q]);
        const double q_turns = pair_cost(problem, n, labels[p], alpha);
        const double neither = std::min(pair_cost(problem, n, labels[p], labels[q]), p_turns + q_turns);
        // neither + (p_turns - neither) x_p - p_turns x_q + (p_turns + q_turns - neither) (1 - x_p) x_q
        turn[p] += p_turns - neither;
        keep[q] += p_turns;
        if (p_turns + q_turns > neither) cut.add_edge(p, q, p_turns + q_turns - neither);
      }
      for (Index s = 0; s < sites; ++s) cut.add_costs(s, keep[s], turn[s]);
      const std::vector<char> turned = cut.solve();
      std::vector<Index> next = labels;
      for (Index s = 0; s < sites; ++s) {
        if (turned[s] != 0) next[s] = alpha;
      }
      const double next_cost = label_cost(problem, next);
      constexpr double least_gain = 1e-9;
      if (next_cost >= cost - least_gain) continue;
      labels = std::move(next);
      cost = next_cost;
      changed = true;
    }
    if (!changed) break;
  }
  return labels;
}

}  // namespace flowcage
