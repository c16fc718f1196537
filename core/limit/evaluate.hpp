#pragma once
#include <memory>
#include <span>
#include <vector>

#include "core/mesh/surface_level.hpp"

namespace flowcage {

/// A place on the limit surface: face of the level and (u,v) in [0,1]^2 with (0,0) at corner 0, (1,0) at
/// corner 1, (1,1) at corner 2. On a face that is no quad: `corner` names the child quad, (0,0) at that
/// corner and (1,1) at the face's midpoint; ignored on quads.
struct LimitLocation {
  Index face = 0;
  double u = 0, v = 0;
  Index corner = 0;
};

struct LimitPoint {
  Vec3 position, du, dv;  ///< du and dv by the location's parameters; du x dv is on the fluid's side
};

/// Exact evaluation of the limit surface anywhere (Stam 1998), infinitely sharp creases, corners, darts and
/// boundaries included; semi-sharp creases by refining until they have decayed. At an extraordinary vertex
/// itself du and dv are the limit tangents, not the (vanishing or unbounded) derivatives.
class LimitEvaluator {
 public:
  explicit LimitEvaluator(SurfaceLevel level);
  ~LimitEvaluator();
  LimitEvaluator(LimitEvaluator&&) noexcept;
  LimitEvaluator& operator=(LimitEvaluator&&) noexcept;

  /// Any thread. Precondition: points.size() == level.vertex_count().
  LimitPoint evaluate(std::span<const Vec3> points, const LimitLocation& at) const;

 private:
  struct Tables;
  std::unique_ptr<const Tables> tables_;
};

}  // namespace flowcage
