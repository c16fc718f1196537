#include "core/refit/fit_surface.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>

#include "core/base/parallel.hpp"
#include "core/project/limit_projection.hpp"
#include "core/refit/boundary_planes.hpp"
#include "core/refit/cage_check.hpp"
#include "core/refit/coverage.hpp"
#include "core/refit/deviation.hpp"
#include "core/refit/level_system.hpp"
#include "core/subdivide/refine.hpp"

// Notation of Rom & Brakhage (2011), section 3: V are the control vertices of a level, C the limit stencils
// of its samples, L = C V the limit points, L^s their places on the CAD's surfaces. One pass: project L to
// L^s, then solve C V = L^s in the least-squares sense.
namespace flowcage {
namespace {

constexpr double no_limit = std::numeric_limits<double>::infinity();

using Clock = std::chrono::steady_clock;  // for the report's seconds only: no result depends on it

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// One pass's view of the control points: limit points, their places on the target, distances, folds.
struct Pass {
  std::vector<Vec3> control_points;
  LimitState limit;
  std::vector<SurfacePoint> feet;  ///< #samples; of relaxed points while relaxing
  std::vector<Vec3> targets;       ///< #samples, L^s
  double rms = 0, max = 0;
  Index folds = 0;

  /// What has to fall from pass to pass: the mean error, with a share of the largest one.
  double score() const { return rms + 0.05 * max; }
};

/// project_limit_points for the samples that have no place on a feature; the others stay `failed`.
std::vector<SurfacePoint> project_samples(const LevelSystem& level, const TargetSurface& target,
                                          std::span<const Vec3> queries, const LimitState& limit,
                                          std::span<const SurfacePoint> hints,
                                          const LimitProjectionSettings& settings = {}) {
  std::vector<Index> chosen;
  std::vector<Vec3> points, normals;
  std::vector<double> lengths;
  std::vector<SurfacePoint> known;
  for (std::size_t i = 0; i < queries.size(); ++i) {
    if (level.kind[i] == SampleKind::chain || level.kind[i] == SampleKind::fixed) continue;
    chosen.push_back(static_cast<Index>(i));
    points.push_back(queries[i]);
    normals.push_back(limit.normals[i]);
    lengths.push_back(limit.lengths[i]);
    if (!hints.empty()) known.push_back(hints[i]);
  }
  const std::vector<SurfacePoint> feet =
      project_limit_points(target, {points, normals, lengths, known}, settings);
  std::vector<SurfacePoint> all(queries.size());
  for (std::size_t k = 0; k < chosen.size(); ++k) all[chosen[k]] = feet[k];
  return all;
}

Pass evaluate(const LevelSystem& level, const TargetSurface& target, std::vector<Vec3> control_points,
              double relaxation, std::span<const SurfacePoint> hints) {
  Pass pass;
  pass.control_points = std::move(control_points);
  pass.limit = limit_state(level, pass.control_points);
  const std::size_t count = pass.limit.points.size();
  std::vector<Vec3> queries = pass.limit.points;
  if (relaxation > 0) {
    const std::vector<Vec3> moves = tangential_relaxation(level, pass.limit, relaxation);
    for (std::size_t i = 0; i < count; ++i) queries[i] += moves[i];
  }
  pass.feet = project_samples(level, target, queries, pass.limit, hints);
  pass.targets.resize(count);
  std::vector<Vec3> target_normals(count, Vec3::Zero());
  double sum = 0;
  Index measured = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3& at = pass.limit.points[i];
    double error = 0;
    switch (level.kind[i]) {
      case SampleKind::fixed:
        pass.targets[i] = level.feature_position[i];
        error = (at - pass.targets[i]).norm();
        break;
      case SampleKind::chain: {
        pass.targets[i] = level.feature_position[i];
        const Vec3 off = at - pass.targets[i];
        error = (off - level.feature_tangent[i] * level.feature_tangent[i].dot(off)).norm();
        break;
      }
      case SampleKind::surface:
      case SampleKind::crease:
        // Without a plausible place the sample stays where it is: its neighbours carry it.
        if (pass.feet[i].status == FootStatus::failed) {
          pass.targets[i] = at;
          continue;
        }
        pass.targets[i] = pass.feet[i].position;
        target_normals[i] = pass.feet[i].normal;
        // While relaxing, the way along the surface is no error.
        error = pass.feet[i].status == FootStatus::interior && relaxation > 0
                    ? std::abs((at - pass.targets[i]).dot(pass.feet[i].normal))
                    : (at - pass.targets[i]).norm();
        break;
    }
    sum += error * error;
    pass.max = std::max(pass.max, error);
    ++measured;
  }
  pass.rms = std::sqrt(sum / std::max<Index>(measured, 1));
  pass.folds = static_cast<Index>(folded_faces(level, pass.limit, target_normals).size());
  return pass;
}

/// Tangent planes as the metric of the interior stage: features keep the distance to their points.
RowMetric tangent_metric(const LevelSystem& level, const Pass& pass) {
  RowMetric metric;
  metric.tangential_weight = 0.1;
  metric.normals.assign(pass.targets.size(), Vec3::Zero());
  for (std::size_t i = 0; i < pass.targets.size(); ++i) {
    if (level.kind[i] == SampleKind::surface && pass.feet[i].status == FootStatus::interior) {
      metric.normals[i] = pass.feet[i].normal;
    }
  }
  return metric;
}

/// Passes of projection and refit on one level, from V; V is replaced by the best found.
class LevelFit {
 public:
  LevelFit(const LevelSystem& level, const TargetSurface& target, std::span<const ChainPlane> planes,
           const FitSettings& settings)
      : level_(level), target_(target), planes_(planes), settings_(settings) {
    cgls_.max_iterations = settings.max_cgls_iterations;
    cgls_.tolerance = 1e-4;
    cgls_.damping = 1e-3;  // far below the columns' norms: it only steadies singular systems
  }

