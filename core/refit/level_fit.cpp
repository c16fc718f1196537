#include "core/refit/level_fit.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <limits>

namespace flowcage {
namespace {

using Clock = std::chrono::steady_clock;  // for the report's seconds only: no result depends on it

/// Weights of the way along the target in tangent-distance passes, one after the other: the first is robust
/// on coarse levels, the second exact.
constexpr std::array tangential_weights{0.1, 0.03};

/// The unrelaxed way must win clearly: even cells are worth something on the levels below.
constexpr double relaxed_credit = 0.7;

CglsSettings pass_cgls(const FitSettings& settings) {
  CglsSettings cgls;
  cgls.max_iterations = settings.max_cgls_iterations;
  cgls.tolerance = 1e-4;
  cgls.damping = 1e-3;  // far below the columns' norms: it only steadies singular systems
  return cgls;
}

/// Creases alone, before the surface: their limit curves depend on their own vertices, so that passes cost
/// next to nothing and can go on until the places on the CAD's edges are the best ones.
class CreasePasses {
 public:
  CreasePasses(const LevelFitInput& input, const CglsSettings& cgls) : input_(input), cgls_(cgls) {
    for (const StageSystem& stage : input.level.system.stages) {
      if (stage.stage != SolveStage::interior) creases_.stages.push_back(stage);
    }
  }

  /// Replaces both by the best found; returns the number of CGLS steps.
  int run(std::vector<Vec3>& control_points, ChainPlaces& places) {
    int iterations = 0;
    double best = std::numeric_limits<double>::infinity();
    std::vector<Vec3> points = control_points;
    ChainPlaces at = places;
    for (int pass = 0; pass < max_passes; ++pass) {
      place(at);
      HierarchicalResult solved =
          solve_hierarchical(creases_, targets_, points, cgls_, {{tangents_, tangential_weight, 1}, {}});
      iterations += solved.iterations;
      points = std::move(solved.control_points);
      impose_planes(input_.planes, input_.level.chains, points);
      find_limits(points);
      at = slid_places(input_.level, input_.match, input_.target, at, limits_);
      place(at);
      const double error = mean_error();
      if (!(error < least_gain * best)) break;
      best = error;
      control_points = points;
      places = at;
    }
    return iterations;
  }

 private:
  static constexpr int max_passes = 40;
  static constexpr double tangential_weight = 0.03, least_gain = 0.98;

  /// Targets and tangents of the creases' samples at these places.
  void place(const ChainPlaces& places) {
    const LevelSystem& level = input_.level;
    targets_.assign(static_cast<std::size_t>(level.sample_count()), Vec3::Zero());
    tangents_ = targets_;
    for (const StageSystem& stage : creases_.stages) {
      for (const Index i : stage.rows) {
        if (level.kind[i] == SampleKind::fixed) targets_[i] = level.fixed_position[i];
        if (level.kind[i] != SampleKind::chain) continue;
        const Index chain = level.sample_chain[i];
        const CurvePoint at = point_on_path(input_.target, input_.match.chains[chain].path,
                                            places[chain][level.sample_on_chain[i]]);
        targets_[i] = at.position;
        tangents_[i] = at.tangent;
      }
    }
  }

  void find_limits(const std::vector<Vec3>& points) {
    limits_ = apply_stencils(input_.level.samples.position, points);
  }

  /// Mean square distance from the paths, across them.
  double mean_error() const {
    double sum = 0;
    for (std::size_t i = 0; i < targets_.size(); ++i) {
      if (tangents_[i].isZero(0)) continue;
      const Vec3 off = limits_[i] - targets_[i];
      sum += (off - tangents_[i] * tangents_[i].dot(off)).squaredNorm();
    }
    return std::sqrt(sum);
  }

  const LevelFitInput& input_;
  const CglsSettings& cgls_;
  HierarchicalSystem creases_;
  std::vector<Vec3> targets_, tangents_, limits_;
};

/// True where a chain matched features and no crease has failed to: what creases alone can be fitted to.
bool has_creases_alone(const LevelSystem& level) {
  for (Index i = 0; i < level.sample_count(); ++i) {
    if (level.kind[i] == SampleKind::chain && level.mirror_axis[i] < 0) return true;
  }
  return false;
}

/// What the passes go through: relaxed passes, then one phase for each weight (point distance: one phase).
class LevelPasses {
 public:
  LevelPasses(const LevelFitInput& input, LevelFitResult& result)
      : input_(input), result_(result), cgls_(pass_cgls(input.settings)) {}

  /// relaxing: number of relaxed passes, and one.
  void run(const std::vector<Vec3>& control_points, int relaxing) {
    const bool tangent = input_.settings.tangent_distance;
    mode_ = {relaxing > 0 ? 0.5 : 0, false};
    FitPass start;
    start.places = input_.level.places;
    std::vector<Vec3> points = control_points;
    if (tangent && has_creases_alone(input_.level)) {
      result_.iterations += CreasePasses(input_, cgls_).run(points, start.places);
    }
    best() = evaluate_pass(input_.level, input_.match, input_.target, points, mode_, &start);
    for (int pass = 1; pass < relaxing; ++pass) {
      if (!improve({}, 2.0)) break;  // relaxation asks too much here: go on without it
    }
    mode_ = {0, tangent};
    best() = evaluate_pass(input_.level, input_.match, input_.target, best().control_points, mode_, &best());
    if (!tangent) return converge(1);
    for (const double weight : tangential_weights) converge(weight);
  }

