#pragma once
#include <algorithm>
#include <array>

#include "core/base/types.hpp"

namespace flowcage {

/// Barycentric coordinates of the point of a triangle (which may be degenerate) nearest to p.
inline Vec3 nearest_barycentric(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, ac = c - a, ap = p - a;
  const double d00 = ab.squaredNorm(), d01 = ab.dot(ac), d11 = ac.squaredNorm();
  const double d20 = ap.dot(ab), d21 = ap.dot(ac);
  const double denominator = d00 * d11 - d01 * d01;
  if (denominator > 1e-30 * d00 * d11) {
    const double v = (d11 * d20 - d01 * d21) / denominator, w = (d00 * d21 - d01 * d20) / denominator;
    if (v >= 0 && w >= 0 && v + w <= 1) return {1 - v - w, v, w};
  }
  const std::array<Vec3, 3> corner{a, b, c};
  Vec3 best(1, 0, 0);
  double least = 1e300;
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3;
    const Vec3 edge = corner[j] - corner[i];
    const double t = std::clamp((p - corner[i]).dot(edge) / std::max(edge.squaredNorm(), 1e-300), 0.0, 1.0);
    const double squared = (corner[i] + t * edge - p).squaredNorm();
    if (squared >= least) continue;
    least = squared;
    best = Vec3::Zero();
    best[i] = 1 - t;
    best[j] = t;
  }
  return best;
}

/// The point of a triangle nearest to p.
inline Vec3 closest_on_triangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 w = nearest_barycentric(p, a, b, c);
  return w[0] * a + w[1] * b + w[2] * c;
}

}  // namespace flowcage
