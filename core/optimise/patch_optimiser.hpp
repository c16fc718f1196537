#pragma once
#include <chrono>

#include "core/optimise/slide.hpp"
#include "core/optimise/untangle.hpp"

namespace flowcage {

/// What is left of the limits on work and time, shared by all patches of one call.
struct WorkBudget {
  double cell_evaluations = 0;
  std::chrono::steady_clock::time_point end = std::chrono::steady_clock::time_point::max();
  bool reached = false;

  /// Whether work may go on; false from the first time on that a limit is reached.
  bool left() {
    reached = reached || cell_evaluations <= 0 || std::chrono::steady_clock::now() >= end;
    return !reached;
  }
};

struct PatchOutcome {
  std::vector<Vec3> positions;  ///< #points of the patch
  int passes = 0, iterations = 0, evaluations = 0;
};

/// Untangles and smooths one patch: never more inverted cells than `positions` has, nor at the same number a
/// lower least scaled Jacobian. `positions` are in units of `unit` metres, a power of two.
struct PatchInput {
  const HexPatch& patch;
  std::vector<Vec3> positions;
  double unit = 1;
};
PatchOutcome optimise_patch(const PatchInput& input, const UntangleSettings& settings, WorkBudget& budget,
                            Progress& progress);

}  // namespace flowcage
