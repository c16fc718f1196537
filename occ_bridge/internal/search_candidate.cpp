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

Vec2 uv_at(const PatchCell& cell, const Vec2& st) {
  const Vec2 high = 0.5 * (Vec2::Ones() + st);
  return ((Vec2::Ones() - high).cwiseProduct(cell.box.min()) + high.cwiseProduct(cell.box.max()))
      .cwiseMax(cell.box.min())
      .cwiseMin(cell.box.max());
}

PatchPoint by_uv(const PatchCell& cell, const PatchPoint& by_st) {
  const Vec2 half = 0.5 * cell.box.sizes();
  return {by_st.position, by_st.du / half.x(), by_st.dv / half.y()};
}

}  // namespace flowcage
