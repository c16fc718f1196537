#pragma once
#include <array>
#include <functional>
#include <vector>

#include "core/base/csr.hpp"

namespace flowcage {

/// A labelling problem: sites with costs for the labels that they may take, and costs of unequal labels at
/// neighbouring sites.
struct LabelProblem {
  struct Choice {
    Index label = 0;
    double cost = 0;
  };
  Csr<Choice> choices;                           ///< per site; labels not listed cost `refused`
  std::vector<std::array<Index, 2>> neighbours;  ///< pairs of sites
  /// Cost of labels a != b at the two sites of a pair, >= 0, symmetric in a and b.
  std::function<double(Index pair, Index a, Index b)> pair_cost;
  Index label_count = 0;
  double refused = 100;
};

/// Labels of low total cost by alpha-expansion (Boykov, Veksler, Zabih 2001): for one label after the other,
/// a minimum cut finds the best set of sites to turn to it, until none lowers the cost. Pair costs that are
/// no metric are lowered in the cut only; a turn is kept if the true cost falls. Deterministic.
/// `start` (#sites) are the first labels.
std::vector<Index> expand_labels(const LabelProblem& problem, std::vector<Index> start);

/// Sum of all costs of a labelling.
double label_cost(const LabelProblem& problem, const std::vector<Index>& labels);

}  // namespace flowcage
