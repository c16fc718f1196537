#pragma once
#include <Geom_Curve.hxx>
#include <Geom_Surface.hxx>
#include <memory>
#include <vector>

#include "core/project/closest_on_curve.hpp"
#include "core/target/bounded_patch.hpp"

namespace flowcage {

/// The surface over a parameter window as patches that are at least C1: it is cut at knots where a derivative
/// may jump. B-splines and Bezier surfaces become BSplinePatch; every other kind is evaluated by the kernel's
/// stateless Geom_Surface::D2 (adaptors would cache and are not thread-safe).
std::vector<std::unique_ptr<BoundedPatch>> smooth_patches(const Handle(Geom_Surface) & surface,
                                                          const Eigen::AlignedBox2d& window);

/// A space curve between two parameters.
class OccCurve final : public ParametricCurve {
 public:
  OccCurve(Handle(Geom_Curve) curve, double first, double last);
  CurveDerivatives second(double t) const override;
  std::array<double, 2> domain() const override { return {first_, last_}; }

 private:
  Handle(Geom_Curve) curve_;
  double first_, last_;
};

Vec3 to_vec3(const gp_Pnt& p);
Vec3 to_vec3(const gp_Vec& v);

}  // namespace flowcage
