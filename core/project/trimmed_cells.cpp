#include "core/project/trimmed_cells.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <span>

namespace flowcage {
namespace {

constexpr double least_uneven = 0.05;  // of max_size: cells below are not split for their parametrisation

double cross(const Vec2& a, const Vec2& b) {
  return a.x() * b.y() - a.y() * b.x();
}

/// Whether the open segments p q and a b cross; half-open at a and b so that a polygon's vertex counts once.
bool crosses(const Vec2& p, const Vec2& q, const TrimSegment& s) {
  const bool a_left = cross(q - p, s.a - p) > 0, b_left = cross(q - p, s.b - p) > 0;
  if (a_left == b_left) return false;
  // The order of a and b must not matter.
  const bool p_left = cross(s.b - s.a, p - s.a) > 0, q_left = cross(s.b - s.a, q - s.a) > 0;
  return p_left != q_left;
}

bool odd_crossings(const Vec2& p, const Vec2& q, std::span<const TrimSegment> segments) {
  bool odd = false;
  for (const TrimSegment& s : segments) odd ^= crosses(p, q, s);
  return odd;
}

bool meets(const Eigen::AlignedBox2d& box, const TrimSegment& s) {
  double low = 0, high = 1;
  const Vec2 d = s.b - s.a;
  for (int axis = 0; axis < 2; ++axis) {
    const double a = box.min()[axis] - s.a[axis], b = box.max()[axis] - s.a[axis];
    if (d[axis] == 0) {
      if (a > 0 || b < 0) return false;
      continue;
    }
    low = std::max(low, std::min(a / d[axis], b / d[axis]));
    high = std::min(high, std::max(a / d[axis], b / d[axis]));
  }
  return low <= high;
}

/// How far the convex hull of a cell's corners reaches from its two triangles. Seen along the normal of both
/// diagonals, crossing diagonals mean that the triangles cover the hull, whose thickness is the bound.
double hull_gap(const PatchCell& cell) {
  const Vec3 d = cell.p11 - cell.p00, e = cell.p01 - cell.p10, n = d.cross(e);
  const double size = n.norm();
  const double twist = 0.5 * (cell.p00 - cell.p10 - cell.p01 + cell.p11).norm();
  if (!(size > 1e-6 * d.norm() * e.norm())) return twist;
  const double side_10 = n.dot((cell.p10 - cell.p00).cross(d)),
               side_01 = n.dot((cell.p01 - cell.p00).cross(d));
  const double side_00 = n.dot((cell.p00 - cell.p10).cross(e)),
               side_11 = n.dot((cell.p11 - cell.p10).cross(e));
  const double noise = 1e-9 * size * size;
  const bool crossing = (side_10 <= noise && side_01 >= -noise) || (side_10 >= -noise && side_01 <= noise);
  const bool crossed = (side_00 <= noise && side_11 >= -noise) || (side_00 >= -noise && side_11 <= noise);
  if (!crossing || !crossed) return twist;
  return std::min(twist, std::abs(n.dot(cell.p10 - cell.p00)) / size + 1e-9 * (d.norm() + e.norm()));
}

// Off the middle, so that symmetric polygons have no vertex on the line between two references.
Vec2 reference_of(const Eigen::AlignedBox2d& box) {
  return box.min() + Vec2(0.4871, 0.5093).cwiseProduct(box.sizes());
}

/// A quadratic form (p q; q s) on parameters, with numbers or vectors as entries, in the orthonormal frame of
/// the tangent plane at a point.
template <typename Entry>
struct FrameForm {
  Entry p, q, s;
};

/// The tangent frame at a point: the parameters' change (1, 0) / along and (-turn, 1) / across has unit
/// length.
struct TangentFrame {
  double along = 0, across = 0, turn = 0;

