#include "core/project/trimmed_cells.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <span>

namespace flowcage {
namespace {

constexpr double least_uneven = 0.01;  // of max_size: cells below are not split for their parametrisation

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

/// Bound of the norm of the quadratic form (p q; q s) relative to the first fundamental form.
double relative_norm(const PatchCurvature& at, double p, double q, double s) {
  const double u = at.du.norm(), v = at.dv.norm();
  if (!(u > 0) || !(v > 0)) return std::numeric_limits<double>::infinity();
  const double cosine = std::min(1.0, std::abs(at.du.dot(at.dv)) / (u * v));
  return (std::max(p / (u * u), s / (v * v)) + q / (u * v)) / (1 - cosine + 1e-12);
}

/// Bound of how much the Hessian of half the squared distance of the point `middle` differs between it and
/// another point of the cell, relative to the first fundamental form.
double metric_difference(const PatchCurvature& middle, const PatchCurvature& c) {
  const Vec3 way = c.position - middle.position;
  return relative_norm(middle, std::abs(c.du.squaredNorm() + way.dot(c.duu) - middle.du.squaredNorm()),
                       std::abs(c.du.dot(c.dv) + way.dot(c.duv) - middle.du.dot(middle.dv)),
                       std::abs(c.dv.squaredNorm() + way.dot(c.dvv) - middle.dv.squaredNorm()));
}

class Splitter {
 public:
  Splitter(const BoundedPatch& patch, Index number, const CellSettings& settings, TrimmedCells& result)
      : patch_(patch), number_(number), settings_(settings), result_(result) {}

  void split(const Eigen::AlignedBox2d& box, const std::vector<TrimSegment>& near, bool inside, int depth) {
    PatchCell cell;
    cell.box = box;
    cell.patch = number_;
    cell.reference = reference_of(box);
    cell.reference_inside = inside;
    if (near.empty() && !inside) return;
    const Vec2 lengths = measure(cell);
    const Vec2 deviation = patch_.deviation(box);
    const double twist = hull_gap(cell);
    const double diagonal = std::max((cell.p11 - cell.p00).norm(), (cell.p10 - cell.p01).norm());
    cell.slack = deviation.sum() + twist;
    const double size = std::max(diagonal, lengths.norm());
    const bool flat = cell.slack <= settings_.flatness * diagonal;
    const bool small = size <= (near.empty() ? settings_.max_size : settings_.max_trimmed_size);
    const bool done = flat && small;
    std::optional<int> uneven;
    if (done && size > least_uneven * settings_.max_size) uneven = uneven_axis(cell);
    if ((done && !uneven) || size <= settings_.min_size || depth >= settings_.max_depth) {
      finish(cell, near);
      return;
    }
    int axis = uneven.value_or(lengths.x() > lengths.y() ? 0 : 1);
    if (!flat && std::max(deviation.x(), deviation.y()) > twist) axis = deviation.x() > deviation.y() ? 0 : 1;
    const double middle = 0.5 * (box.min()[axis] + box.max()[axis]);
    if (!(middle > box.min()[axis] && middle < box.max()[axis])) {
      finish(cell, near);
      return;
    }
    for (const bool upper : {false, true}) {
      Eigen::AlignedBox2d half = box;
      (upper ? half.min() : half.max())[axis] = middle;
      const Vec2 reference = reference_of(half);
      const bool half_inside = inside != odd_crossings(cell.reference, reference, near);
      split(half, near_box(half, near, lengths), half_inside, depth + 1);
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

  /// Corners, and the lengths in space of the box along u and v.
  Vec2 measure(PatchCell& cell) const {
    const Vec2 low = cell.box.min(), high = cell.box.max();
    cell.p00 = patch_.first(low).position;
    cell.p10 = patch_.first({high.x(), low.y()}).position;
    cell.p01 = patch_.first({low.x(), high.y()}).position;
    cell.p11 = patch_.first(high).position;
    const PatchPoint middle = patch_.first(cell.box.center());
    return {std::max({(cell.p10 - cell.p00).norm(), (cell.p11 - cell.p01).norm(),
                      middle.du.norm() * cell.box.sizes().x()}),
            std::max({(cell.p01 - cell.p00).norm(), (cell.p11 - cell.p10).norm(),
                      middle.dv.norm() * cell.box.sizes().y()})};
  }

 private:
  /// The axis along which the parametrisation's speed changes most, if it is so much that nearest points of
  /// near queries could not be shown to be the only ones.
  std::optional<int> uneven_axis(const PatchCell& cell) const {
    constexpr double most = 0.3;
    const PatchCurvature middle = patch_.second(cell.box.center());
    std::array<double, 2> change{};
    for (int axis = 0; axis < 2; ++axis) {
      for (const double end : {0.0, 1.0}) {
        Vec2 fraction(0.5, 0.5);
        fraction[axis] = end;
        const PatchCurvature c = patch_.second(cell.box.min() + fraction.cwiseProduct(cell.box.sizes()));
        change[axis] = std::max(change[axis], metric_difference(middle, c));
      }
    }
    const int axis = change[0] > change[1] ? 0 : 1;
    if (!(change[axis] > most) || !std::isfinite(change[axis])) return std::nullopt;
    return axis;
  }

  void finish(PatchCell& cell, const std::vector<TrimSegment>& near) {
    std::vector<Vec3> normals;
    Vec3 sum = Vec3::Zero();
    bool regular = true;
    const PatchCurvature middle = patch_.second(cell.box.center());
    for (const double a : {0.0, 0.5, 1.0}) {
      for (const double b : {0.0, 0.5, 1.0}) {
        const PatchCurvature c = patch_.second(cell.box.min() + Vec2(a, b).cwiseProduct(cell.box.sizes()));
        const double u = c.du.norm(), v = c.dv.norm();
        const Vec3 n = c.du.cross(c.dv);
        if (!(n.norm() > 1e-6 * u * v) || !(u > 0) || !(v > 0)) {
          regular = false;
          continue;
        }
        // H = I + r . S'' with r = (middle - query) + (S - middle): what differs from the middle's.
        cell.bend_change = std::max(
            cell.bend_change, relative_norm(middle, (c.duu - middle.duu).norm(), (c.duv - middle.duv).norm(),
                                            (c.dvv - middle.dvv).norm()));
        cell.metric_change = std::max(cell.metric_change, metric_difference(middle, c));
        normals.push_back(n.normalized());
        sum += normals.back();
      }
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
    const Eigen::AlignedBox2d domain = patch_.domain();
    for (int axis = 0; axis < 2; ++axis) {
      if (settings_.open_sides[2 * axis] && cell.box.min()[axis] <= domain.min()[axis])
        cell.at_open_side = true;
      if (settings_.open_sides[2 * axis + 1] && cell.box.max()[axis] >= domain.max()[axis]) {
        cell.at_open_side = true;
      }
    }
    cell.first_segment = static_cast<Offset>(result_.segments.size());
    cell.segment_count = static_cast<Index>(near.size());
    result_.segments.insert(result_.segments.end(), near.begin(), near.end());
    result_.cells.push_back(cell);
  }

  const BoundedPatch& patch_;
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
      PatchCell cell;
      cell.box = Eigen::AlignedBox2d(Vec2(u[i], v[j]), Vec2(u[i + 1], v[j + 1]));
      const bool inside = outline.reference_inside !=
                          odd_crossings(outline.reference, reference_of(cell.box), outline.segments);
      const auto near = splitter.near_box(cell.box, outline.segments, splitter.measure(cell));
      splitter.split(cell.box, near, inside, 0);
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
