#pragma once
#include <span>
#include <vector>

#include "core/base/types.hpp"

namespace flowcage {

/// One quad's corner at a point of a boundary, seen from the fluid.
struct FanCorner {
  Index before = no_index, after = no_index;  ///< the quad's corners next to the point, counter-clockwise
  Vec3 normal = Vec3::Zero();                 ///< into the fluid, unit
  double angle = 0;                           ///< of the quad at the point, radians
};

/// The corner at `at` of a quad (point, after, .., before), counter-clockwise seen from the fluid.
FanCorner fan_corner(std::span<const Vec3> points, Index at, Index after, Index before);

/// Sines of the best angles that the corners round a point can have: each sector's angle shared equally by
/// its quads. Quads whose normals differ by more than `crease_degrees` lie in different sectors.
std::vector<double> best_sines(std::span<const FanCorner> corners, double crease_degrees = 30);

/// The point of the convex hull of `points` that is nearest to the origin (Gilbert's iteration, to 1e-6 of
/// its length). Its direction is the d, |d| <= 1, with the largest least product with the points, its length
/// that product. Precondition: not empty.
Vec3 nearest_in_hull(std::span<const Vec3> points);

}  // namespace flowcage
