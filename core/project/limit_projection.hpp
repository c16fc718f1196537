#pragma once
#include <span>
#include <vector>

#include "core/target/target_surface.hpp"

namespace flowcage {

/// Points of the limit surface that are to be laid on the target.
struct LimitQueries {
  std::span<const Vec3> points;
  std::span<const Vec3> normals;        ///< unit, of the limit surface; zero where it has none (a corner)
  std::span<const double> lengths;      ///< local edge length of the limit mesh
  std::span<const SurfacePoint> hints;  ///< empty, or the results of the pass before
};

struct LimitProjectionSettings {
  double min_cosine = 0.35;  ///< between limit normal and target normal: what is compatible
  double reach = 1.5;        ///< farthest compatible point, in local edge lengths
  double near = 0.1;         ///< a nearest point within this many edge lengths with a compatible normal is
                             ///< taken at once: there the line and the perpendicular agree to second order
};

/// One target point for each query (status `failed` where nothing plausible lies within reach): along the
/// limit normal to a face of compatible normal, else the nearest compatible point, else the nearest point if
/// its normal does not oppose the limit's. On thin bodies the nearest point alone lies on the wrong side of
/// the medial axis (docs/theory.md). `distance` is from the query to the point.
std::vector<SurfacePoint> project_limit_points(const TargetSurface& target, const LimitQueries& queries,
                                               const LimitProjectionSettings& settings = {});

}  // namespace flowcage