  /// Interpolating start (level 0): project the cage's own vertices and solve limit = projection.
  std::vector<Vec3> interpolating_start(const std::vector<Vec3>& cage_points) {
    const LimitState limit = limit_state(level_, cage_points);
    const std::size_t vertices = cage_points.size();
    LimitProjectionSettings projection;
    projection.reach = 3;
    const std::vector<SurfacePoint> feet =
        project_samples(level_, target_, cage_points, limit, {}, projection);
    std::vector<Vec3> targets = limit.points;
    for (std::size_t v = 0; v < vertices; ++v) {
      const bool feature = level_.kind[v] == SampleKind::fixed || level_.kind[v] == SampleKind::chain;
      if (feature) {
        targets[v] = level_.feature_position[v];
      } else if (feet[v].status != FootStatus::failed) {
        targets[v] = feet[v].position;
      }
    }
    StencilTable vertex_rows = level_.samples.position;
    const Offset entries = vertex_rows.offsets[vertices];
    vertex_rows.offsets.resize(vertices + 1);
    vertex_rows.indices.resize(static_cast<std::size_t>(entries));
    vertex_rows.weights.resize(static_cast<std::size_t>(entries));
    std::vector<Vec3> start(targets.begin(), targets.begin() + static_cast<Offset>(vertices));
    const HierarchicalSystem system =
        build_hierarchical_system(vertex_rows, level_.vertex_stage, level_.vertex_stage);
    CglsSettings cgls = cgls_;
    // Interpolation is singular on a cube (the alternating vector has the limit 0) and nearly so on others.
    cgls.damping = 0.1;
    cgls.tolerance = 1e-8;
    HierarchicalResult solved = solve_hierarchical(system, start, cage_points, cgls);
    iterations_ += solved.iterations;
    impose_planes(planes_, level_.chains, solved.control_points);
    return solved.control_points;
  }

