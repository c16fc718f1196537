#include "core/project/closest_on_curve.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace flowcage {

CurveFoot closest_on_curve(const ParametricCurve& curve, const Vec3& query, const CurveSearch& search) {
  CurveFoot foot;
  foot.t = std::clamp(search.start, search.low, search.high);
  const auto evaluate = [&] {
    ++foot.evaluations;
    return curve.second(foot.t);
  };
  CurveDerivatives at = evaluate();
  Vec3 r = at.position - query;
  for (int iteration = 0; iteration < search.max_iterations; ++iteration) {
    const double f = 0.5 * r.squaredNorm(), slope = r.dot(at.d), speed = at.d.squaredNorm();
    const double bend = speed + r.dot(at.dd);
    double step = speed > 0 ? -slope / (bend > 1e-3 * speed ? bend : std::max(speed, -bend)) : 0.0;
    step = std::clamp(foot.t + step, search.low, search.high) - foot.t;
    const double length = std::abs(step) * std::sqrt(speed);
    if (!std::isfinite(length)) break;
    if (length <= search.tolerance * search.length) {
      foot.converged = true;
      break;
    }
    // r carries the rounding of the position's coordinates.
    const double noise =
        8 * std::numeric_limits<double>::epsilon() * (f + r.norm() * at.position.cwiseAbs().maxCoeff());
    const double from = foot.t;
    const CurveDerivatives at_from = at;
    bool fell = false;
    for (double lambda = 1; lambda > 1e-9 && !fell; lambda *= 0.5) {
      foot.t = std::clamp(from + lambda * step, search.low, search.high);
      at = evaluate();
      r = at.position - query;
      const double change = 0.5 * r.squaredNorm() - f;
      fell = change <= 1e-4 * lambda * step * slope || (change <= noise && -step * slope <= 1e3 * noise);
    }
    if (!fell) {
      foot.t = from;
      at = at_from;
      foot.converged = false;
      break;
    }
  }
  foot.position = at.position;
  foot.distance = (at.position - query).norm();
  return foot;
}

}  // namespace flowcage
