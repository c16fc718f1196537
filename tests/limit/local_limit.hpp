// The limit of one vertex by brute force: its ring is cut out and refined again and again.
#pragma once
#include <array>

#include "core/subdivide/refine.hpp"

namespace flowcage {

/// The ring of a vertex after `depth` refinements (0: of a level below the cage). With `zoom` the points are
/// moved and scaled after each, so that the vertex is the origin and the farthest point lies within [0.5, 1]
/// of it: directions keep their digits.
struct LocalRing {
  SurfaceLevel level;  ///< the faces at the vertex, nothing else; the vertex is number 0
  std::vector<Vec3> points;
};
struct RingRequest {
  Index vertex = 0;
  int depth = 1;
  bool zoom = false;
};
LocalRing refined_ring(const SurfaceLevel& level, const std::vector<Vec3>& points,
                       const RingRequest& request);

}  // namespace flowcage
