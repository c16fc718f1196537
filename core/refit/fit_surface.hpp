#pragma once
#include <string>
#include <vector>

#include "core/base/progress.hpp"
#include "core/mesh/cage.hpp"
#include "core/mesh/surface_level.hpp"
#include "core/target/target_surface.hpp"

namespace flowcage {

/// The tunables of the loop; named and documented in core/options.
struct FitSettings {
  int levels = 3;        ///< subdivision levels after the cage
  double tolerance = 0;  ///< stop refining below this deviation (relative to the diagonal); 0: do all levels
  int least_levels = 0;  ///< levels to do however soon the tolerance is met
  int max_passes =
      12;  ///< project-refit passes a level, on the cage for each weight; coarse levels go two ways
  int max_cgls_iterations = 60;
  bool tangent_distance = true;  ///< minimise distances to tangent planes (Gauss-Newton, Wang, Pottmann & Liu
                                 ///< 2006) in the last passes instead of distances to foot points
  bool name_unmatched =
      true;            ///< warn of feature chains that no crease follows; false where find_creases has
  bool mirror = true;  ///< half models: the mirror image's points at symmetry planes (symmetric_level.hpp)
};

/// One pass of projection and refit: errors at the fitted samples, in diagonals.
struct PassReport {
  double max_error = 0, rms_error = 0;
  Index folds = 0;
  int solver_iterations = 0;
  double seconds = 0;    ///< since the level began
  bool relaxed = false;  ///< places on the target were evened out: the error is across the surface only
};

/// One row of the report (CONTRACT: surface.levels). Deviations are relative to the target's diagonal,
/// measured at points that were not fitted.
struct LevelReport {
  int level = 0;
  Index control_vertices = 0, samples = 0;
  double max_deviation = 0, rms_deviation = 0;
  Vec3 worst_place = Vec3::Zero();
  int passes = 0, solver_iterations = 0;
  Index folds = 0;  ///< faces whose limit normal turns against the target's or flips between samples
  double crease_deviation = 0;   ///< of matched creases from their CAD edges, halfway between fitted samples
  double edge_length_ratio = 1;  ///< longest by shortest edge of the limit mesh, largest over its faces
  double seconds = 0;
  std::vector<PassReport> history;
  std::string stopped_because;  ///< the passes
};

struct FittedLevel {
  SurfaceLevel topology;
  std::vector<Vec3> control_points;
  LevelReport report;
};

/// Where a vertex of the last level belongs on the target: what snapping uses.
struct VertexTarget {
  enum class Kind : std::uint8_t { face, chain, corner, none } kind = Kind::none;
  Vec3 position = Vec3::Zero();
  Index chain = no_index;
};

struct SurfaceFit {
  std::vector<FittedLevel> levels;  ///< 0 .. the last one that was made
  double max_deviation = 0, rms_deviation = 0;
  double coverage_deviation = 0;  ///< target to fitted surface
  Vec3 worst_place = Vec3::Zero(), worst_coverage_place = Vec3::Zero();
  std::string stopped_because;          ///< "the tolerance is met" or "all levels are done"
  std::vector<Index> unmatched_chains;  ///< feature chains of the target that no crease of the cage follows
  std::vector<VertexTarget> vertex_targets;  ///< #V of the last level
  std::vector<std::string> warnings;         ///< also given to Progress::warn
};

/// The paper's loop with the five additions of docs/theory.md: interpolating start; feature chains by arc
/// length; projection along the limit normal to compatible faces with nearest point as the fall-back;
/// hierarchical solve (corners, creases, interior) by CGLS; tangential relaxation in early passes. A pass is
/// kept only if nothing folds and the error falls. Throws Error(input) when the cage cannot belong to the
/// target (too far away, turned inside out, wrong unit).
SurfaceFit fit_surface(const Cage& cage, const TargetSurface& target, const FitSettings& settings,
                       Progress& progress);

}  // namespace flowcage
