#include "core/refit/level_fit.hpp"

#include <algorithm>
#include <array>

#include "core/base/stopwatch.hpp"
#include "core/refit/unfold.hpp"

namespace flowcage {
namespace {

/// Weights of the way along the target in tangent-distance passes, one after the other: the first is robust
/// on coarse levels, the last lets lines that a rough cage has set askew straighten out.
constexpr std::array tangential_weights{0.1, 0.03, 0.01};

/// The unrelaxed way must win clearly: even cells are worth something on the levels below.
constexpr double relaxed_credit = 0.7;

CglsSettings pass_cgls(const FitSettings& settings) {
  CglsSettings cgls;
  cgls.max_iterations = settings.max_cgls_iterations;
  cgls.tolerance = 1e-4;
  cgls.damping = 1e-3;  // far below the columns' norms: it only steadies singular systems
  return cgls;
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
    best() = evaluate_pass(input_.level, input_.match, input_.target, control_points, mode_, nullptr);
    for (int pass = 1; pass < relaxing; ++pass) {
      if (!improve({}, 2.0)) break;  // relaxation asks too much here: go on without it
    }
    mode_ = {0, tangent};
    best() = evaluate_pass(input_.level, input_.match, input_.target, best().control_points, mode_, &best());
    if (tangent) {
      for (const double weight : tangential_weights) converge(weight);
    } else {
      converge(1);
    }
    best() = unfolded(best());  // although it costs accuracy: a valid surface comes first
  }

 private:
  FitPass& best() { return result_.best; }

  /// The pass with fewer folds where the least change of its control points brings that.
  FitPass unfolded(FitPass pass) {
    if (pass.folds() == 0) return pass;
    FitPass open = evaluated(unfolded_points(input_.level, pass));
    return open.folds() < pass.folds() ? open : pass;
  }

  /// Passes of one kind until they gain little.
  void converge(double weight) {
    const bool tangent = input_.settings.tangent_distance;
    // Each weight has passes of its own on the cage, which may be rough; below, where a pass costs more and
    // the start is good, they share.
    const bool on_cage = input_.level.topology.depth == 0;
    const int last = (on_cage ? result_.passes : 0) + input_.settings.max_passes;
    while (result_.passes < last) {
      const double before = best().score();
      const StageMetrics metrics = tangent ? tangent_metrics(input_.level, best(), weight) : StageMetrics{};
      if (!improve(metrics, 1.0)) return;
      const double gain = before > 0 ? 1 - best().score() / before : 0;
      result_.stopped_because = "converged";
      if (gain < 0.025) return;
    }
    result_.stopped_because = "passes used up";
  }

  /// One pass of refit and projection. Where it folds it is unfolded, or else takes its steps back; then the
  /// whole step is halved until it is acceptable. False when none is.
  bool improve(const StageMetrics& metrics, double allowed) {
    HierarchicalResult solved =
        solve_hierarchical(input_.level.system, best().targets, best().control_points, cgls_, metrics);
    result_.iterations += solved.iterations;
    ++result_.passes;
    FitPass next = unfolded(evaluated(std::move(solved.control_points)));
    std::vector<bool> held(next.control_points.size(), false);
    for (int held_back = 0; held_back < 3 && next.folds() > best().folds(); ++held_back) {
      next = evaluated(held_where_folded(next, held));
    }
    for (int damped = 0; damped < 4 && !acceptable(next, allowed); ++damped) {
      std::vector<Vec3> half(next.control_points.size());
      for (std::size_t v = 0; v < half.size(); ++v) {
        half[v] = 0.5 * (best().control_points[v] + next.control_points[v]);
      }
      next = evaluated(std::move(half));
    }
    if (!acceptable(next, allowed)) {
      result_.stopped_because =
          next.folds() > best().folds() ? "a further pass would fold" : "the error fell no further";
      return false;
    }
    best() = std::move(next);
    const double diagonal = input_.target.diagonal();
    result_.history.push_back({best().max / diagonal, best().rms / diagonal, best().folds(),
                               result_.iterations, time_.seconds(), mode_.relaxation > 0});
    return true;
  }

  /// The pass without its steps round the faces that fold, so that one place does not stop all others.
  std::vector<Vec3> held_where_folded(const FitPass& next, std::vector<bool>& held) {
    const SurfaceLevel& t = input_.level.topology;
    for (const Index folded : next.folded) {
      for (const Index corner : t.face_vertices[folded]) {
        for (const Index f : t.vertex_faces[corner]) {
          for (const Index v : t.face_vertices[f]) held[v] = true;
        }
      }
    }
    std::vector<Vec3> points = next.control_points;
    for (std::size_t v = 0; v < points.size(); ++v) {
      if (held[v]) points[v] = best().control_points[v];
    }
    return points;
  }

  FitPass evaluated(std::vector<Vec3> control_points) {
    impose_planes(input_.planes, input_.level.chains, control_points);
    return evaluate_pass(input_.level, input_.match, input_.target, std::move(control_points), mode_,
                         &best());
  }

  bool acceptable(const FitPass& next, double allowed) {
    return next.folds() < best().folds() ||
           (next.folds() == best().folds() && next.score() < allowed * best().score());
  }

  const LevelFitInput& input_;
  LevelFitResult& result_;
  CglsSettings cgls_;
  PassMode mode_;
  Stopwatch time_;
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
    return a.best.folds() != b.best.folds() ? a.best.folds() < b.best.folds()
                                            : a.best.score() < relaxed_credit * b.best.score();
  };
  LevelFitResult& kept = better(plain, relaxed) ? plain : relaxed;
  const LevelFitResult& left = &kept == &plain ? relaxed : plain;
  kept.passes += left.passes;
  kept.iterations += left.iterations;
  return std::move(kept);
}

}  // namespace flowcage