  explicit TangentFrame(const PatchCurvature& at) {
    const double square = at.du.squaredNorm();
    if (!(square > 0)) return;
    along = std::sqrt(square);
    turn = at.du.dot(at.dv) / square;
    across = (at.dv - turn * at.du).norm();
  }
  bool regular() const { return along > 0 && across > 0; }
  template <typename Entry>
  FrameForm<Entry> form(const Entry& p, const Entry& q, const Entry& s) const {
    return {p / (along * along), (q - turn * p) / (along * across),
            (s - 2 * turn * q + turn * turn * p) / (across * across)};
  }
};

/// Largest absolute eigenvalue of H(at) - H(middle), H the Hessian of half the squared distance of the point
/// `middle`, relative to the first fundamental form of the frame.
double metric_difference(const TangentFrame& frame, const PatchCurvature& middle, const PatchCurvature& at) {
  if (!frame.regular()) return std::numeric_limits<double>::infinity();
  const Vec3 way = at.position - middle.position;
  const auto [p, q, s] = frame.form(at.du.squaredNorm() + way.dot(at.duu) - middle.du.squaredNorm(),
                                    at.du.dot(at.dv) + way.dot(at.duv) - middle.du.dot(middle.dv),
                                    at.dv.squaredNorm() + way.dot(at.dvv) - middle.dv.squaredNorm());
  return 0.5 * (std::abs(p + s) + std::hypot(p - s, 2 * q));
}

/// Bound of the same for S'' . n, over all unit vectors n: what the Hessian changes by a unit of distance.
double bend_difference(const TangentFrame& frame, const PatchCurvature& middle, const PatchCurvature& at) {
  if (!frame.regular()) return std::numeric_limits<double>::infinity();
  const auto [p, q, s] =
      frame.form(Vec3(at.duu - middle.duu), Vec3(at.duv - middle.duv), Vec3(at.dvv - middle.dvv));
  return std::max(p.norm(), s.norm()) + q.norm();
}

/// The surface over a box; parameters are fractions of it.
class CellSurface {
 public:
  CellSurface(const BoundedPatch& patch, const Eigen::AlignedBox2d& box)
      : CellSurface(patch, box, patch.bezier(box)) {}

  std::array<CellSurface, 2> halves(int axis) const {
    std::array<Eigen::AlignedBox2d, 2> boxes{box_, box_};
    boxes[0].max()[axis] = boxes[1].min()[axis] = middle(axis);
    if (!net_) return {CellSurface(patch_, boxes[0], {}), CellSurface(patch_, boxes[1], {})};
    std::array<BezierNet, 2> nets = flowcage::halves(*net_, axis);
    return {CellSurface(patch_, boxes[0], std::move(nets[0])),
            CellSurface(patch_, boxes[1], std::move(nets[1]))};
  }
  const Eigen::AlignedBox2d& box() const { return box_; }
  double middle(int axis) const { return 0.5 * (box_.min()[axis] + box_.max()[axis]); }
  Vec2 deviation() const { return net_ ? bend(*net_) : patch_.deviation(box_); }
  Vec3 corner(int s, int t) const {
    if (net_) return net_->point(s * net_->degree_s, t * net_->degree_t);
    return patch_.first({s == 0 ? box_.min().x() : box_.max().x(), t == 0 ? box_.min().y() : box_.max().y()})
        .position;
  }
  PatchCurvature middle() const { return net_ ? middle_of(*net_) : second({0.5, 0.5}); }
  /// At the nine pairs of 0, 1/2 and 1, as nine_samples.
  std::array<PatchCurvature, 9> samples() const {
    if (net_) return nine_samples(*net_);
    std::array<PatchCurvature, 9> result;
    for (int k = 0; k < 9; ++k) result[k] = second(0.5 * Vec2(k / 3, k % 3));
    return result;
  }

 private:
  CellSurface(const BoundedPatch& patch, const Eigen::AlignedBox2d& box, std::optional<BezierNet> net)
      : patch_(patch), box_(box), net_(std::move(net)) {}

  PatchCurvature second(const Vec2& fraction) const {
    const Vec2 size = box_.sizes();
    PatchCurvature c = patch_.second(box_.min() + fraction.cwiseProduct(size));
    c.du *= size.x();
    c.dv *= size.y();
    c.duu *= size.x() * size.x();
    c.duv *= size.x() * size.y();
    c.dvv *= size.y() * size.y();
    return c;
  }

  const BoundedPatch& patch_;
  Eigen::AlignedBox2d box_;
  std::optional<BezierNet> net_;
};

class Splitter {
 public:
  Splitter(const BoundedPatch& patch, Index number, const CellSettings& settings, TrimmedCells& result)
      : domain_(patch.domain()), number_(number), settings_(settings), result_(result) {}

