#pragma once
#include <limits>

#include "occ_bridge/internal/projection_parts.hpp"

namespace flowcage {

/// A candidate for the answer; ordered by distance (border points a rounding later), then face.
struct Candidate {
  double key = std::numeric_limits<double>::infinity();
  SurfacePoint point;
  Index cell = no_index;  // whose trimming decides
  bool before(const Candidate& other) const {
    return key < other.key || (key == other.key && point.face < other.point.face);
  }
};

/// The outer unit normal of a face at a point with derivatives by (u, v).
Vec3 unit_normal(const ProjectionParts& parts, Index face, const PatchPoint& at, const Vec2& uv);

}  // namespace flowcage
