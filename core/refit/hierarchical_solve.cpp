#include "core/refit/hierarchical_solve.hpp"

#include <algorithm>
#include <cassert>

namespace flowcage {
namespace {

StageSystem build_stage(const StencilTable& positions, std::span<const SolveStage> vertex_stage,
                        std::span<const SolveStage> row_stage, SolveStage stage) {
  StageSystem system;
  system.stage = stage;
  std::vector<Index> column(vertex_stage.size(), no_index);
  for (std::size_t v = 0; v < vertex_stage.size(); ++v) {
    if (vertex_stage[v] != stage) continue;
    column[v] = static_cast<Index>(system.unknowns.size());
    system.unknowns.push_back(static_cast<Index>(v));
  }
  StencilTable free;
  free.control_vertex_count = static_cast<Index>(system.unknowns.size());
  system.known.control_vertex_count = positions.control_vertex_count;
  // The values of mirror planes stay with the known part.
  free.mirrors = system.known.mirrors = positions.mirrors;
  free.of_vectors = true;
  system.known.of_vectors = positions.of_vectors;
  if (stage == SolveStage::interior) {  // nearly all of it
    free.indices.reserve(positions.indices.size());
    free.weights.reserve(positions.indices.size());
  }
  for (Index r = 0; r < positions.size(); ++r) {
    if (row_stage[r] > stage) continue;
    bool has_unknown = false;
    bool has_later = false;
    for (Offset k = positions.offsets[r]; k < positions.offsets[r + 1]; ++k) {
      const SolveStage s = vertex_stage[positions.indices[k]];
      has_unknown = has_unknown || s == stage;
      has_later = has_later || s > stage;
    }
    if (!has_unknown || has_later) continue;
    system.rows.push_back(r);
    for (Offset k = positions.offsets[r]; k < positions.offsets[r + 1]; ++k) {
      const Index v = positions.indices[k];
      StencilTable& part = column[v] == no_index ? system.known : free;
      part.indices.push_back(column[v] == no_index ? v : column[v]);
      part.weights.push_back(positions.weights[k]);
      for (int axis = 0; axis < 3; ++axis) {
        if (positions.mirrors.on[axis]) {
          part.mirrored_weights[axis].push_back(positions.mirrored_weights[axis][k]);
        }
      }
    }
    free.offsets.push_back(static_cast<Offset>(free.indices.size()));
    system.known.offsets.push_back(static_cast<Offset>(system.known.indices.size()));
  }
  system.matrix = prepare_least_squares(std::move(free));
  return system;
}

}  // namespace

HierarchicalSystem build_hierarchical_system(const StencilTable& positions,
                                             std::span<const SolveStage> vertex_stage,
                                             std::span<const SolveStage> row_stage) {
  assert(static_cast<Index>(row_stage.size()) == positions.size());
  assert(static_cast<Index>(vertex_stage.size()) == positions.control_vertex_count);
  HierarchicalSystem system;
  for (const SolveStage stage : {SolveStage::corner, SolveStage::crease, SolveStage::interior}) {
    StageSystem part = build_stage(positions, vertex_stage, row_stage, stage);
    if (!part.unknowns.empty()) system.stages.push_back(std::move(part));
  }
  return system;
}

HierarchicalResult solve_hierarchical(const HierarchicalSystem& system, std::span<const Vec3> targets,
                                      std::span<const Vec3> start, const CglsSettings& settings,
                                      const StageMetrics& metrics) {
  HierarchicalResult result;
  result.control_points.assign(start.begin(), start.end());
  for (const StageSystem& stage : system.stages) {
    std::vector<Vec3> right_side = apply_stencils(stage.known, result.control_points);
    static const RowMetric plain;
    const RowMetric& metric = stage.stage == SolveStage::interior ? metrics.interior
                              : stage.stage == SolveStage::crease ? metrics.crease
                                                                  : plain;
    const bool weighted = !metric.directions.empty();
    RowMetric stage_metric{{}, metric.along, metric.across};
    if (weighted) stage_metric.directions.resize(stage.rows.size());
    for (std::size_t i = 0; i < stage.rows.size(); ++i) {
      right_side[i] = targets[stage.rows[i]] - right_side[i];
      if (weighted) stage_metric.directions[i] = metric.directions[stage.rows[i]];
    }
    std::vector<Vec3> x(stage.unknowns.size());
    for (std::size_t i = 0; i < x.size(); ++i) x[i] = result.control_points[stage.unknowns[i]];
    CglsSettings stage_settings = settings;
    // Creases and corners hold the surface: they are small systems and solved to rounding.
    if (stage.stage != SolveStage::interior) {
      stage_settings.tolerance = 1e-13;
      stage_settings.max_iterations = std::max(settings.max_iterations, 200);
    }
    const CglsResult solved = solve_cgls(stage.matrix, right_side, x, stage_settings, stage_metric);
    result.iterations += solved.iterations;
    for (std::size_t i = 0; i < x.size(); ++i) result.control_points[stage.unknowns[i]] = solved.solution[i];
  }
  return result;
}

}  // namespace flowcage