  void run(std::vector<Vec3>& control_points) {
    const int depth = level_.topology.depth;
    const int relaxing = std::max(0, 5 - 2 * depth);
    double relaxation = relaxing > 0 ? 0.5 : 0;
    best_ = evaluate(level_, target_, control_points, relaxation, {});
    int damped = 0;
    for (int pass = 1; pass <= settings_.max_passes; ++pass) {
      relaxation = pass < relaxing ? 0.5 : 0;
      const bool tangent = settings_.tangent_distance && pass > relaxing;
      HierarchicalResult solved =
          solve_hierarchical(level_.system, best_.targets, best_.control_points, cgls_,
                             tangent ? tangent_metric(level_, best_) : RowMetric{});
      iterations_ += solved.iterations;
      impose_planes(planes_, level_.chains, solved.control_points);
      Pass next = evaluate(level_, target_, std::move(solved.control_points), relaxation, best_.feet);
      const bool measured_alike = pass != relaxing;
      const double allowed = pass <= relaxing ? 2.0 : 1.0;
      damped = 0;
      while (!acceptable(next, allowed) && damped < 4) {
        std::vector<Vec3> half(next.control_points.size());
        for (std::size_t v = 0; v < half.size(); ++v) {
          half[v] = 0.5 * (best_.control_points[v] + next.control_points[v]);
        }
        impose_planes(planes_, level_.chains, half);
        next = evaluate(level_, target_, std::move(half), relaxation, best_.feet);
        ++damped;
      }
      ++passes_;
      if (!acceptable(next, allowed)) {
        if (pass < relaxing) {  // relaxation asks too much here: go on without it
          best_ = evaluate(level_, target_, best_.control_points, 0, best_.feet);
          pass = relaxing;
          continue;
        }
        stopped_because_ =
            next.folds > best_.folds ? "a further pass would fold" : "the error fell no further";
        break;
      }
      const double gain = best_.score() > 0 ? 1 - next.score() / best_.score() : 0;
      best_ = std::move(next);
      if (pass > relaxing && measured_alike && gain < 0.02) {
        stopped_because_ = "converged";
        break;
      }
    }
    if (stopped_because_.empty()) stopped_because_ = "passes used up";
    control_points = best_.control_points;
  }

  const Pass& best() const { return best_; }
  int passes() const { return passes_; }
  int iterations() const { return iterations_; }
  const std::string& stopped_because() const { return stopped_because_; }

 private:
  bool acceptable(const Pass& next, double allowed) const {
    return next.folds < best_.folds || (next.folds == best_.folds && next.score() < allowed * best_.score());
  }

  const LevelSystem& level_;
  const TargetSurface& target_;
  std::span<const ChainPlane> planes_;
  const FitSettings& settings_;
  CglsSettings cgls_;
  Pass best_;
  int passes_ = 0;
  int iterations_ = 0;
  std::string stopped_because_;
};

/// One sentence about the sharp edges and open boundaries that nothing of the cage follows, with the longest.
std::string unmatched_warning(const FeatureMatch& match, const TargetSurface& target) {
  const std::vector<FeatureChain>& chains = target.features().chains;
  const auto shorter = [&](Index a, Index b) { return chains[a].length < chains[b].length; };
  const FeatureChain& longest =
      chains[*std::max_element(match.unmatched_chains.begin(), match.unmatched_chains.end(), shorter)];
  const Vec3& a = longest.polyline.front();
  const Vec3& b = longest.polyline[longest.polyline.size() / 2];
  return fmt::format(
      "no crease of the cage follows {} of the CAD's {} chains of sharp or open edges (the longest, {:.4g} "
      "m, "
      "from ({:.6g}, {:.6g}, {:.6g}) over ({:.6g}, {:.6g}, {:.6g})): the surface is rounded there; mark the "
      "cage's edges along them as creases",
      match.unmatched_chains.size(), chains.size(), longest.length, a.x(), a.y(), a.z(), b.x(), b.y(), b.z());
}

std::vector<VertexTarget> vertex_targets(const LevelSystem& level, const FeatureMatch& match,
                                         const TargetSurface& target, const Pass& pass) {
  const Index vertices = level.topology.vertex_count();
  const std::span<const Vec3> points = std::span(pass.limit.points).first(static_cast<std::size_t>(vertices));
  const std::vector<SurfacePoint> feet = project_samples(level, target, points, pass.limit, pass.feet);
  std::vector<VertexTarget> targets(points.size());
  for (Index v = 0; v < vertices; ++v) {
    VertexTarget& t = targets[v];
    switch (level.kind[v]) {
      case SampleKind::fixed:
        t.kind = VertexTarget::Kind::corner;
        t.position = level.feature_position[v];
        break;
      case SampleKind::chain: {
        const ChainMatch& chain = match.chains[level.sample_chain[v]];
        t.kind = VertexTarget::Kind::chain;
        t.chain = chain_on_path(chain.path, level.sample_s[v]);
        t.position = level.feature_position[v];
        break;
      }
      case SampleKind::surface:
      case SampleKind::crease:
        if (feet[v].status == FootStatus::failed) {
          t.position = points[v];
        } else {
          t.kind = VertexTarget::Kind::face;
          t.position = feet[v].position;
        }
        break;
    }
  }
  return targets;
}

/// The next level's chains, keeping their order (and with it their matches).
std::vector<CreaseChain> child_chains(const std::vector<CreaseChain>& chains, const SurfaceLevel& parent,
                                      const SurfaceLevel& child) {
  std::vector<CreaseChain> result;
  result.reserve(chains.size());
  for (const CreaseChain& chain : chains) result.push_back(child_chain(chain, parent, child));
  return result;
}

}  // namespace

