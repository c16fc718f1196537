#include "core/optimise/patch_optimiser.hpp"

#include "core/base/parallel.hpp"
#include "core/optimise/foldover_energy.hpp"
#include "core/optimise/jacobian_bound.hpp"
#include "core/optimise/lbfgs.hpp"

namespace flowcage {
namespace {

constexpr double no_epsilon = 0;

double chi(double epsilon, double determinant) {
  const double root = std::hypot(epsilon, determinant);
  return determinant > 0 ? 0.5 * (determinant + root) : 0.5 * epsilon * epsilon / (root - determinant);
}

/// The epsilon with chi(epsilon, determinant) = mu. Precondition: mu > determinant, mu > 0.
double epsilon_of_chi(double mu, double determinant) {
  return 2 * std::sqrt(mu * (mu - determinant));
}

class PatchOptimiser {
 public:
  PatchOptimiser(const PatchInput& input, const UntangleSettings& settings, WorkBudget& budget,
                 Progress& progress);
  PatchOutcome run();

 private:
  using Positions = std::vector<Vec3>;
  struct State {
    Positions positions;
    HexValidity validity;
  };

  void untangle();
  void smooth();
  LbfgsResult minimise(const EnergyParameters& parameters, Positions& positions);
  EnergyValue energy_at(const EnergyParameters& parameters, const Positions& positions);
  State measured(Positions positions) const;
  /// Not worse than the input in the order that the caller was promised.
  bool admissible(const HexValidity& v) const;
  bool better(const HexValidity& a, const HexValidity& b) const;
  /// Valid at the corners, not proved valid inside.
  bool uncertified(const Positions& positions, std::size_t cell) const;
  /// Cells that their corners do not prove valid get more samples.
  void mark_thorough(const Positions& positions);
  /// The same for cells that are certified in the best state and lost that in a rejected one: the barrier
  /// then holds them inside as well. Returns whether there was one.
  bool guard_certified(const Positions& rejected);
  void mark_hopeless(const Positions& positions);
  bool smooth_pass(double& excess, Positions& goal);

