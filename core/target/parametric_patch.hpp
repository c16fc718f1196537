#pragma once
#include "core/base/types.hpp"

namespace flowcage {

struct PatchPoint {
  Vec3 position, du, dv;
};
struct PatchCurvature {
  Vec3 position, du, dv, duu, duv, dvv;
};

/// One smooth parametric face without its trimming: what Newton's method needs. Thread-safe.
class ParametricPatch {
 public:
  virtual ~ParametricPatch() = default;
  virtual PatchPoint first(const Vec2& uv) const = 0;
  virtual PatchCurvature second(const Vec2& uv) const = 0;
  virtual Eigen::AlignedBox2d domain() const = 0;
  virtual bool periodic_u() const = 0;
  virtual bool periodic_v() const = 0;
};

}  // namespace flowcage
