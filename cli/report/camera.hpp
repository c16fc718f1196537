#pragma once
#include <algorithm>
#include <cmath>
#include <span>

#include "core/base/types.hpp"

namespace flowcage {

/// A parallel projection to pixels: x to the right, y down, z toward the viewer, all in pixels.
struct Camera {
  Vec3 right = Vec3::UnitX(), up = Vec3::UnitZ(), toward = -Vec3::UnitY();  ///< right-handed, unit
  Vec3 target = Vec3::Zero();                                               ///< shown at `centre`
  double pixels_per_metre = 1;
  Vec2 centre = Vec2::Zero();

  Vec3 project(const Vec3& p) const {
    const Vec3 d = pixels_per_metre * (p - target);
    return {centre.x() + right.dot(d), centre.y() - up.dot(d), toward.dot(d)};
  }
};

/// Stands at `toward` from the target; z is up, or y where one looks along z.
inline Camera camera_from(const Vec3& toward, const Vec3& target) {
  Camera camera;
  camera.toward = toward.normalized();
  const Vec3 upward = std::abs(camera.toward.z()) > 0.99 ? Vec3(Vec3::UnitY()) : Vec3(Vec3::UnitZ());
  camera.right = upward.cross(camera.toward).normalized();
  camera.up = camera.toward.cross(camera.right);
  camera.target = target;
  return camera;
}

/// So that the points fill width x height pixels round the centre, as far as their shape allows.
inline void fit_points(Camera& camera, std::span<const Vec3> points, double width, double height) {
  Eigen::AlignedBox2d seen;
  for (const Vec3& p : points) seen.extend(Vec2(camera.right.dot(p), camera.up.dot(p)));
  if (seen.isEmpty()) return;
  const Vec2 middle = seen.center(), size = seen.sizes();
  camera.target += (middle.x() - camera.right.dot(camera.target)) * camera.right +
                   (middle.y() - camera.up.dot(camera.target)) * camera.up;
  camera.pixels_per_metre = 1 / std::max({size.x() / width, size.y() / height, 1e-300});
}

}  // namespace flowcage
