#pragma once
#include <vector>

#include "core/target/parametric_patch.hpp"

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
};

}  // namespace flowcage
