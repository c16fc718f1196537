#include "occ_bridge/internal/face_projector.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/base/parallel.hpp"
#include "core/project/closest_point.hpp"
#include "occ_bridge/internal/occ_patch.hpp"
#include "occ_bridge/internal/projection_parts.hpp"

namespace flowcage {
namespace {

constexpr Offset batch_grain = 256;
constexpr double infinity = std::numeric_limits<double>::infinity();

// Relative to the model's diagonal.
constexpr double rounding = 1e-12;  // a border point must be nearer than an inner one by more than this
constexpr double slack_of_bounds = 1e-11;

struct TrianglePoint {
  Vec3 barycentric;
  double squared;
};

/// Nearest point of a triangle (Ericson, Real-Time Collision Detection, 5.1.5).
TrianglePoint closest_on_triangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, ac = c - a, ap = p - a;
  const auto at = [&](double v, double w) {
    return TrianglePoint{Vec3(1 - v - w, v, w), (ap - v * ab - w * ac).squaredNorm()};
  };
  const double d1 = ab.dot(ap), d2 = ac.dot(ap);
  if (d1 <= 0 && d2 <= 0) return at(0, 0);
  const Vec3 bp = p - b;
  const double d3 = ab.dot(bp), d4 = ac.dot(bp);
  if (d3 >= 0 && d4 <= d3) return at(1, 0);
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return at(d1 - d3 > 0 ? d1 / (d1 - d3) : 0, 0);
  const Vec3 cp = p - c;
  const double d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d6 >= 0 && d5 <= d6) return at(0, 1);
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return at(0, d2 - d6 > 0 ? d2 / (d2 - d6) : 0);
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
    const double sum = (d4 - d3) + (d5 - d6);
    const double w = sum > 0 ? (d4 - d3) / sum : 0;
    return at(1 - w, w);
  }
  const double denominator = va + vb + vc;
  if (!(denominator > 0)) return at(0, 0);
  return at(vb / denominator, vc / denominator);
}

/// Nearest point of a cell's two triangles: its distance, and (u, v) by interpolation.
struct CellStart {
  Vec2 uv;
  double distance;
};

CellStart cell_start(const PatchCell& cell, const Vec3& query) {
  const TrianglePoint lower = closest_on_triangle(query, cell.p00, cell.p10, cell.p11);
  const TrianglePoint upper = closest_on_triangle(query, cell.p00, cell.p11, cell.p01);
  Vec2 fraction;
  double squared = 0;
  if (lower.squared <= upper.squared) {
    fraction = {lower.barycentric[1] + lower.barycentric[2], lower.barycentric[2]};
    squared = lower.squared;
  } else {
    fraction = {upper.barycentric[1], upper.barycentric[1] + upper.barycentric[2]};
    squared = upper.squared;
  }
  return {cell.box.min() + fraction.cwiseProduct(cell.box.sizes()), std::sqrt(squared)};
}

/// A candidate for the answer; ordered by distance (border points a rounding later), then face.
struct Candidate {
  double key = infinity;
  SurfacePoint point;
  Index cell = no_index;  // whose trimming decides
  bool before(const Candidate& other) const {
    return key < other.key || (key == other.key && point.face < other.point.face);
  }
};

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

/// One search for the nearest (compatible) point.
class ClosestSearch {
 public:
  explicit ClosestSearch(const ProjectionParts& parts) : parts_(parts) {}

  struct Filter {
    const Vec3* normal = nullptr;  // null: every point will do
    double min_cosine = -1;
  };