  const HexPatch& patch_;
  const UntangleSettings& settings_;
  WorkBudget& budget_;
  Progress& progress_;
  SlideContext slide_;
  bool slides_;
  FoldoverProblem problem_;
  std::vector<double> steps_;  ///< #M, for the derivative of projectors
  State start_, best_;
  PatchOutcome outcome_;
};

PatchOptimiser::PatchOptimiser(const PatchInput& input, const UntangleSettings& settings, WorkBudget& budget,
                               Progress& progress)
    : patch_(input.patch),
      settings_(settings),
      budget_(budget),
      progress_(progress),
      slide_{input.patch, settings.projectors, input.unit},
      slides_(has_projected_points(input.patch)) {
  start_ = measured(input.positions);
  best_ = start_;
  problem_.cells = patch_.cells;
  problem_.moving = patch_.moving;
  problem_.moving_corners =
      corners_of_points(patch_.cells, patch_.moving, static_cast<Index>(patch_.point_of.size()));
  std::vector<std::uint8_t> moves(patch_.freedom.size());
  for (std::size_t p = 0; p < moves.size(); ++p) moves[p] = patch_.freedom[p].moves() ? 1 : 0;
  problem_.inverse_lengths = inverse_target_lengths(start_.positions, patch_.cells, moves, settings.target);
  problem_.kinds.resize(patch_.cells.size());
  for (std::size_t m = 0; m < patch_.moving.size(); ++m) {
    float longest = 0;
    for (const Offset at : problem_.moving_corners[static_cast<Index>(m)]) {
      for (const float w : problem_.inverse_lengths[at / 8]) longest = std::max(longest, w);
    }
    steps_.push_back(1e-3 / static_cast<double>(longest));
  }
}

PatchOptimiser::State PatchOptimiser::measured(Positions positions) const {
  const HexValidity validity = measure_validity(patch_.cells, positions);
  return {std::move(positions), validity};
}

bool PatchOptimiser::admissible(const HexValidity& v) const {
  if (v.inverted != start_.validity.inverted) return v.inverted < start_.validity.inverted;
  return v.min_scaled_jacobian >= start_.validity.min_scaled_jacobian;
}

bool PatchOptimiser::better(const HexValidity& a, const HexValidity& b) const {
  if (!admissible(a)) return false;
  if (a.inverted != b.inverted) return a.inverted < b.inverted;
  if (a.uncertified != b.uncertified) return a.uncertified < b.uncertified;
  return a.min_scaled_jacobian > b.min_scaled_jacobian;
}

bool PatchOptimiser::uncertified(const Positions& positions, std::size_t cell) const {
  const HexCornerPoints p = corner_points(positions, patch_.cells[cell]);
  return min_scaled_jacobian(p) > 0 && jacobian_sign(p) != JacobianSign::positive;
}

void PatchOptimiser::mark_thorough(const Positions& positions) {
  for (std::size_t n = 0; n < patch_.cells.size(); ++n) {
    if (uncertified(positions, n)) problem_.kinds[n].thorough = true;
  }
}

bool PatchOptimiser::guard_certified(const Positions& rejected) {
  bool any = false;
  for (std::size_t n = 0; n < patch_.cells.size(); ++n) {
    FoldoverProblem::CellKind& kind = problem_.kinds[n];
    if (kind.thorough || kind.hopeless || !uncertified(rejected, n)) continue;
    if (jacobian_sign(corner_points(best_.positions, patch_.cells[n])) != JacobianSign::positive) continue;
    kind.thorough = true;
    any = true;
  }
  return any;
}

void PatchOptimiser::mark_hopeless(const Positions& positions) {
  for (std::size_t n = 0; n < patch_.cells.size(); ++n) {
    const HexCornerPoints p = corner_points(positions, patch_.cells[n]);
    problem_.kinds[n].hopeless = !(min_scaled_jacobian(p) > 0);
    if (jacobian_sign(p) != JacobianSign::positive) problem_.kinds[n].thorough = false;
  }
}

EnergyValue PatchOptimiser::energy_at(const EnergyParameters& parameters, const Positions& positions) {
  budget_.cell_evaluations -= static_cast<double>(patch_.cells.size());
  return evaluate_energy(problem_, positions, parameters, {});
}

/// One run of L-BFGS over the moving points within their tangent spaces.
LbfgsResult PatchOptimiser::minimise(const EnergyParameters& parameters, Positions& positions) {
  const auto count = static_cast<Offset>(patch_.moving.size());
  const std::vector<Eigen::Matrix3d> tangent = tangent_projections(slide_, positions, steps_);
  std::vector<Eigen::Matrix3d> inverse = energy_blocks(problem_, positions, parameters);
  parallel_for(count, 8192, [&](Offset begin, Offset end) {
    for (Offset m = begin; m < end; ++m) {
      const Eigen::Matrix3d& t = tangent[m];
      const double size = std::max(inverse[m].trace(), std::numeric_limits<double>::min());
      const Eigen::Matrix3d within =
          t * inverse[m] * t + size * (Eigen::Matrix3d::Identity() - t);  // regular: the rest is left alone
      inverse[m] = t * within.inverse() * t;
      if (!inverse[m].allFinite()) inverse[m].setZero();
    }
  });
  std::vector<Vec3> x(patch_.moving.size());
  for (Offset m = 0; m < count; ++m) x[m] = positions[patch_.moving[m]];
  const auto scatter = [&](std::span<const Vec3> from) {
    for (Offset m = 0; m < count; ++m) positions[patch_.moving[m]] = from[m];
  };
  const LbfgsFunction function = [&](std::span<const Vec3> at, std::span<Vec3> gradient) {
    if (progress_.cancelled()) progress_.step("untangle", 0);
    scatter(at);
    const EnergyValue value = evaluate_energy(problem_, positions, parameters, gradient);
    for (Offset m = 0; m < count; ++m) gradient[m] = tangent[m] * gradient[m];
    return value.energy;
  };
  const LbfgsPreconditioner preconditioner = [&](std::span<Vec3> v) {
    for (Offset m = 0; m < count; ++m) v[m] = inverse[m] * v[m];
  };
  LbfgsSettings lbfgs;
  lbfgs.max_iterations = settings_.iterations_per_pass;
  const LbfgsResult result = minimise_lbfgs(function, preconditioner, lbfgs, x);
  scatter(x);
  ++outcome_.passes;
  outcome_.iterations += result.iterations;
  outcome_.evaluations += result.evaluations;
  budget_.cell_evaluations -=
      static_cast<double>(result.evaluations) * static_cast<double>(patch_.cells.size());
  return result;
}

/// The paper's algorithm 1: minimise, lower epsilon by what the minimisation achieved, until no sample is
/// inverted.
void PatchOptimiser::untangle() {
  constexpr int patience = 12;  // passes without progress after which the rest is taken for impossible
  constexpr double start_chi = 0.1;
  constexpr double least_decrease = 0.3;  // of chi in a pass; the paper's 0.1 takes twice the passes
  Positions positions = best_.positions;
  EnergyParameters parameters{settings_.lambda, 1, 1, 1};
  double least = energy_at(parameters, positions).min_determinant;
  parameters.epsilon = epsilon_of_chi(start_chi, std::min(least, 0.0));
  double record = least;
  int since_record = 0;
  for (int pass = 0; pass < settings_.max_untangle_passes && budget_.left(); ++pass) {
    progress_.step("untangle", static_cast<double>(pass) / settings_.max_untangle_passes);
    mark_thorough(positions);
    const Positions before = positions;
    const double energy_before = energy_at(parameters, positions).energy;
    if (!std::isfinite(energy_before)) break;
    minimise(parameters, positions);
    if (slides_) project_points(slide_, before, positions);
    const EnergyValue after = energy_at(parameters, positions);
    const State state = measured(positions);
    least = after.min_determinant;
    const bool fewer = state.validity.inverted < best_.validity.inverted;
    if (better(state.validity, best_.validity)) best_ = state;
    if (best_.validity.inverted == 0 && best_.validity.uncertified == 0) return;
    since_record = fewer || least > record + 0.01 * std::abs(record) ? 0 : since_record + 1;
    record = std::max(record, least);
    if (since_record >= patience) return;
    const double sigma = std::max(least_decrease, 1 - after.energy / energy_before);
    const double mu = (1 - sigma) * chi(parameters.epsilon, least);
    parameters.epsilon = mu > least ? std::max(1e-9, epsilon_of_chi(mu, least)) : 1e-9;
  }
}

/// Minimises the barrier energy from the best state; keeps the result where it is admissible. Returns whether
/// it was; `excess`: the energy above that of perfect cells; `goal`: where the minimisation went.
bool PatchOptimiser::smooth_pass(double& excess, Positions& goal) {
  EnergyParameters parameters{settings_.lambda, no_epsilon, 0.1, settings_.smooth_exponent};
  const double before = energy_at(parameters, best_.positions).energy;
  goal = best_.positions;
  minimise(parameters, goal);
  // Sliding points leave their surface along the tangent: the way back is cut short where it would harm.
  for (double t = 1; t > 0.1; t *= 0.5) {
    Positions positions = best_.positions;
    for (const Index p : patch_.moving) {
      positions[p] = t == 1 ? goal[p] : Vec3(best_.positions[p] + t * (goal[p] - best_.positions[p]));
    }
    if (slides_) project_points(slide_, best_.positions, positions);
    const double after = energy_at(parameters, positions).energy;
    if (!(after < before)) continue;
    State state = measured(std::move(positions));
    if (!admissible(state.validity) || state.validity.inverted > best_.validity.inverted ||
        state.validity.uncertified > best_.validity.uncertified) {
      continue;
    }
    excess = after - 3 - 2 * settings_.lambda;
    best_ = std::move(state);
    return true;
  }
  return false;
}

void PatchOptimiser::smooth() {
  mark_hopeless(best_.positions);
  double excess = std::numeric_limits<double>::infinity();
  for (int pass = 0; pass < settings_.max_smooth_passes && budget_.left(); ++pass) {
    progress_.step("smooth", static_cast<double>(pass) / settings_.max_smooth_passes);
    const double last = excess;
    Positions goal;
    if (!smooth_pass(excess, goal)) {
      if (!guard_certified(goal)) break;
      continue;
    }
    if (std::isfinite(last) && last - excess <= settings_.relative_decrease * last) break;
  }
}

PatchOutcome PatchOptimiser::run() {
  if (start_.validity.inverted > 0 || start_.validity.uncertified > 0) untangle();
  smooth();
  outcome_.positions = std::move(best_.positions);
  return std::move(outcome_);
}

}  // namespace

PatchOutcome optimise_patch(const PatchInput& input, const UntangleSettings& settings, WorkBudget& budget,
                            Progress& progress) {
  return PatchOptimiser(input, settings, budget, progress).run();
}

}  // namespace flowcage
