#pragma once
#include "core/refit/measured_surface.hpp"
#include "core/target/target_surface.hpp"

namespace flowcage {

struct Coverage {
  double max_distance = 0, rms_distance = 0;  ///< metres
  Vec3 worst_place = Vec3::Zero();            ///< on the target
  Index samples = 0;
};

/// Distances from points of the target (its tessellation's points, and its triangles' midpoints laid on the
/// faces) to the limit surface of a level: a lost tip or a missed pocket shows here and not in the distance
/// from the fitted surface to the target. The nearest limit point is found by a box tree over the limit mesh
/// and then by Gauss-Newton steps on the exact limit surface, across faces, so the measure's own error is
/// rounding. At most about max_samples points, evenly picked. Parallel, deterministic.
Coverage measure_coverage(MeasuredSurface& surface, const TargetSurface& target, Index max_samples = 60000);

}  // namespace flowcage