  void split(const CellSurface& surface, const std::vector<TrimSegment>& near, bool inside, int depth) {
    PatchCell cell;
    cell.box = surface.box();
    cell.patch = number_;
    cell.reference = reference_of(cell.box);
    cell.reference_inside = inside;
    if (near.empty() && !inside) return;
    cell.p00 = surface.corner(0, 0);
    cell.p10 = surface.corner(1, 0);
    cell.p01 = surface.corner(0, 1);
    cell.p11 = surface.corner(1, 1);
    const Vec2 lengths = lengths_of(surface);
    const Vec2 deviation = surface.deviation();
    const double twist = hull_gap(cell);
    const double diagonal = std::max((cell.p11 - cell.p00).norm(), (cell.p10 - cell.p01).norm());
    cell.slack = deviation.sum() + twist;
    const double size = std::max(diagonal, lengths.norm());
    const bool flat = cell.slack <= settings_.flatness * diagonal;
    const bool small = size <= (near.empty() ? settings_.max_size : settings_.max_trimmed_size);
    const bool last = size <= settings_.min_size || depth >= settings_.max_depth;
    int axis = lengths.x() > lengths.y() ? 0 : 1;
    if (!flat && std::max(deviation.x(), deviation.y()) > twist) axis = deviation.x() > deviation.y() ? 0 : 1;
    if (last || (flat && small)) {
      const auto samples = surface.samples();
      std::optional<int> uneven;
      if (!last && size > least_uneven * settings_.max_size) uneven = uneven_axis(samples);
      if (!uneven) return finish(cell, samples, near);
      axis = *uneven;
    }
    const double middle = surface.middle(axis);
    if (!(middle > cell.box.min()[axis] && middle < cell.box.max()[axis])) {
      return finish(cell, surface.samples(), near);
    }
    for (const CellSurface& half : surface.halves(axis)) {
      const bool half_inside = inside != odd_crossings(cell.reference, reference_of(half.box()), near);
      split(half, near_box(half.box(), near, lengths), half_inside, depth + 1);
    }
  }

  std::vector<TrimSegment> near_box(const Eigen::AlignedBox2d& box, const std::vector<TrimSegment>& segments,
                                    const Vec2& lengths) const {
    std::vector<TrimSegment> near;
    if (segments.empty()) return near;
    // The margin in parameters, at most the whole box again (where the box is collapsed in space).
    const Vec2 sizes = box.sizes();
    Vec2 margin;
    for (int axis = 0; axis < 2; ++axis) {
      margin[axis] = sizes[axis] * std::min(1.0, settings_.margin / std::max(0.5 * lengths[axis], 1e-300));
    }
    const Eigen::AlignedBox2d wide(box.min() - margin, box.max() + margin);
    for (const TrimSegment& s : segments) {
      if (meets(wide, s)) near.push_back(s);
    }
    return near;
  }

  /// The lengths in space of the box along u and v.
  static Vec2 lengths_of(const CellSurface& surface) {
    const Vec3 p00 = surface.corner(0, 0), p10 = surface.corner(1, 0), p01 = surface.corner(0, 1),
               p11 = surface.corner(1, 1);
    const PatchCurvature middle = surface.middle();
    return {std::max({(p10 - p00).norm(), (p11 - p01).norm(), middle.du.norm()}),
            std::max({(p01 - p00).norm(), (p11 - p10).norm(), middle.dv.norm()})};
  }

 private:
  /// The axis along which the parametrisation's speed changes most, if it is so much that nearest points of
  /// near queries could not be shown to be the only ones.
  static std::optional<int> uneven_axis(const std::array<PatchCurvature, 9>& samples) {
    constexpr double most = 0.3;
    const PatchCurvature& middle = samples[4];
    const TangentFrame frame(middle);
    const std::array<double, 2> change{
        std::max(metric_difference(frame, middle, samples[1]), metric_difference(frame, middle, samples[7])),
        std::max(metric_difference(frame, middle, samples[3]), metric_difference(frame, middle, samples[5]))};
    const int axis = change[0] > change[1] ? 0 : 1;
    if (!(change[axis] > most) || !std::isfinite(change[axis])) return std::nullopt;
    return axis;
  }

