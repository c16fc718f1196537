#include "occ_bridge/internal/closest_search.hpp"

#include <algorithm>
#include <cmath>

#include "core/project/cell_foot.hpp"
#include "core/project/cell_start.hpp"

namespace flowcage {
namespace {

// Relative to the model's diagonal.
constexpr double rounding = 1e-12;  // a border point must be nearer than an inner one by more than this
constexpr double slack_of_bounds = 1e-11;

bool on_patch_border(const BoundedPatch& patch, const Vec2& uv) {
  const Eigen::AlignedBox2d domain = patch.domain();
  return (uv.array() <= domain.min().array()).any() || (uv.array() >= domain.max().array()).any();
}

}  // namespace

SurfacePoint ClosestSearch::run(const Vec3& query, double reach, const Filter& filter) {
  query_ = query;
  filter_ = filter;
  best_ = Candidate{};
  reach_ = reach;
  pending_count_ = 0;
  const auto cells = static_cast<Index>(parts_.cells.cells.size());
  const auto nearer_than = [&] { return give_up_distance(); };
  const auto visit = [&](Index item) {
    if (item < cells) {
      visit_cell(item);
    } else {
      visit_piece(item - cells);
    }
  };
  if ((query - parts_.near_tree.origin).norm() <= 100 * parts_.near_tree.size) {
    visit_nearest(parts_.near_tree, query, nearer_than, visit);
  } else {
    visit_near(parts_.tree, query, nearer_than, visit);
  }
  // Feet next to a border matter only where the border itself is not as near.
  std::sort(pending_.begin(), pending_.begin() + pending_count_,
            [](const Candidate& a, const Candidate& b) { return a.before(b); });
  for (int i = 0; i < pending_count_; ++i) {
    if (pending_[i].key + 2 * rounding * parts_.length > best_.key) break;
    if (exactly_inside(pending_[i])) {
      offer(pending_[i]);
      break;
    }
  }
  finish_border();
  return best_.point;
}

void ClosestSearch::visit_cell(Index number) {
  ++work_.cells;
  const PatchCell& cell = parts_.cells.cells[number];
  if (filter_.normal != nullptr && !cone_allows(cell, parts_.patch_face[cell.patch])) return;
  const CellStart start = cell_start(cell, query_);
  if (start.distance - cell.slack > give_up_distance()) return;
  // The bounds are about the cell's middle, and two points of it are compared.
  const Vec3 middle = 0.25 * (cell.p00 + cell.p10 + cell.p01 + cell.p11);
  const double change = 2 * (((middle - query_).norm() + cell.slack) * cell.bend_change + cell.metric_change);
  const CellPolynomial polynomial = parts_.cell_polynomials[number];
  if (!polynomial.empty()) {
    CellFootSettings settings;
    settings.length = parts_.length;
    settings.give_up_above = give_up_distance() + slack_of_bounds * parts_.length;
    settings.eigenvalue_change = change;
    const CellFoot foot = cell_foot(polynomial, query_, 2 * start.fraction - Vec2::Ones(), settings);
    work_.evaluations += foot.evaluations;
    switch (foot.end) {
      case CellFootEnd::found:
        offer_foot(number, uv_at(cell, foot.st), by_uv(cell, foot.point), foot.distance);
        return;
      case CellFootEnd::given_up:
        return;
      case CellFootEnd::concave:
        // What borders on the cell answers: other cells, or the border's curves.
        if (!cell.at_open_side) return;
        break;
      case CellFootEnd::undecided:
        break;
    }
  }
  search_everywhere(number, start.fraction, change);
}

bool ClosestSearch::cone_allows(const PatchCell& cell, Index face) const {
  if (cell.normal_cosine <= -1) return true;
  const double cosine = std::clamp(
      (parts_.faces[face].reversed ? -1.0 : 1.0) * cell.normal_axis.dot(*filter_.normal), -1.0, 1.0);
  return std::acos(cosine) - std::acos(cell.normal_cosine) <=
         std::acos(std::clamp(filter_.min_cosine, -1.0, 1.0));
}

/// With as many starts as it takes.
void ClosestSearch::search_everywhere(Index number, const Vec2& start, double eigenvalue_change) {
  ++work_.general_searches;
  const PatchCell& cell = parts_.cells.cells[number];
  ClosestPointSettings settings;
  settings.length = parts_.length;
  settings.give_up_above = give_up_distance() + slack_of_bounds * parts_.length;
  settings.convexity_margin = 0.05 + eigenvalue_change;
  if (offer_general_foot(number, start, settings)) return;
  // Several minima are possible: from those corners as well around which a nearer point may be.
  settings.convexity_margin = std::numeric_limits<double>::infinity();
  const Vec3* corners[] = {&cell.p00, &cell.p10, &cell.p01, &cell.p11};
  for (int corner = 0; corner < 4; ++corner) {
    const double from = (*corners[corner] - query_).norm() - cell.slack;
    if (from > give_up_distance()) continue;
    offer_general_foot(number, Vec2(corner % 2 == 0 ? 0.1 : 0.9, corner / 2 == 0 ? 0.1 : 0.9), settings);
  }
}

/// True if the cell is done with: the foot is its only minimum, or none of it is near enough. `start` is a
/// fraction of the cell's box.
bool ClosestSearch::offer_general_foot(Index number, const Vec2& start,
                                       const ClosestPointSettings& settings) {
  const PatchCell& cell = parts_.cells.cells[number];
  const CellPolynomial polynomial = parts_.cell_polynomials[number];
  PatchFoot foot;
  if (polynomial.empty()) {
    ClosestPointSettings windowed = settings;
    windowed.window = cell.box;
    foot = closest_point(*parts_.patches[cell.patch], query_,
                         cell.box.min() + start.cwiseProduct(cell.box.sizes()), windowed);
  } else {
    foot = closest_point(PolynomialPatch(polynomial), query_, 2 * start - Vec2::Ones(), settings);
    foot.uv = uv_at(cell, foot.uv);
    foot.point = by_uv(cell, foot.point);
  }
  work_.evaluations += foot.evaluations;
  if (foot.convergence == FootConvergence::no_number || foot.convergence == FootConvergence::given_up) {
    return true;
  }
  offer_foot(number, foot.uv, foot.point, foot.distance);
  return foot.convex;
}

void ClosestSearch::offer_foot(Index number, const Vec2& uv, const PatchPoint& at, double distance) {
  if (distance > give_up_distance()) return;
  const PatchCell& cell = parts_.cells.cells[number];
  const BoundedPatch& patch = *parts_.patches[cell.patch];
  const Index face = parts_.patch_face[cell.patch];
  Candidate candidate;
  candidate.key = distance;
  candidate.cell = number;
  candidate.point.distance = distance;
  candidate.point.position = at.position;
  candidate.point.face = face;
  candidate.point.uv = uv;
  candidate.point.normal = unit_normal(parts_, face, at, uv);
  // At a kink between patches or on an outer side the residual is not normal.
  const Vec3 r = at.position - query_;
  const double tangential = (r - r.dot(candidate.point.normal) * candidate.point.normal).norm();
  candidate.point.status =
      tangential <= 1e-7 * distance + 1e-10 * parts_.length ? FootStatus::interior : FootStatus::boundary;
  if (candidate.point.status == FootStatus::boundary) candidate.key += rounding * parts_.length;
  if (!candidate.before(best_) || !compatible(candidate.point.normal)) return;
  // With a filter the answer must not depend on where cells end: only feet, and minima at a patch's end.
  if (filter_.normal != nullptr && candidate.point.status == FootStatus::boundary &&
      !on_patch_border(patch, uv)) {
    return;
  }
  const TrimSide side = trim_side(parts_.cells, cell, at, uv, parts_.faces[face].trim_margin);
  if (side == TrimSide::inside) {
    offer(candidate);
  } else if (side == TrimSide::near_border) {
    if (pending_count_ == static_cast<int>(pending_.size())) {
      if (exactly_inside(candidate)) offer(candidate);
    } else {
      pending_[pending_count_++] = candidate;
    }
  }
}

bool ClosestSearch::compatible(const Vec3& normal) const {
  return filter_.normal == nullptr || normal.dot(*filter_.normal) >= filter_.min_cosine;
}

bool ClosestSearch::exactly_inside(const Candidate& candidate) const {
  return parts_.faces[candidate.point.face].classifier->inside(candidate.point.uv);
}

void ClosestSearch::visit_piece(Index number) {
  ++work_.pieces;
  const CurvePiece& piece = parts_.pieces[number];
  const Vec3 ab = piece.b - piece.a;
  const double squared = ab.squaredNorm();
  const double s = squared > 0 ? std::clamp(ab.dot(query_ - piece.a) / squared, 0.0, 1.0) : 0.0;
  const double distance = (piece.a + s * ab - query_).norm();
  if (distance - piece.slack > give_up_distance()) return;
  CurveFoot foot;
  if (piece.vertex) {
    foot.t = piece.low;
    foot.position = piece.a;
    foot.distance = distance;
  } else {
    const CellPolynomial polynomial = parts_.piece_polynomials[number];
    CurveSearch search;
    search.length = parts_.length;
    if (polynomial.empty()) {
      search.low = piece.low;
      search.high = piece.high;
      search.start = piece.low + s * (piece.high - piece.low);
      foot = closest_on_curve(*parts_.curves[piece.curve].curve, query_, search);
    } else {
      search.low = -1;
      search.start = 2 * s - 1;
      foot = closest_on_curve(PolynomialCurve(polynomial), query_, search);
      foot.t = piece.low + 0.5 * (1 + foot.t) * (piece.high - piece.low);
    }
    work_.curve_evaluations += foot.evaluations;
  }
  if (!std::isfinite(foot.distance) || foot.distance > give_up_distance()) return;
  Candidate candidate;
  candidate.key = foot.distance + rounding * parts_.length;
  candidate.point.distance = foot.distance;
  candidate.point.position = foot.position;
  candidate.point.status = FootStatus::boundary;
  if (filter_.normal == nullptr) {
    // The side is chosen at the end.
    candidate.point.face = parts_.curves[piece.curve].sides.front().face;
    candidate.point.uv = Vec2(foot.t, static_cast<double>(piece.curve));
    if (candidate.before(best_)) {
      offer(candidate);
      border_pending_ = true;
    }
    return;
  }
  for (const CurveSide& side : parts_.curves[piece.curve].sides) {
    Candidate of_side = candidate;
    set_side(side, foot.t, of_side.point);
    if (compatible(of_side.point.normal) && of_side.before(best_)) offer(of_side);
  }
}

/// The face, its (u, v) and its normal at a point of a border curve.
void ClosestSearch::set_side(const CurveSide& side, double t, SurfacePoint& point) const {
  point.face = side.face;
  if (!side.pcurve.IsNull()) {
    const gp_Pnt2d uv = side.pcurve->Value(t);
    point.uv = Vec2(uv.X(), uv.Y());
  }
  point.normal = face_normal(parts_, side.face, point.uv);
}

/// For a point on an edge of several faces: the face that looks most toward the query.
void ClosestSearch::finish_border() {
  if (!border_pending_) return;
  border_pending_ = false;
  SurfacePoint& point = best_.point;
  const double t = point.uv.x();
  const BorderCurve& curve = parts_.curves[static_cast<std::size_t>(point.uv.y())];
  const Vec3 toward = query_ - point.position;
  double best = -1;
  SurfacePoint chosen = point;
  for (const CurveSide& side : curve.sides) {
    SurfacePoint candidate = point;
    set_side(side, t, candidate);
    const double facing = std::abs(candidate.normal.dot(toward));
    if (facing > best * (1 + 1e-9)) {  // equal within rounding: the lower face number
      best = facing;
      chosen = candidate;
    }
  }
  point = chosen;
}

void ClosestSearch::offer(const Candidate& candidate) {
  if (!candidate.before(best_)) return;
  best_ = candidate;
  border_pending_ = false;
}

}  // namespace flowcage
