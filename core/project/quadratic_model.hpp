#pragma once
#include <algorithm>
#include <cmath>

#include "core/base/types.hpp"

namespace flowcage {

/// g . d + d^T (a b; b c) d / 2: half the squared distance around a point, without its value there.
struct QuadraticModel {
  Vec2 g;          // gradient
  double a, b, c;  // symmetric matrix (a b; b c)
  double value(const Vec2& d) const {
    return g.dot(d) + 0.5 * (a * d.x() * d.x() + 2 * b * d.x() * d.y() + c * d.y() * d.y());
  }
};

/// Of steps that stay in the domain: low <= 0 <= high; infinite where it has no end.
struct ParameterBox {
  Vec2 low, high;
};

/// Minimum of a quadratic over a box that contains 0: inside where it is convex, or on one of the four sides.
inline Vec2 minimise_in_box(const QuadraticModel& m, const ParameterBox& box) {
  const double det = m.a * m.c - m.b * m.b;
  if (m.a > 0 && m.c > 0 && det > 1e-14 * m.a * m.c) {
    Vec2 d(-(m.c * m.g.x() - m.b * m.g.y()) / det, -(m.a * m.g.y() - m.b * m.g.x()) / det);
    if ((d.array() >= box.low.array()).all() && (d.array() <= box.high.array()).all()) return d;
  }
  const auto best_along = [](double slope, double curvature, double low, double high) {
    if (curvature > 0) return std::clamp(-slope / curvature, low, high);
    if (!std::isfinite(low) || !std::isfinite(high)) return std::clamp(0.0, low, high);
    const auto at = [&](double t) { return slope * t + 0.5 * curvature * t * t; };
    return at(low) < at(high) ? low : at(high) < at(low) ? high : slope > 0 ? low : high;
  };
  Vec2 best = Vec2::Zero();
  double best_value = 0;
  const auto offer = [&](const Vec2& d) {
    const double value = m.value(d);
    if (value < best_value) {
      best = d;
      best_value = value;
    }
  };
  for (const double u : {box.low.x(), box.high.x()}) {
    if (std::isfinite(u)) offer({u, best_along(m.g.y() + m.b * u, m.c, box.low.y(), box.high.y())});
  }
  for (const double v : {box.low.y(), box.high.y()}) {
    if (std::isfinite(v)) offer({best_along(m.g.x() + m.b * v, m.a, box.low.x(), box.high.x()), v});
  }
  // A direction without influence (a pole): the other one alone.
  offer({0, best_along(m.g.y(), m.c, box.low.y(), box.high.y())});
  offer({best_along(m.g.x(), m.a, box.low.x(), box.high.x()), 0});
  return best;
}

}  // namespace flowcage
