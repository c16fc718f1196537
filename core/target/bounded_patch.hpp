#pragma once
#include <optional>
#include <span>
#include <vector>

#include "core/target/bezier_net.hpp"

namespace flowcage {

/// A patch that knows how far it departs from flat: what a search tree needs to prune safely.
class BoundedPatch : public ParametricPatch {
 public:
  /// Parameters along axis 0 (u) or 1 (v) that no cell may straddle (knots), the domain's ends included,
  /// ascending. Precondition of deviation: the box lies between neighbours of both lists.
  virtual std::vector<double> breaks(int axis) const = 0;

  /// Every point of the surface over the box is within the sum of the two numbers of the convex hull of the
  /// box's four corner points: what bends along u and what bends along v.
  virtual Vec2 deviation(const Eigen::AlignedBox2d& box) const = 0;

  /// The surface over such a box in Bezier form, if it has one: bounds and samples of the box and of all its
  /// halves are cheaper from that.
  virtual std::optional<BezierNet> bezier(const Eigen::AlignedBox2d&) const { return std::nullopt; }

  /// The points at all pairs of u and v, that of (u[i], v[j]) at [j * u.size() + i].
  virtual void positions(std::span<const double> u, std::span<const double> v, std::span<Vec3> points) const {
    for (std::size_t j = 0; j < v.size(); ++j) {
      for (std::size_t i = 0; i < u.size(); ++i) points[j * u.size() + i] = first({u[i], v[j]}).position;
    }
  }
};

}  // namespace flowcage
