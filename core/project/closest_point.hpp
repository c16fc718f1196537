#pragma once
#include <limits>
#include <optional>

#include "core/target/parametric_patch.hpp"

namespace flowcage {

/// How a step in (u, v) is found. Notation: r = S(u,v) - query, f = |r|^2 / 2, g = (r . S_u, r . S_v).
enum class FootMethod : std::uint8_t {
  /// Rom and Brakhage 2011: the foot of the perpendicular from the query on the tangent plane, I (du,dv) = -g
  /// with the first fundamental form I, times the damping lambda. Converges linearly, rate |1 - (1 - d k)
  /// lambda| for a normal curvature k and a signed distance d.
  tangent_plane,
  /// Newton's method on f, H = I + r . (S_uu, S_uv; S_uv, S_vv). Where H is not positive definite, the
  /// minimum of the quadratic model over the domain's box if f falls there, otherwise the tangent-plane step
  /// damped by the largest curvature. Converges quadratically.
  newton,
};

struct ClosestPointSettings {
  FootMethod method = FootMethod::newton;
  double damping = 1;        ///< lambda of the tangent-plane step, in (0, 1]
  double tolerance = 1e-12;  ///< of the last step, relative to `length`
  double length = 0;         ///< size of the model; 0: the patch's own extent, estimated at the start
  int max_iterations = 60;
  std::optional<Eigen::AlignedBox2d> window;  ///< search only this part of the domain; nothing wraps then
  /// End as soon as f is convex over the window and its lower bound f + min over the window of g . d shows
  /// that no point of it is nearer than this.
  double give_up_above = std::numeric_limits<double>::infinity();
  /// f counts as convex over the window where the smallest eigenvalue of H relative to I is above this at the
  /// iterate: a bound of how much it can fall elsewhere in the window.
  double convexity_margin = std::numeric_limits<double>::infinity();
};

enum class FootConvergence : std::uint8_t {
  converged,        ///< a local minimum of the distance over the domain
  stationary,       ///< a saddle or maximum (the tangent-plane step cannot leave it)
  stalled,          ///< no descent within rounding though the step is not small (a kink of the patch)
  iteration_limit,  ///< still moving
  given_up,         ///< see give_up_above
  no_number,        ///< the query, the start or the patch is not finite
};

struct PatchFoot {
  Vec2 uv = Vec2::Zero();
  PatchPoint point;
  double distance = 0;
  bool convex = false;     ///< by convexity_margin, at some iterate: the only minimum over the window
  bool at_border = false;  ///< held by the domain's border: the residual need not be normal
  FootConvergence convergence = FootConvergence::no_number;
  int iterations = 0;
  int evaluations = 0;  ///< of the patch
};

/// A local minimum of the distance from `query` over the patch's domain, downhill from `start`. Steps solve
/// the quadratic model on the domain's box exactly (so a border's active set is found in one step) and are
/// halved until f falls. Periodic parameters wrap. At a border that is collapsed to a point (a pole) the
/// direction of steepest descent over the whole border is tried before the pole itself is accepted.
PatchFoot closest_point(const ParametricPatch& patch, const Vec3& query, const Vec2& start,
                        const ClosestPointSettings& settings = {});

}  // namespace flowcage