  void finish(PatchCell& cell, const std::array<PatchCurvature, 9>& samples,
              const std::vector<TrimSegment>& near) {
    std::vector<Vec3> normals;
    Vec3 sum = Vec3::Zero();
    bool regular = true;
    const PatchCurvature& middle = samples[4];
    const TangentFrame frame(middle);
    for (const PatchCurvature& c : samples) {
      const double u = c.du.norm(), v = c.dv.norm();
      const Vec3 n = c.du.cross(c.dv);
      if (!(n.norm() > 1e-6 * u * v) || !(u > 0) || !(v > 0)) {
        regular = false;
        continue;
      }
      // H = I + r . S'' with r = (middle - query) + (S - middle): what differs from the middle's.
      cell.bend_change = std::max(cell.bend_change, bend_difference(frame, middle, c));
      cell.metric_change = std::max(cell.metric_change, metric_difference(frame, middle, c));
      normals.push_back(n.normalized());
      sum += normals.back();
    }
    if (!regular) cell.metric_change = std::numeric_limits<double>::infinity();
    if (normals.size() >= 6 && sum.norm() > 0.1) {
      cell.normal_axis = sum.normalized();
      double widest = 0;
      for (const Vec3& n : normals) {
        widest = std::max(widest, std::acos(std::clamp(n.dot(cell.normal_axis), -1.0, 1.0)));
      }
      // The cone of nine samples, opened for what lies between them.
      const double angle = 1.5 * widest + 0.02;
      cell.normal_cosine = angle < 3 ? std::cos(angle) : -1;
    }
    for (int axis = 0; axis < 2; ++axis) {
      if (settings_.open_sides[2 * axis] && cell.box.min()[axis] <= domain_.min()[axis])
        cell.at_open_side = true;
      if (settings_.open_sides[2 * axis + 1] && cell.box.max()[axis] >= domain_.max()[axis]) {
        cell.at_open_side = true;
      }
    }
    cell.first_segment = static_cast<Offset>(result_.segments.size());
    cell.segment_count = static_cast<Index>(near.size());
    result_.segments.insert(result_.segments.end(), near.begin(), near.end());
    result_.cells.push_back(cell);
  }

  Eigen::AlignedBox2d domain_;
  Index number_;
  const CellSettings& settings_;
  TrimmedCells& result_;
};

}  // namespace

void append_cells(const BoundedPatch& patch, Index patch_number, const TrimOutline& outline,
                  const CellSettings& settings, TrimmedCells& result) {
  Splitter splitter(patch, patch_number, settings, result);
  const std::vector<double> u = patch.breaks(0), v = patch.breaks(1);
  for (std::size_t i = 0; i + 1 < u.size(); ++i) {
    for (std::size_t j = 0; j + 1 < v.size(); ++j) {
      const CellSurface surface(patch, {Vec2(u[i], v[j]), Vec2(u[i + 1], v[j + 1])});
      const Vec2 reference = reference_of(surface.box());
      const bool inside =
          outline.reference_inside != odd_crossings(outline.reference, reference, outline.segments);
      const auto near = splitter.near_box(surface.box(), outline.segments, Splitter::lengths_of(surface));
      splitter.split(surface, near, inside, 0);
    }
  }
}

TrimSide trim_side(const TrimmedCells& cells, const PatchCell& cell, const PatchPoint& point, const Vec2& uv,
                   double margin) {
  if (cell.segment_count == 0) return TrimSide::inside;
  const std::span<const TrimSegment> near(cells.segments.data() + cell.first_segment,
                                          static_cast<std::size_t>(cell.segment_count));
  bool inside = cell.reference_inside;
  for (const TrimSegment& s : near) {
    const Vec2 a = s.a - uv, d = s.b - s.a;
    // Distance in space to first order: |du x + dv y|.
    const Vec3 A = point.du * a.x() + point.dv * a.y(), D = point.du * d.x() + point.dv * d.y();
    const double length = D.squaredNorm();
    const double t = length > 0 ? std::clamp(-A.dot(D) / length, 0.0, 1.0) : 0.0;
    if ((A + t * D).squaredNorm() <= margin * margin) return TrimSide::near_border;
    inside ^= crosses(uv, cell.reference, s);
  }
  return inside ? TrimSide::inside : TrimSide::outside;
}

}  // namespace flowcage