SurfaceFit fit_surface(const Cage& cage, const TargetSurface& target, const FitSettings& settings,
                       Progress& progress) {
  SurfaceFit fit;
  progress.step("fit, level 0", 0);
  const double diagonal = target.diagonal();
  SurfaceLevel topology = build_surface_level(cage);
  check_cage_belongs(cage, target);

  std::vector<CreaseChain> chains = crease_chains(topology);
  const FeatureMatch match = match_features(topology, cage.points, chains, target);
  fit.unmatched_chains = match.unmatched_chains;
  fit.warnings = match.warnings;
  if (!match.unmatched_chains.empty()) fit.warnings.push_back(unmatched_warning(match, target));
  const std::vector<ChainPlane> planes = chain_planes(chains, match, target);
  for (const std::string& warning : fit.warnings) progress.warn(warning);

  std::vector<Vec3> control_points = cage.points;
  auto level = std::make_unique<LevelSystem>(
      build_level_system(std::move(topology), std::move(chains), match, target));
  for (int depth = 0;; ++depth) {
    progress.step(fmt::format("fit, level {}", depth), static_cast<double>(depth) / (settings.levels + 1));
    const Clock::time_point start = Clock::now();
    LevelFit pass_loop(*level, target, planes, settings);
    if (depth == 0) control_points = pass_loop.interpolating_start(control_points);
    pass_loop.run(control_points);

    SurfaceLevel child = build_child_level(level->topology);
    std::vector<CreaseChain> below = child_chains(level->chains, level->topology, child);
    const StencilTable refinement = refinement_stencils(level->topology);
    auto next =
        std::make_unique<LevelSystem>(build_level_system(std::move(child), std::move(below), match, target));
    std::vector<Vec3> next_points = apply_stencils(refinement, control_points);
    impose_planes(planes, next->chains, next_points);
    const double accepted = settings.tolerance > 0 ? settings.tolerance * diagonal : 0.0;
    const Deviation deviation =
        measure_deviation(next->topology, next->samples.position, next_points,
                          {.target = target, .search_below = depth == settings.levels ? no_limit : accepted});

    LevelReport report;
    report.level = depth;
    report.control_vertices = level->topology.vertex_count();
    report.samples = level->sample_count();
    report.max_deviation = deviation.max / diagonal;
    report.rms_deviation = deviation.rms / diagonal;
    report.worst_place = deviation.worst_place;
    report.passes = pass_loop.passes();
    report.solver_iterations = pass_loop.iterations();
    report.folds = pass_loop.best().folds;
    report.stopped_because = pass_loop.stopped_because();
    const bool last =
        depth == settings.levels || (settings.tolerance > 0 && report.max_deviation <= settings.tolerance);
    if (last) {
      fit.vertex_targets = vertex_targets(*level, match, target, pass_loop.best());
      const Coverage coverage = measure_coverage(next->topology, next_points, target);
      fit.max_deviation = report.max_deviation;
      fit.rms_deviation = report.rms_deviation;
      fit.worst_place = report.worst_place;
      fit.coverage_deviation = coverage.max_distance / diagonal;
      fit.worst_coverage_place = coverage.worst_place;
    }
    report.seconds = seconds_since(start);
    fit.levels.push_back({std::move(level->topology), std::move(control_points), std::move(report)});
    if (last) break;
    control_points = std::move(next_points);
    level = std::move(next);
  }
  progress.report("fit", 1);
  return fit;
}

}  // namespace flowcage