 private:
  FitPass& best() { return result_.best; }

  /// Passes of one kind until they gain little.
  void converge(double weight) {
    const bool tangent = input_.settings.tangent_distance;
    while (result_.passes < input_.settings.max_passes) {
      const double before = best().score();
      const StageMetrics metrics = tangent ? tangent_metrics(input_.level, best(), weight) : StageMetrics{};
      if (!improve(metrics, 1.0)) return;
      const double gain = before > 0 ? 1 - best().score() / before : 0;
      result_.stopped_because = "converged";
      if (gain < 0.02) return;
    }
    result_.stopped_because = "passes used up";
  }

  /// One pass of refit and projection; halves its step until it is acceptable. False when none is.
  bool improve(const StageMetrics& metrics, double allowed) {
    HierarchicalResult solved =
        solve_hierarchical(input_.level.system, best().targets, best().control_points, cgls_, metrics);
    result_.iterations += solved.iterations;
    ++result_.passes;
    FitPass next = evaluated(std::move(solved.control_points));
    for (int damped = 0; damped < 4 && !acceptable(next, allowed); ++damped) {
      std::vector<Vec3> half(next.control_points.size());
      for (std::size_t v = 0; v < half.size(); ++v) {
        half[v] = 0.5 * (best().control_points[v] + next.control_points[v]);
      }
      next = evaluated(std::move(half));
    }
    if (!acceptable(next, allowed)) {
      result_.stopped_because =
          next.folds > best().folds ? "a further pass would fold" : "the error fell no further";
      return false;
    }
    best() = std::move(next);
    const double diagonal = input_.target.diagonal();
    const std::chrono::duration<double> seconds = Clock::now() - start_;
    result_.history.push_back({best().max / diagonal, best().rms / diagonal, best().folds, result_.iterations,
                               seconds.count(), mode_.relaxation > 0});
    return true;
  }

  FitPass evaluated(std::vector<Vec3> control_points) {
    impose_planes(input_.planes, input_.level.chains, control_points);
    return evaluate_pass(input_.level, input_.match, input_.target, std::move(control_points), mode_,
                         &best());
  }

  bool acceptable(const FitPass& next, double allowed) {
    return next.folds < best().folds ||
           (next.folds == best().folds && next.score() < allowed * best().score());
  }

  const LevelFitInput& input_;
  LevelFitResult& result_;
  CglsSettings cgls_;
  PassMode mode_;
  Clock::time_point start_ = Clock::now();
};

}  // namespace

std::vector<Vec3> interpolating_start(const LevelFitInput& input, const std::vector<Vec3>& cage_points) {
  const LevelSystem& level = input.level;
  const LimitState limit = limit_state(level, cage_points);
  const std::size_t vertices = cage_points.size();
  LimitProjectionSettings projection;
  projection.reach = 3;
  const std::vector<SurfacePoint> feet =
      project_samples(level, input.target, cage_points, limit, {}, projection);
  std::vector<Vec3> targets = limit.points;
  for (std::size_t v = 0; v < vertices; ++v) {
    if (level.kind[v] == SampleKind::fixed) {
      targets[v] = level.fixed_position[v];
    } else if (level.kind[v] == SampleKind::chain) {
      const Index chain = level.sample_chain[v];
      const double s = level.places[chain][level.sample_on_chain[v]];
      targets[v] = point_on_path(input.target, input.match.chains[chain].path, s).position;
    } else if (feet[v].status != FootStatus::failed) {
      targets[v] = feet[v].position;
    }
  }
  targets.resize(vertices);
  StencilTable vertex_rows = level.samples.position;
  const Offset entries = vertex_rows.offsets[vertices];
  vertex_rows.offsets.resize(vertices + 1);
  vertex_rows.indices.resize(static_cast<std::size_t>(entries));
  vertex_rows.weights.resize(static_cast<std::size_t>(entries));
  const HierarchicalSystem system =
      build_hierarchical_system(vertex_rows, level.vertex_stage, level.vertex_stage);
  CglsSettings cgls = pass_cgls(input.settings);
  // Interpolation is singular on a cube (the alternating vector has the limit 0) and nearly so on others.
  cgls.damping = 0.1;
  cgls.tolerance = 1e-8;
  HierarchicalResult solved = solve_hierarchical(system, targets, cage_points, cgls);
  impose_planes(input.planes, level.chains, solved.control_points);
  return solved.control_points;
}

LevelFitResult fit_level(const LevelFitInput& input, const std::vector<Vec3>& control_points) {
  // Relaxed passes even out what a rough cage crowds, but pull vertices off narrow rims that bend. Coarse
  // levels cost little: both ways are gone, and the better one is kept.
  LevelFitResult plain;
  LevelPasses(input, plain).run(control_points, 0);
  const int relaxing = std::max(0, 5 - 2 * input.level.topology.depth);
  if (relaxing == 0) return plain;
  LevelFitResult relaxed;
  LevelPasses(input, relaxed).run(control_points, relaxing);
  const auto better = [](const LevelFitResult& a, const LevelFitResult& b) {
    return a.best.folds != b.best.folds ? a.best.folds < b.best.folds
                                        : a.best.score() < relaxed_credit * b.best.score();
  };
  LevelFitResult& kept = better(plain, relaxed) ? plain : relaxed;
  const LevelFitResult& left = &kept == &plain ? relaxed : plain;
  kept.passes += left.passes;
  kept.iterations += left.iterations;
  return std::move(kept);
}

}  // namespace flowcage
