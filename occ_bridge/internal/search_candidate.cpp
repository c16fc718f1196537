#include "occ_bridge/internal/search_candidate.hpp"

namespace flowcage {

Vec3 unit_normal(const ProjectionParts& parts, Index face, const PatchPoint& at, const Vec2& uv) {
  const Vec3 n = at.du.cross(at.dv);
  const double size = n.norm();
  if (size > 1e-6 * at.du.norm() * at.dv.norm() && size > 0) {
    // A pole's u derivative vanishes; beside it the cross product is still good to rounding over its length.
    const BoundedPatch& patch = *parts.patches[parts.faces[face].first_patch];
    const Vec2 extent = patch.domain().sizes();
    const double u = at.du.norm() * extent.x(), v = at.dv.norm() * extent.y();
    if (u > 1e-7 * v && v > 1e-7 * u) return (parts.faces[face].reversed ? -1.0 : 1.0) / size * n;
  }
  return face_normal(parts, face, uv);
}

}  // namespace flowcage
