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

/// (u, v) of a cell's local coordinates in [-1, 1]^2, within its box.
Vec2 uv_at(const PatchCell& cell, const Vec2& st);

/// Derivatives by (u, v) from those by a cell's local coordinates.
PatchPoint by_uv(const PatchCell& cell, const PatchPoint& by_st);

}  // namespace flowcage
