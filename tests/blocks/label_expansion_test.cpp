#include "core/blocks/label_expansion.hpp"

#include <random>

#include "tests/catch.hpp"

using namespace flowcage;

namespace {

/// Sites on a 3 x 3 grid with random costs of `labels` labels; unequal neighbours cost a random weight.
LabelProblem random_problem(Index labels, unsigned seed, std::vector<double>& weights) {
  std::mt19937 random(seed);
  const auto number = [&] { return static_cast<double>(random() % 1000) / 1000; };
  LabelProblem problem;
  problem.label_count = labels;
  for (int s = 0; s < 9; ++s) {
    std::vector<LabelProblem::Choice> row;
    for (Index l = 0; l < labels; ++l) row.push_back({l, number()});
    problem.choices.push_row(row);
  }
  weights.clear();
  for (Index s = 0; s < 9; ++s) {
    if (s % 3 != 2) problem.neighbours.push_back({s, s + 1});
    if (s < 6) problem.neighbours.push_back({s, s + 3});
  }
  for (std::size_t n = 0; n < problem.neighbours.size(); ++n) weights.push_back(number());
  problem.pair_cost = [&weights](Index pair, Index, Index) { return weights[pair]; };
  return problem;
}

double least_cost(const LabelProblem& problem) {
  double least = 1e300;
  int count = 1;
  for (int s = 0; s < 9; ++s) count *= problem.label_count;
  for (int code = 0; code < count; ++code) {
    std::vector<Index> labels;
    for (int s = 0, rest = code; s < 9; ++s, rest /= problem.label_count)
      labels.push_back(rest % problem.label_count);
    least = std::min(least, label_cost(problem, labels));
  }
  return least;
}

}  // namespace

TEST_CASE("two labels: the minimum cut is the least cost of all labellings") {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    std::vector<double> weights;
    const LabelProblem problem = random_problem(2, seed, weights);
    CAPTURE(seed);
    CHECK(label_cost(problem, expand_labels(problem, std::vector<Index>(9, 0))) ==
          Approx(least_cost(problem)).epsilon(1e-12));
  }
}

TEST_CASE("three labels: within the known bound, and nearly always the least") {
  int exact = 0;
  for (unsigned seed = 1; seed <= 20; ++seed) {
    std::vector<double> weights;
    const LabelProblem problem = random_problem(3, seed, weights);
    const double cost = label_cost(problem, expand_labels(problem, std::vector<Index>(9, 0)));
    const double least = least_cost(problem);
    CAPTURE(seed);
    CHECK(cost <= 2 * least);  // Boykov, Veksler, Zabih (2001), theorem 6.1: factor 2 for Potts' model
    exact += cost < least + 1e-12 ? 1 : 0;
  }
  CHECK(exact >= 17);
}

TEST_CASE("a label that is no choice of a site costs `refused`") {
  LabelProblem problem;
  problem.label_count = 2;
  problem.choices.push_row(std::vector<LabelProblem::Choice>{{0, 1.0}});
  problem.choices.push_row(std::vector<LabelProblem::Choice>{{1, 1.0}});
  problem.neighbours = {{0, 1}};
  problem.pair_cost = [](Index, Index, Index) { return 5.0; };
  CHECK(expand_labels(problem, {1, 0}) == std::vector<Index>{0, 1});
  CHECK(label_cost(problem, {1, 1}) == Approx(101));
}
