#pragma once
#include <array>

#include "core/base/types.hpp"

namespace flowcage {

struct CurveDerivatives {
  Vec3 position, d, dd;
};

/// A smooth parametric curve. Thread-safe.
class ParametricCurve {
 public:
  virtual ~ParametricCurve() = default;
  virtual CurveDerivatives second(double t) const = 0;
  virtual std::array<double, 2> domain() const = 0;
};

struct CurveSearch {
  double low = 0, high = 1;  ///< search this part of the domain
  double start = 0.5;
  double length = 1;         ///< size of the model, what the tolerance is relative to
  double tolerance = 1e-12;  ///< of the last step
  int max_iterations = 60;
};

struct CurveFoot {
  double t = 0;
  Vec3 position = Vec3::Zero();
  double distance = 0;
  bool converged = false;
  int evaluations = 0;  ///< of the curve
};

/// A local minimum of the distance from `query` over [low, high], downhill from the start: Newton's method on
/// the squared distance, the tangent's foot where the second derivative is not positive, halved steps.
CurveFoot closest_on_curve(const ParametricCurve& curve, const Vec3& query, const CurveSearch& search);

}  // namespace flowcage
