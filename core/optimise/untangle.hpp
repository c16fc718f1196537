#pragma once
#include <vector>

#include "core/base/progress.hpp"
#include "core/optimise/hex_validity.hpp"
#include "core/optimise/point_freedom.hpp"
#include "core/optimise/target_lengths.hpp"

namespace flowcage {

struct UntangleSettings {
  std::vector<PointFreedom> freedom;  ///< #points; empty: boundary points fixed, inner ones free
  std::vector<Projector> projectors;  ///< that `freedom` numbers
  TargetLengthSettings target;        ///< shapes that cells are drawn toward
  double lambda = 0.3;                ///< weight of the volume term against the shape term
  int max_untangle_passes = 60;  ///< each lowers epsilon and minimises; they end with the last inverted cell
  int max_smooth_passes = 6;     ///< each minimises the barrier energy; 0: only untangle
  int smooth_exponent = 4;       ///< of the smoothing energy: larger lifts the worst cells more
  int iterations_per_pass = 60;  ///< of L-BFGS
  double relative_decrease = 1e-3;  ///< smoothing ends when a pass lowers the energy's excess by less
  double max_cell_evaluations =
      1e12;                ///< limit on work (cells x evaluations; about 1e6 take a second and core)
  double max_seconds = 0;  ///< limit on time, 0: none; results then depend on the machine. Checked every pass
};

struct LocatedCell {
  Offset cell = 0;
  Vec3 centre = Vec3::Zero();  ///< mean of its corners
  double scaled_jacobian = 0;
};

struct UntangleReport {
  HexValidity before, after;          ///< of the whole mesh
  std::vector<LocatedCell> inverted;  ///< that stay inverted, by number
  Index moving_points = 0;
  Offset optimised_cells = 0;
  int patches = 0;  ///< regions optimised on their own
  int passes = 0, iterations = 0, evaluations = 0;
  bool limit_reached = false;  ///< max_cell_evaluations or max_seconds ended the work
};

struct UntangledPoints {
  std::vector<Vec3> points;  ///< as many as the mesh has; those that may not move keep every bit
  UntangleReport report;
};

/// Makes the mesh foldover-free where that is possible, then smooths it toward the target shapes with a
/// barrier that keeps valid cells valid (foldover_energy.hpp). Never returns anything worse than the input:
/// not more inverted cells, and at the same number no lower minimum of the scaled Jacobian.
///
/// Works for any size of mesh (lengths are made dimensionless). The cost is about 60 to 300 evaluations (1
/// us) of every cell: meant for coarse levels; repair_cells is for fine ones. The same bits for any number of
/// threads. Throws Error(input) when a coordinate is not finite or freedom does not fit, Error(interrupted)
/// by `progress`.
UntangledPoints untangle(const HexView& mesh, const UntangleSettings& settings, Progress& progress);

struct RepairSettings {
  UntangleSettings optimise;
  double threshold = 0.1;  ///< cells with a scaled Jacobian below are repaired, and uncertified ones
  int rings = 3;           ///< of cells round them that may change shape
};

/// The same for the bad cells and a few rings of cells round each: separate regions are separate problems,
/// each by itself never worse than it was. Points elsewhere keep every bit.
UntangledPoints repair_cells(const HexView& mesh, const RepairSettings& settings, Progress& progress);

/// Inverted and uncertified cells, least and mean scaled Jacobian of a mesh.
HexValidity hex_validity(const HexView& mesh);

/// The first `most` cells, by number, that are positive at their corners but not proved positive inside.
std::vector<LocatedCell> unproved_cells(const HexView& mesh, Offset most);

}  // namespace flowcage
