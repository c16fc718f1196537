#pragma once
#include <memory>
#include <vector>

#include "core/target/bounded_patch.hpp"

namespace flowcage {

/// A tensor-product B-spline surface, rational or not; clamped or not.
/// poles[i * count_v + j], i along u; knots are flat (repeated by multiplicity), count + degree + 1 of them.
/// The surface is defined on [knots[degree], knots[count]] in each direction.
struct BSplineSurface {
  int degree_u = 1, degree_v = 1;
  std::vector<double> knots_u, knots_v;
  std::vector<Vec3> poles;
  std::vector<double> weights;  ///< empty, or one positive weight a pole
  int count_u() const { return static_cast<int>(knots_u.size()) - degree_u - 1; }
  int count_v() const { return static_cast<int>(knots_v.size()) - degree_v - 1; }
};

/// Direct evaluation by the basis functions of one knot span (The NURBS Book, A2.3 and A3.6): no cache, so
/// any number of threads may use it. On a knot the one-sided derivatives are those from inside of the window.
class BSplinePatch final : public BoundedPatch {
 public:
  static constexpr int max_degree = 30;

  /// `window` restricts the domain to a sub-box, within the surface's own. Preconditions: consistent array
  /// sizes, degrees in [1, max_degree], positive weights.
  BSplinePatch(std::shared_ptr<const BSplineSurface> surface, const Eigen::AlignedBox2d& window);

  PatchPoint first(const Vec2& uv) const override;
  PatchCurvature second(const Vec2& uv) const override;
  Eigen::AlignedBox2d domain() const override { return window_; }
  bool periodic_u() const override { return false; }
  bool periodic_v() const override { return false; }

  std::vector<double> breaks(int axis) const override;
  std::optional<BezierNet> bezier(const Eigen::AlignedBox2d& box) const override;
  /// From the box's Bezier net, so a true bound.
  Vec2 deviation(const Eigen::AlignedBox2d& box) const override;
  void positions(std::span<const double> u, std::span<const double> v, std::span<Vec3> points) const override;

 private:
  std::shared_ptr<const BSplineSurface> surface_;
  std::vector<double> net_;  // x y z, or w x, w y, w z, w
  Eigen::AlignedBox2d window_;
  int first_span_[2] = {0, 0}, last_span_[2] = {0, 0};
};

}  // namespace flowcage
