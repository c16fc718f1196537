#include "occ_bridge/internal/line_search.hpp"

#include <algorithm>
#include <cmath>

#include "core/project/cell_start.hpp"
#include "core/project/closest_point.hpp"

namespace flowcage {
namespace {

/// The patch seen along a direction: its distance from a point is the distance of the line through it.
class SeenAlong final : public ParametricPatch {
 public:
  SeenAlong(const ParametricPatch& patch, const Vec3& direction) : patch_(patch), d_(direction) {}
  PatchPoint first(const Vec2& uv) const override {
    const PatchPoint p = patch_.first(uv);
    return {flat(p.position), flat(p.du), flat(p.dv)};
  }
  PatchCurvature second(const Vec2& uv) const override {
    const PatchCurvature c = patch_.second(uv);
    return {flat(c.position), flat(c.du), flat(c.dv), flat(c.duu), flat(c.duv), flat(c.dvv)};
  }
  Eigen::AlignedBox2d domain() const override { return patch_.domain(); }
  bool periodic_u() const override { return false; }
  bool periodic_v() const override { return false; }

 private:
  Vec3 flat(const Vec3& v) const { return v - v.dot(d_) * d_; }
  const ParametricPatch& patch_;
  Vec3 d_;
};

}  // namespace

SurfacePoint LineSearch::run(const Vec3& origin, const Vec3& direction, double min_cosine, double reach) {
  origin_ = origin;
  direction_ = direction;
  min_cosine_ = min_cosine;
  best_ = Candidate{};
  reach_ = reach;
  const auto cells = static_cast<Index>(parts_.cells.cells.size());
  visit_along(
      parts_.tree, origin, direction, [&] { return std::min(reach_, best_.key); },
      [&](Index item) {
        if (item < cells) visit_cell(item);
      });
  return best_.point;
}

void LineSearch::visit_cell(Index number) {
  const PatchCell& cell = parts_.cells.cells[number];
  const Index face = parts_.patch_face[cell.patch];
  const double sign = parts_.faces[face].reversed ? -1.0 : 1.0;
  double grazing = 0;  // the least |cosine| of the cell's normals with the line
  if (cell.normal_cosine > -1) {
    const double angle = std::acos(std::clamp(sign * cell.normal_axis.dot(direction_), -1.0, 1.0));
    const double half = std::acos(cell.normal_cosine);
    if (angle - half > std::acos(std::clamp(min_cosine_, -1.0, 1.0))) return;
    const double quarter = std::acos(0.0);
    if (std::abs(angle - quarter) > half) {
      grazing = std::min(std::abs(std::cos(angle - half)), std::abs(std::cos(angle + half)));
    }
  }
  const Vec3 center = 0.25 * (cell.p00 + cell.p10 + cell.p01 + cell.p11);
  const double radius = cell.slack + std::max({(cell.p00 - center).norm(), (cell.p10 - center).norm(),
                                               (cell.p01 - center).norm(), (cell.p11 - center).norm()});
  const double middle = (center - origin_).dot(direction_);
  const Vec3 offset = center - origin_ - middle * direction_;
  if (offset.norm() > radius) return;
  if (std::abs(middle) - radius > std::min(reach_, best_.key)) return;
  try_start(number, face, cell_start(cell, origin_ + middle * direction_).fraction);
  if (grazing > 0.3) return;
  // A line that grazes the cell may meet it twice: from both ends as well.
  for (const double end : {-1.0, 1.0}) {
    try_start(number, face, cell_start(cell, origin_ + (middle + end * radius) * direction_).fraction);
  }
}

void LineSearch::try_start(Index number, Index face, const Vec2& start) {
  const PatchCell& cell = parts_.cells.cells[number];
  const BoundedPatch& patch = *parts_.patches[cell.patch];
  const CellPolynomial polynomial = parts_.cell_polynomials[number];
  const Vec3 origin = origin_ - origin_.dot(direction_) * direction_;
  ClosestPointSettings settings;
  settings.length = parts_.length;
  // A little more than the cell, so that no line slips through between two.
  constexpr double beyond = 1e-9;
  PatchFoot foot;
  PatchPoint at;
  if (polynomial.empty()) {
    const Vec2 margin = beyond * cell.box.sizes();
    const Eigen::AlignedBox2d domain = patch.domain();
    settings.window = Eigen::AlignedBox2d((cell.box.min() - margin).cwiseMax(domain.min()),
                                          (cell.box.max() + margin).cwiseMin(domain.max()));
    foot = closest_point(SeenAlong(patch, direction_), origin,
                         cell.box.min() + start.cwiseProduct(cell.box.sizes()), settings);
    at = patch.first(foot.uv);
  } else {
    settings.window = Eigen::AlignedBox2d(Vec2::Constant(-1 - 2 * beyond), Vec2::Constant(1 + 2 * beyond));
    const PolynomialPatch local(polynomial);
    foot = closest_point(SeenAlong(local, direction_), origin, 2 * start - Vec2::Ones(), settings);
    at = by_uv(cell, local.first(foot.uv));
    foot.uv = uv_at(cell, foot.uv);
  }
  if (foot.convergence == FootConvergence::no_number) return;
  if (!(foot.distance <= 1e-10 * parts_.length)) return;
  Candidate candidate;
  const double t = (at.position - origin_).dot(direction_);
  candidate.key = std::abs(t);
  if (candidate.key > reach_) return;
  candidate.point.distance = candidate.key;
  candidate.point.position = at.position;
  candidate.point.face = face;
  candidate.point.uv = foot.uv;
  candidate.point.status = FootStatus::interior;
  if (!candidate.before(best_)) return;
  candidate.point.normal = unit_normal(parts_, face, at, foot.uv);
  if (!(candidate.point.normal.dot(direction_) >= min_cosine_)) return;
  const TrimSide side = trim_side(parts_.cells, cell, at, foot.uv, parts_.faces[face].trim_margin);
  if (side == TrimSide::outside) return;
  if (side == TrimSide::near_border && !parts_.faces[face].classifier->inside(foot.uv)) return;
  best_ = candidate;
}

}  // namespace flowcage
