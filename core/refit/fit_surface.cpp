#include "core/refit/fit_surface.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "core/base/parallel.hpp"
#include "core/base/stopwatch.hpp"
#include "core/refit/boundary_planes.hpp"
#include "core/refit/cage_check.hpp"
#include "core/refit/cage_fit.hpp"
#include "core/refit/coverage.hpp"
#include "core/refit/deviation.hpp"
#include "core/refit/level_figures.hpp"
#include "core/subdivide/refine.hpp"

// Notation of Rom & Brakhage (2011), section 3: V are the control vertices of a level, C the limit stencils
// of its samples, L = C V the limit points, L^s their places on the CAD's surfaces. One pass: project L to
// L^s, then solve C V = L^s in the least-squares sense.
namespace flowcage {
namespace {

constexpr double no_limit = std::numeric_limits<double>::infinity();

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
                                         const TargetSurface& target, const FitPass& pass) {
  const Index vertices = level.topology.vertex_count();
  const std::span<const Vec3> points = std::span(pass.limit.points).first(static_cast<std::size_t>(vertices));
  const std::vector<SurfacePoint> feet = project_samples(level, target, points, pass.limit, pass.feet);
  std::vector<VertexTarget> targets(points.size());
  for (Index v = 0; v < vertices; ++v) {
    VertexTarget& t = targets[v];
    switch (level.kind[v]) {
      case SampleKind::fixed:
        t.kind = VertexTarget::Kind::corner;
        t.position = level.fixed_position[v];
        break;
      case SampleKind::chain: {
        const ChainMatch& chain = match.chains[level.sample_chain[v]];
        t.kind = VertexTarget::Kind::chain;
        t.chain = chain_on_path(chain.path, pass.places[level.sample_chain[v]][level.sample_on_chain[v]]);
        t.position = pass.targets[v];
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
  check_cage_belongs(cage, target);
  Stopwatch time;
  CageFit first = fit_cage(cage, target, settings);
  const FeatureMatch& match = first.match;
  const std::vector<ChainPlane>& planes = first.planes;
  fit.unmatched_chains = match.unmatched_chains;
  fit.warnings = match.warnings;
  if (settings.name_unmatched && !match.unmatched_chains.empty())
    fit.warnings.push_back(unmatched_warning(match, target));
  for (const std::string& warning : fit.warnings) progress.warn(warning);

  std::unique_ptr<LevelSystem> level = std::move(first.level);
  std::vector<Vec3> control_points;
  for (int depth = 0;; ++depth) {
    progress.step(fmt::format("fit, level {}", depth), static_cast<double>(depth) / (settings.levels + 1));
    if (depth > 0) time = {};
    LevelFitResult fitted = depth == 0 ? std::move(first.fitted)
                                       : fit_level({*level, match, target, planes, settings}, control_points);
    control_points = fitted.best.control_points;

    SurfaceLevel child = build_child_level(level->topology);
    std::vector<CreaseChain> below = child_chains(level->chains, level->topology, child);
    std::vector<Vec3> next_points = apply_stencils(refinement_stencils(level->topology), control_points);
    impose_planes(planes, below, next_points);
    MeasuredSurface surface(std::move(child), std::move(next_points));
    const double accepted = settings.tolerance > 0 ? settings.tolerance * diagonal : 0.0;
    const Deviation deviation = measure_deviation(
        surface, {.target = target, .search_below = depth == settings.levels ? no_limit : accepted});

    LevelReport report;
    report.level = depth;
    report.control_vertices = level->topology.vertex_count();
    report.samples = level->sample_count();
    report.max_deviation = deviation.max / diagonal;
    report.rms_deviation = deviation.rms / diagonal;
    report.worst_place = deviation.worst_place;
    report.passes = fitted.passes;
    report.solver_iterations = fitted.iterations;
    report.folds = fitted.best.folds();
    report.crease_deviation = crease_deviation(surface, below, match, target) / diagonal;
    report.edge_length_ratio = edge_length_ratio(
        level->topology,
        std::span(fitted.best.limit.points).first(static_cast<std::size_t>(report.control_vertices)));
    report.history = std::move(fitted.history);
    report.stopped_because = fitted.stopped_because;
    const bool met = settings.tolerance > 0 && depth >= settings.least_levels &&
                     report.max_deviation <= settings.tolerance;
    const bool last = met || depth == settings.levels;
    if (last) {
      fit.stopped_because = met ? "the tolerance is met" : "all levels are done";
      fit.vertex_targets = vertex_targets(*level, match, target, fitted.best);
      const Coverage coverage = measure_coverage(surface, target);
      fit.max_deviation = report.max_deviation;
      fit.rms_deviation = report.rms_deviation;
      fit.worst_place = report.worst_place;
      fit.coverage_deviation = coverage.max_distance / diagonal;
      fit.worst_coverage_place = coverage.worst_place;
    }
    std::unique_ptr<LevelSystem> next;
    if (!last) {
      next = std::make_unique<LevelSystem>(build_level_system(std::move(surface.level), std::move(below),
                                                              child_places(fitted.best.places), match));
    }
    report.seconds = time.seconds();
    fit.levels.push_back({std::move(level->topology), std::move(control_points), std::move(report)});
    if (last) break;
    control_points = std::move(surface.points);
    level = std::move(next);
  }
  progress.report("fit", 1);
  return fit;
}

}  // namespace flowcage
