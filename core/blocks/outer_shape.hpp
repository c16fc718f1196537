#pragma once
#include "core/base/types.hpp"

namespace flowcage {

/// The sphere or box (a cube) of a far field, about a centre that lies in the symmetry plane of half models.
struct OuterShape {
  enum class Kind : std::uint8_t { sphere, box } kind = Kind::box;
  Vec3 centre = Vec3::Zero();
  double radius = 1;  ///< of the sphere; of the box half an edge, metres
  /// Columns are the box's axes; identity unless the symmetry plane is no coordinate plane.
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();

  /// The point of the shape in p's direction from the centre; points already on it keep the coordinates that
  /// put them there to the bit. Precondition: p is not the centre.
  Vec3 project(const Vec3& p) const;
};

}  // namespace flowcage
