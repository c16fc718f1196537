#pragma once
#include "core/base/types.hpp"

namespace flowcage {

/// The sphere, box (a cube) or bullet (a half sphere toward the flow, behind it a cylinder as long as wide,
/// closed by a disc) of a far field, about a centre that lies in the symmetry plane of half models.
struct OuterShape {
  enum class Kind : std::uint8_t { sphere, box, bullet } kind = Kind::box;
  Vec3 centre = Vec3::Zero();
  double radius = 1;  ///< of the sphere and the cylinder; of the box half an edge, metres
  /// Columns are the shape's axes, the first downstream for a bullet; identity unless the symmetry plane is
  /// no coordinate plane.
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();

  /// The point of the shape in p's direction from the centre; points already on it keep the coordinates that
  /// put them there to the bit. Precondition: p is not the centre.
  Vec3 project(const Vec3& p) const;
  /// Distance of p from the centre in the shape's own measure: `radius` on it.
  double reach(const Vec3& p) const;
};

}  // namespace flowcage