  /// The nearest point within `reach`.
  SurfacePoint run(const Vec3& query, double reach, const Filter& filter) {
    query_ = query;
    filter_ = filter;
    best_ = Candidate{};
    reach_ = reach;
    pending_count_ = 0;
    visit_near(
        parts_.tree, query, [&] { return give_up_distance(); }, [&](Index item) { visit(item); });
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

 private:
  void visit(Index item) {
    const auto cells = static_cast<Index>(parts_.cells.cells.size());
    if (item < cells) {
      visit_cell(item);
    } else {
      visit_piece(parts_.pieces[item - cells]);
    }
  }

  double give_up_distance() const { return std::min(reach_, best_.key); }

  void visit_cell(Index number) {
    const PatchCell& cell = parts_.cells.cells[number];
    const Index face = parts_.patch_face[cell.patch];
    if (filter_.normal != nullptr && !cone_allows(cell, face)) return;
    const CellStart start = cell_start(cell, query_);
    if (start.distance - cell.slack > give_up_distance()) return;
    ClosestPointSettings settings;
    settings.length = parts_.length;
    settings.window = cell.box;
    settings.give_up_above = give_up_distance() + slack_of_bounds * parts_.length;
    // The start is not the middle, so twice the bounds.
    settings.convexity_margin =
        0.05 + 2 * ((start.distance + cell.slack) * cell.bend_change + cell.metric_change);
    if (offer_foot(number, face, start.uv, settings)) return;
    // Several minima are possible: from those corners as well around which a nearer point may be.
    settings.convexity_margin = infinity;
    const Vec2 low = cell.box.min(), size = cell.box.sizes();
    const Vec3* corners[] = {&cell.p00, &cell.p10, &cell.p01, &cell.p11};
    for (int corner = 0; corner < 4; ++corner) {
      const double from = (*corners[corner] - query_).norm() - cell.slack;
      if (from > give_up_distance()) continue;
      const Vec2 fraction(corner % 2 == 0 ? 0.1 : 0.9, corner / 2 == 0 ? 0.1 : 0.9);
      offer_foot(number, face, low + fraction.cwiseProduct(size), settings);
    }
  }

  bool cone_allows(const PatchCell& cell, Index face) const {
    if (cell.normal_cosine <= -1) return true;
    const double cosine = std::clamp(
        (parts_.faces[face].reversed ? -1.0 : 1.0) * cell.normal_axis.dot(*filter_.normal), -1.0, 1.0);
    return std::acos(cosine) - std::acos(cell.normal_cosine) <=
           std::acos(std::clamp(filter_.min_cosine, -1.0, 1.0));
  }

  /// True if the cell is done with: the foot is its only minimum, or none of it is near enough.
  bool offer_foot(Index number, Index face, const Vec2& start, const ClosestPointSettings& settings) {
    const PatchCell& cell = parts_.cells.cells[number];
    const BoundedPatch& patch = *parts_.patches[cell.patch];
    const PatchFoot foot = closest_point(patch, query_, start, settings);
    if (foot.convergence == FootConvergence::no_number || foot.convergence == FootConvergence::given_up) {
      return true;
    }
    if (foot.distance > give_up_distance()) return foot.convex;
    Candidate candidate;
    candidate.key = foot.distance;
    candidate.cell = number;
    candidate.point.distance = foot.distance;
    candidate.point.position = foot.point.position;
    candidate.point.face = face;
    candidate.point.uv = foot.uv;
    candidate.point.normal = unit_normal(parts_, face, foot.point, foot.uv);
    // At a kink between patches or on an outer side the residual is not normal.
    const Vec3 r = foot.point.position - query_;
    const double tangential = (r - r.dot(candidate.point.normal) * candidate.point.normal).norm();
    candidate.point.status = tangential <= 1e-7 * foot.distance + 1e-10 * parts_.length
                                 ? FootStatus::interior
                                 : FootStatus::boundary;
    if (candidate.point.status == FootStatus::boundary) candidate.key += rounding * parts_.length;
    if (!candidate.before(best_) || !compatible(candidate.point.normal)) return foot.convex;
    // With a filter the answer must not depend on where cells end: only feet, and minima at a patch's end.
    if (filter_.normal != nullptr && candidate.point.status == FootStatus::boundary &&
        !on_patch_border(patch, foot.uv)) {
      return foot.convex;
    }
    const TrimSide side = trim_side(parts_.cells, cell, foot.point, foot.uv, parts_.faces[face].trim_margin);
    if (side == TrimSide::inside) {
      offer(candidate);
    } else if (side == TrimSide::near_border) {
      if (pending_count_ == static_cast<int>(pending_.size())) {
        if (exactly_inside(candidate)) offer(candidate);
      } else {
        pending_[pending_count_++] = candidate;
      }
    }
    return foot.convex;
  }

  static bool on_patch_border(const BoundedPatch& patch, const Vec2& uv) {
    const Eigen::AlignedBox2d domain = patch.domain();
    return (uv.array() <= domain.min().array()).any() || (uv.array() >= domain.max().array()).any();
  }

  bool compatible(const Vec3& normal) const {
    return filter_.normal == nullptr || normal.dot(*filter_.normal) >= filter_.min_cosine;
  }

  bool exactly_inside(const Candidate& candidate) const {
    return parts_.faces[candidate.point.face].classifier->inside(candidate.point.uv);
  }

  void visit_piece(const CurvePiece& piece) {
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
      CurveSearch search;
      search.low = piece.low;
      search.high = piece.high;
      search.start = piece.low + s * (piece.high - piece.low);
      search.length = parts_.length;
      foot = closest_on_curve(*parts_.curves[piece.curve].curve, query_, search);
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
  void set_side(const CurveSide& side, double t, SurfacePoint& point) const {
    point.face = side.face;
    if (!side.pcurve.IsNull()) {
      const gp_Pnt2d uv = side.pcurve->Value(t);
      point.uv = Vec2(uv.X(), uv.Y());
    }
    point.normal = face_normal(parts_, side.face, point.uv);
  }

  /// For a point on an edge of several faces: the face that looks most toward the query.
  void finish_border() {
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

  void offer(const Candidate& candidate) {
    if (!candidate.before(best_)) return;
    best_ = candidate;
    border_pending_ = false;
  }

  const ProjectionParts& parts_;
  Vec3 query_ = Vec3::Zero();
  Filter filter_;
  double reach_ = infinity;
  Candidate best_;
  bool border_pending_ = false;
  std::array<Candidate, 8> pending_;
  int pending_count_ = 0;
};

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

/// One search for the nearest intersection of a line.
class LineSearch {
 public:
  explicit LineSearch(const ProjectionParts& parts) : parts_(parts) {}

  SurfacePoint run(const Vec3& origin, const Vec3& direction, double min_cosine, double reach) {
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

 private:
  void visit_cell(Index number) {
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
    try_start(number, face, cell_start(cell, origin_ + middle * direction_).uv);
    if (grazing > 0.3) return;
    // A line that grazes the cell may meet it twice: from both ends as well.
    for (const double end : {-1.0, 1.0}) {
      try_start(number, face, cell_start(cell, origin_ + (middle + end * radius) * direction_).uv);
    }
  }

  void try_start(Index number, Index face, const Vec2& start) {
    const PatchCell& cell = parts_.cells.cells[number];
    const BoundedPatch& patch = *parts_.patches[cell.patch];
    ClosestPointSettings settings;
    settings.length = parts_.length;
    const Vec2 margin = 1e-9 * cell.box.sizes();
    const Eigen::AlignedBox2d domain = patch.domain();
    settings.window = Eigen::AlignedBox2d((cell.box.min() - margin).cwiseMax(domain.min()),
                                          (cell.box.max() + margin).cwiseMin(domain.max()));
    const SeenAlong seen(patch, direction_);
    const Vec3 origin = origin_ - origin_.dot(direction_) * direction_;
    const PatchFoot foot = closest_point(seen, origin, start, settings);
    if (foot.convergence == FootConvergence::no_number) return;
    if (!(foot.distance <= 1e-10 * parts_.length)) return;
    const PatchPoint at = patch.first(foot.uv);
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

  const ProjectionParts& parts_;
  Vec3 origin_ = Vec3::Zero(), direction_ = Vec3::Zero();
  double min_cosine_ = -1, reach_ = infinity;
  Candidate best_;
};

/// Distance within which the answer must lie, from a point that is already known to be on the faces.
double known_reach(const ProjectionParts& parts, const Vec3& query, const SurfacePoint& known) {
  if (known.status == FootStatus::failed || known.face < 0 ||
      known.face >= static_cast<Index>(parts.faces.size())) {
    return infinity;
  }
  const double distance = (query - known.position).norm();
  return std::isfinite(distance) ? distance * (1 + 1e-12) + 1e-9 * parts.length : infinity;
}

}  // namespace

struct FaceProjector::Parts : ProjectionParts {
  explicit Parts(ProjectionParts&& parts) : ProjectionParts(std::move(parts)) {}
};

FaceProjector::FaceProjector(const std::vector<TopoDS_Face>& faces)
    : parts_(std::make_unique<Parts>(build_projection(faces))) {}
FaceProjector::~FaceProjector() = default;
FaceProjector::FaceProjector(FaceProjector&&) noexcept = default;
FaceProjector& FaceProjector::operator=(FaceProjector&&) noexcept = default;

void FaceProjector::closest_points(std::span<const Vec3> queries, std::span<const SurfacePoint> hints,
                                   std::span<SurfacePoint> results) const {
  parallel_for(static_cast<Offset>(queries.size()), batch_grain, [&](Offset begin, Offset end) {
    ClosestSearch search(*parts_);
    SurfacePoint last;
    for (Offset i = begin; i < end; ++i) {
      results[i] = SurfacePoint{};
      if (!queries[i].allFinite()) continue;
      double reach = known_reach(*parts_, queries[i], last);
      if (!hints.empty()) reach = std::min(reach, known_reach(*parts_, queries[i], hints[i]));
      SurfacePoint found = search.run(queries[i], reach, {});
      // A hint that is no point of these faces promised too much.
      if (found.status == FootStatus::failed && reach < infinity)
        found = search.run(queries[i], infinity, {});
      if (found.status != FootStatus::failed) last = found;
      results[i] = found;
    }
  });
}

void FaceProjector::closest_compatible(std::span<const Vec3> queries, std::span<const Vec3> normals,
                                       double min_cosine, double max_distance,
                                       std::span<SurfacePoint> results) const {
  parallel_for(static_cast<Offset>(queries.size()), batch_grain, [&](Offset begin, Offset end) {
    ClosestSearch search(*parts_);
    for (Offset i = begin; i < end; ++i) {
      results[i] = SurfacePoint{};
      if (!queries[i].allFinite() || !normals[i].allFinite()) continue;
      results[i] = search.run(queries[i], max_distance, {&normals[i], min_cosine});
    }
  });
}

void FaceProjector::intersect_lines(std::span<const Vec3> queries, std::span<const Vec3> directions,
                                    double min_cosine, double max_distance,
                                    std::span<SurfacePoint> results) const {
  parallel_for(static_cast<Offset>(queries.size()), batch_grain, [&](Offset begin, Offset end) {
    LineSearch search(*parts_);
    for (Offset i = begin; i < end; ++i) {
      results[i] = SurfacePoint{};
      if (!queries[i].allFinite() || !directions[i].allFinite()) continue;
      results[i] = search.run(queries[i], directions[i], min_cosine, max_distance);
    }
  });
}

Vec3 FaceProjector::normal(Index face, const Vec2& uv) const {
  return face_normal(*parts_, face, uv);
}

const std::vector<std::string>& FaceProjector::notes() const {
  return parts_->notes;
}

Index FaceProjector::cell_count() const {
  return static_cast<Index>(parts_->cells.cells.size());
}

Index FaceProjector::curve_piece_count() const {
  return static_cast<Index>(parts_->pieces.size());
}

}  // namespace flowcage
