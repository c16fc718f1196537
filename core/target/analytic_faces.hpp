#pragma once
#include <memory>
#include <string>
#include <vector>

#include "core/target/parametric_patch.hpp"
#include "core/target/target_surface.hpp"

namespace flowcage {

/// One face with closed-form answers; the building block of AnalyticSurface.
class AnalyticFace : public ParametricPatch {
 public:
  explicit AnalyticFace(std::string name) : name_(std::move(name)) {}
  const std::string& name() const { return name_; }

  /// The nearest point of the face (face number not set). Precondition: a finite query.
  virtual SurfacePoint closest(const Vec3& query) const = 0;
  /// Appends every point of the line origin + t direction (unit) on the face; `distance` is |t|.
  virtual void intersect(const Vec3& origin, const Vec3& direction,
                         std::vector<SurfacePoint>& hits) const = 0;
  virtual Vec3 normal(const Vec2& uv) const = 0;
  virtual Box3 box() const = 0;
  /// Appends a triangulation, counter-clockwise seen from the normal's side.
  virtual void tessellate(Index face, Tessellation& mesh) const = 0;

 private:
  std::string name_;
};

struct Frame {
  Vec3 origin, x, y, z;
};
/// A right-handed frame with the given unit z axis.
Frame frame_along(const Vec3& origin, const Vec3& z);

/// A straight segment or circular arc in the half plane (rho >= 0, z). Traversed so that the face's outer
/// side is on its right.
struct Profile {
  Vec2 center = Vec2::Zero();  ///< arc: centre; segment: start
  double radius = 0;           ///< 0: segment
  Vec2 end = Vec2::Zero();     ///< segment only
  double first = 0, last = 0;  ///< arc: angles from the rho axis; segment: 0 and its length
};
Profile arc_profile(const Vec2& center, double radius, const Vec2& first_last);
Profile segment_profile(const Vec2& start, const Vec2& end);

/// A full turn of a profile about the frame's z axis: sphere, torus, cylinder, cone, disc. u is the angle
/// from the x axis, v the profile's angle or length.
std::unique_ptr<AnalyticFace> revolution_face(std::string name, const Frame& frame, const Profile& profile);

/// origin + u a^ + v b^ for u in [0, |a|], v in [0, |b|]; a perpendicular to b, normal a x b.
std::unique_ptr<AnalyticFace> rectangle_face(std::string name, const Vec3& origin, const Vec3& a,
                                             const Vec3& b);

}  // namespace flowcage
