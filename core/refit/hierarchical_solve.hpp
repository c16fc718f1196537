#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "core/refit/cgls.hpp"

namespace flowcage {

/// The order in which control vertices are solved for: a crease's limit curve depends on the crease's own
/// vertices alone (except at a dart), so corners come first, then creases with corners fixed, then the rest.
enum class SolveStage : std::uint8_t {
  corner,  ///< the limit point is the control vertex itself
  crease,
  interior,  ///< darts too: their limit depends on the surface round them
};

/// One stage: unknowns, and the rows that hold them with everything else moved to the right side.
struct StageSystem {
  SolveStage stage = SolveStage::interior;
  std::vector<Index> unknowns;  ///< control vertices, ascending
  std::vector<Index> rows;      ///< samples, ascending
  LeastSquaresMatrix matrix;    ///< #rows by #unknowns
  StencilTable known;           ///< the rows' other part, over all control vertices
};

struct HierarchicalSystem {
  std::vector<StageSystem> stages;  ///< in the order of solving; stages without unknowns are left out
};

/// Sorts samples into stages. A row serves the last stage among its control vertices; a row of the smooth
/// surface (row_stage interior) never serves an earlier one, even where a coarse cage has nothing but crease
/// vertices round a face.
/// vertex_stage: #control vertices; row_stage: #rows, what the sample itself lies on.
HierarchicalSystem build_hierarchical_system(const StencilTable& positions,
                                             std::span<const SolveStage> vertex_stage,
                                             std::span<const SolveStage> row_stage);

struct HierarchicalResult {
  std::vector<Vec3> control_points;
  int iterations = 0;  ///< CGLS steps of all stages
};

/// Metrics of the two later stages; each holds a direction per sample, or none.
struct StageMetrics {
  RowMetric crease, interior;
};

/// New control points from a target per sample (#rows of `positions`), solved stage by stage from the warm
/// start.
HierarchicalResult solve_hierarchical(const HierarchicalSystem& system, std::span<const Vec3> targets,
                                      std::span<const Vec3> start, const CglsSettings& settings,
                                      const StageMetrics& metrics = {});

}  // namespace flowcage
