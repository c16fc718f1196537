#pragma once
#include "core/refit/measured_surface.hpp"
#include "core/target/target_surface.hpp"

namespace flowcage {

/// Metres.
struct Deviation {
  double max = 0, rms = 0;
  Vec3 worst_place = Vec3::Zero();  ///< on the limit surface
};

struct DeviationSettings {
  const TargetSurface& target;
  /// A maximum over the samples that is not above this is searched for between the samples, too.
  double search_below = 0;
  Index searched_faces = 512;
};

/// Distance from the limit surface of a level to the target, at its samples; rms is over them. Between them
/// the distance can be larger, above all where the target has an edge that the surface rounds off: the faces
/// with the worst samples are evaluated on grids of 9 x 9 points, finer ones round the worst. Parallel,
/// deterministic.
Deviation measure_deviation(MeasuredSurface& surface, const DeviationSettings& settings);

}  // namespace flowcage
