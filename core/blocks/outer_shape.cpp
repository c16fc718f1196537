#include "core/blocks/outer_shape.hpp"

namespace flowcage {

double OuterShape::reach(const Vec3& p) const {
  const Vec3 local = axes.transpose() * (p - centre);
  if (kind == Kind::box) return local.cwiseAbs().maxCoeff();
  const bool behind = kind == Kind::bullet && local.x() > 0;
  return behind ? std::max(local.x(), std::hypot(local.y(), local.z())) : local.norm();
}

Vec3 OuterShape::project(const Vec3& p) const {
  const Vec3 d = p - centre;
  if (kind == Kind::sphere) return centre + d * (radius / d.norm());
  if (kind == Kind::bullet) return centre + d * (radius / reach(p));
  if (axes != Eigen::Matrix3d::Identity()) {
    Vec3 local = axes.transpose() * d;
    local *= radius / local.cwiseAbs().maxCoeff();
    return centre + axes * local;
  }
  const double largest = d.cwiseAbs().maxCoeff();
  Vec3 q;
  for (int axis = 0; axis < 3; ++axis) {
    const double side = std::copysign(radius, d[axis]);
    // A coordinate within rounding of the side is on it: box edges and corners stay sharp.
    const bool on_side = std::abs(d[axis]) >= largest * (1 - 1e-12);
    q[axis] = on_side ? centre[axis] + side : centre[axis] + d[axis] * (radius / largest);
  }
  return q;
}

}  // namespace flowcage
