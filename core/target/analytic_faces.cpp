#include "core/target/analytic_faces.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace flowcage {
namespace {

constexpr double pi = std::numbers::pi;
constexpr int circle_segments = 64;
constexpr int profile_segments = 32;

/// Real roots of sum_k c[k] t^k in [low, high], ascending: between neighbouring roots of the derivative a
/// polynomial is monotone, so bisection with secant steps finds each root. A touching root (of even
/// multiplicity) is taken where |p| is below the noise of its own terms.
std::vector<double> polynomial_roots(const std::vector<double>& c, double low, double high) {
  std::size_t degree = c.size() - 1;
  double scale = 0;
  const double reach = std::max(std::abs(low), std::abs(high));
  for (std::size_t k = 0; k <= degree; ++k) {
    scale = std::max(scale, std::abs(c[k]) * std::pow(reach, static_cast<double>(k)));
  }
  if (scale == 0) return {};
  while (degree > 0 && std::abs(c[degree]) * std::pow(reach, static_cast<double>(degree)) < 1e-15 * scale) {
    --degree;
  }
  if (degree == 0) return {};
  const auto value = [&](double t) {
    double p = c[degree];
    for (std::size_t k = degree; k-- > 0;) p = p * t + c[k];
    return p;
  };
  if (degree == 1) {
    const double root = -c[0] / c[1];
    return root >= low && root <= high ? std::vector<double>{root} : std::vector<double>{};
  }
  std::vector<double> derivative(degree);
  for (std::size_t k = 1; k <= degree; ++k) derivative[k - 1] = static_cast<double>(k) * c[k];
  std::vector<double> stops = polynomial_roots(derivative, low, high);
  stops.insert(stops.begin(), low);
  stops.push_back(high);
  const double noise = 1e-14 * scale;
  std::vector<double> roots;
  for (std::size_t i = 0; i + 1 < stops.size(); ++i) {
    double a = stops[i], b = stops[i + 1];
    const double pa = value(a), pb = value(b);
    if (i > 0 && std::abs(pa) <= noise) roots.push_back(a);
    if (std::abs(pa) <= noise || std::abs(pb) <= noise || (pa > 0) == (pb > 0)) continue;
    for (int step = 0; step < 200 && b - a > 1e-16 * reach; ++step) {
      const double mid = 0.5 * (a + b);
      if (mid <= a || mid >= b) break;
      ((value(mid) > 0) == (pa > 0) ? a : b) = mid;
    }
    roots.push_back(0.5 * (a + b));
  }
  std::sort(roots.begin(), roots.end());
  return roots;
}

void add_grid(const AnalyticFace& face, Index number, Tessellation& mesh, const std::array<int, 2>& counts) {
  const Eigen::AlignedBox2d domain = face.domain();
  const auto first = static_cast<Index>(mesh.points.size());
  for (int j = 0; j <= counts[1]; ++j) {
    for (int i = 0; i <= counts[0]; ++i) {
      const Vec2 fraction(static_cast<double>(face.periodic_u() ? i % counts[0] : i) / counts[0],
                          static_cast<double>(face.periodic_v() ? j % counts[1] : j) / counts[1]);
      mesh.points.push_back(face.first(domain.min() + fraction.cwiseProduct(domain.sizes())).position);
    }
  }
  const auto add_triangle = [&](Index a, Index b, Index c) {
    const Vec3 ab = mesh.points[b] - mesh.points[a], ac = mesh.points[c] - mesh.points[a];
    const double size = std::max(ab.squaredNorm(), ac.squaredNorm());
    if (ab.cross(ac).norm() < 1e-12 * size) return;  // the sliver at a pole
    mesh.triangles.push_back({a, b, c});
    mesh.triangle_face.push_back(number);
  };
  for (int j = 0; j < counts[1]; ++j) {
    for (int i = 0; i < counts[0]; ++i) {
      const Index a = first + j * (counts[0] + 1) + i, b = a + 1, d = a + counts[0] + 1, c = d + 1;
      add_triangle(a, b, c);
      add_triangle(a, c, d);
    }
  }
}

class RevolutionFace final : public AnalyticFace {
 public:
  RevolutionFace(std::string name, const Frame& frame, const Profile& profile)
      : AnalyticFace(std::move(name)), frame_(frame), profile_(profile) {
    const Vec2 reach = (profile.center.cwiseAbs() + Vec2::Constant(profile.radius)).cwiseMax(profile.end);
    size_ = reach.norm();
  }

  PatchPoint first(const Vec2& uv) const override {
    const PatchCurvature all = second(uv);
    return {all.position, all.du, all.dv};
  }

  PatchCurvature second(const Vec2& uv) const override {
    const Vec3 radial = std::cos(uv.x()) * frame_.x + std::sin(uv.x()) * frame_.y;
    const Vec3 along = -std::sin(uv.x()) * frame_.x + std::cos(uv.x()) * frame_.y;
    const Vec2 p = profile_point(uv.y()), d = profile_tangent(uv.y());
    const Vec2 dd = profile_.radius > 0 ? Vec2(profile_.center - p) : Vec2::Zero();
    return {frame_.origin + p.x() * radial + p.y() * frame_.z,
            p.x() * along,
            d.x() * radial + d.y() * frame_.z,
            -p.x() * radial,
            d.x() * along,
            dd.x() * radial + dd.y() * frame_.z};
  }

  Eigen::AlignedBox2d domain() const override {
    return {Vec2(0, profile_.first), Vec2(2 * pi, profile_.last)};
  }
  bool periodic_u() const override { return true; }
  bool periodic_v() const override { return profile_.last - profile_.first > 2 * pi - 1e-9; }

  Vec3 normal(const Vec2& uv) const override {
    const Vec2 d = profile_tangent(uv.y()).normalized();
    return (d.y() * (std::cos(uv.x()) * frame_.x + std::sin(uv.x()) * frame_.y) - d.x() * frame_.z)
        .normalized();
  }

  SurfacePoint closest(const Vec3& query) const override {
    // The nearest point lies in the query's own meridional half plane.
    const Vec2 q = meridional(query);
    double v = profile_.first;
    bool inside = true;
    if (profile_.radius > 0) {
      const Vec2 offset = q - profile_.center;
      v = offset.squaredNorm() > 0 ? std::atan2(offset.y(), offset.x()) : profile_.first;
      while (v < profile_.first) v += 2 * pi;
      while (v >= profile_.first + 2 * pi) v -= 2 * pi;
      if (v > profile_.last) {
        inside = false;
        v = v - profile_.last < profile_.first + 2 * pi - v ? profile_.last : profile_.first;
      }
    } else {
      const Vec2 direction = (profile_.end - profile_.center) / profile_.last;
      const double s = direction.dot(q - profile_.center);
      v = std::clamp(s, 0.0, profile_.last);
      inside = s == v;
    }
    const Vec2 uv(longitude(query), v);
    SurfacePoint hit = at(uv);
    hit.distance = (query - hit.position).norm();
    // The end of a profile on the axis is a point inside of the face, not a border.
    const bool on_axis = profile_point(v).x() <= 1e-14 * size_;
    hit.status = inside || on_axis ? FootStatus::interior : FootStatus::boundary;
    return hit;
  }

  void intersect(const Vec3& origin, const Vec3& direction, std::vector<SurfacePoint>& hits) const override {
    // Local coordinates, from the line's point nearest to the shape's middle, in units of its size.
    const Vec3 middle = frame_.origin + profile_.center.y() * frame_.z;
    const double shift = direction.dot(middle - origin);
    const Vec3 start = to_frame(origin + shift * direction) / size_;
    const Vec3 step(direction.dot(frame_.x), direction.dot(frame_.y), direction.dot(frame_.z));
    for (const double t : polynomial_roots(polynomial(start, step), -1.5, 1.5)) {
      const Vec3 point = origin + (shift + t * size_) * direction;
      const Vec2 m = meridional(point);
      double v = 0;
      if (profile_.radius > 0) {
        v = std::atan2(m.y() - profile_.center.y(), m.x() - profile_.center.x());
        while (v < profile_.first - 1e-12) v += 2 * pi;
        if (v > profile_.last + 1e-12) continue;
      } else {
        const Vec2 along = (profile_.end - profile_.center) / profile_.last;
        v = along.dot(m - profile_.center);
        const double off = (m - profile_.center - v * along).norm();
        if (off > 1e-9 * size_) continue;  // the cone's other half
        if (v < -1e-12 * size_ || v > profile_.last + 1e-12 * size_) continue;
      }
      SurfacePoint hit = at(Vec2(longitude(point), std::clamp(v, profile_.first, profile_.last)));
      hit.distance = std::abs(shift + t * size_);
      hit.status = FootStatus::interior;
      hits.push_back(hit);
    }
  }

  Box3 box() const override {
    // A coordinate's extremes: over the circle of radius rho at height z it is z k -+ rho h, which along an
    // arc has its own extremes where the profile's normal is (-+h, k), or at the profile's ends.
    Vec3 low, high;
    for (int axis = 0; axis < 3; ++axis) {
      const double h = std::hypot(frame_.x[axis], frame_.y[axis]), k = frame_.z[axis];
      std::vector<double> stops{profile_.first, profile_.last};
      for (const double angle :
           {std::atan2(k, h), std::atan2(k, -h), std::atan2(-k, h), std::atan2(-k, -h)}) {
        for (const double v : {angle, angle + 2 * pi}) {
          if (profile_.radius > 0 && v > profile_.first && v < profile_.last) stops.push_back(v);
        }
      }
      low[axis] = high[axis] = frame_.origin[axis] + k * profile_point(profile_.first).y();
      for (const double v : stops) {
        const Vec2 p = profile_point(v);
        low[axis] = std::min(low[axis], frame_.origin[axis] + k * p.y() - h * p.x());
        high[axis] = std::max(high[axis], frame_.origin[axis] + k * p.y() + h * p.x());
      }
    }
    return {low, high};
  }

  void tessellate(Index face, Tessellation& mesh) const override {
    add_grid(*this, face, mesh, {circle_segments, profile_segments});
  }

 private:
  Vec2 profile_point(double v) const {
    if (profile_.radius > 0) return profile_.center + profile_.radius * Vec2(std::cos(v), std::sin(v));
    if (v == profile_.last) return profile_.end;
    return profile_.center + (profile_.end - profile_.center) * (v / profile_.last);
  }
  Vec2 profile_tangent(double v) const {
    if (profile_.radius > 0) return profile_.radius * Vec2(-std::sin(v), std::cos(v));
    return (profile_.end - profile_.center) / profile_.last;
  }
  Vec3 to_frame(const Vec3& p) const {
    const Vec3 d = p - frame_.origin;
    return {d.dot(frame_.x), d.dot(frame_.y), d.dot(frame_.z)};
  }
  Vec2 meridional(const Vec3& p) const {
    const Vec3 local = to_frame(p);
    return {std::hypot(local.x(), local.y()), local.z()};
  }
  double longitude(const Vec3& p) const {
    const Vec3 local = to_frame(p);
    const double u = local.x() == 0 && local.y() == 0 ? 0.0 : std::atan2(local.y(), local.x());
    return u < 0 ? u + 2 * pi : u;
  }
  SurfacePoint at(const Vec2& uv) const {
    SurfacePoint hit;
    hit.uv = uv;
    hit.position = first(uv).position;
    hit.normal = normal(uv);
    return hit;
  }

  /// Coefficients in t of the implicit equation along start + t step (frame coordinates, in units of size_).
  std::vector<double> polynomial(const Vec3& start, const Vec3& step) const {
    const Vec3 p = start - Vec3(0, 0, profile_.center.y() / size_);
    const double xx = p.head<2>().squaredNorm(), xd = p.head<2>().dot(step.head<2>()),
                 dd = step.head<2>().squaredNorm();
    if (profile_.radius > 0) {
      const double R = profile_.center.x() / size_, r = profile_.radius / size_;
      // |p|^2 = q0 + q1 t + t^2
      const double q0 = p.squaredNorm() - r * r, q1 = 2 * p.dot(step), q2 = step.squaredNorm();
      if (R == 0) return {q0, q1, q2};
      // (|p|^2 + R^2 - r^2)^2 = 4 R^2 (x^2 + y^2)
      const double a0 = q0 + R * R;
      return {a0 * a0 - 4 * R * R * xx, 2 * a0 * q1 - 8 * R * R * xd, q1 * q1 + 2 * a0 * q2 - 4 * R * R * dd,
              2 * q1 * q2, q2 * q2};
    }
    const Vec2 d = (profile_.end - profile_.center) / profile_.last;
    if (d.y() == 0) return {p.z(), step.z()};
    // rho = rho_0 + k z, both sides squared
    const double k = d.x() / d.y(), rho = profile_.center.x() / size_;
    const double l0 = rho + k * p.z(), l1 = k * step.z();
    return {xx - l0 * l0, 2 * (xd - l0 * l1), dd - l1 * l1};
  }

  Frame frame_;
  Profile profile_;
  double size_ = 1;
};

class RectangleFace final : public AnalyticFace {
 public:
  RectangleFace(std::string name, const Vec3& origin, const Vec3& a, const Vec3& b)
      : AnalyticFace(std::move(name)), origin_(origin), a_(a), b_(b) {}

  PatchPoint first(const Vec2& uv) const override {
    return {origin_ + a_ * (uv.x() / a_.norm()) + b_ * (uv.y() / b_.norm()), a_.normalized(),
            b_.normalized()};
  }
  PatchCurvature second(const Vec2& uv) const override {
    const PatchPoint p = first(uv);
    return {p.position, p.du, p.dv, Vec3::Zero(), Vec3::Zero(), Vec3::Zero()};
  }
  Eigen::AlignedBox2d domain() const override { return {Vec2(0, 0), Vec2(a_.norm(), b_.norm())}; }
  bool periodic_u() const override { return false; }
  bool periodic_v() const override { return false; }
  Vec3 normal(const Vec2&) const override { return a_.cross(b_).normalized(); }

  SurfacePoint closest(const Vec3& query) const override {
    const Vec3 offset = query - origin_;
    const Vec2 foot(offset.dot(a_) / a_.norm(), offset.dot(b_) / b_.norm());
    SurfacePoint hit;
    hit.uv = foot.cwiseMax(0.0).cwiseMin(domain().max());
    hit.position = first(hit.uv).position;
    hit.normal = normal(hit.uv);
    hit.distance = (query - hit.position).norm();
    hit.status = hit.uv == foot ? FootStatus::interior : FootStatus::boundary;
    return hit;
  }

  void intersect(const Vec3& origin, const Vec3& direction, std::vector<SurfacePoint>& hits) const override {
    const Vec3 n = normal(Vec2::Zero());
    const double slope = n.dot(direction);
    if (slope == 0) return;
    const double t = n.dot(origin_ - origin) / slope;
    const Vec3 offset = origin + t * direction - origin_;
    const Vec2 uv(offset.dot(a_) / a_.norm(), offset.dot(b_) / b_.norm());
    const Vec2 inside = uv.cwiseMax(0.0).cwiseMin(domain().max());
    if (!((uv - inside).norm() <= 1e-12 * (a_.norm() + b_.norm()))) return;
    SurfacePoint hit;
    hit.uv = inside;
    hit.position = first(inside).position;
    hit.normal = n;
    hit.distance = std::abs(t);
    hit.status = FootStatus::interior;
    hits.push_back(hit);
  }

  Box3 box() const override {
    Box3 box(origin_);
    return box.extend(origin_ + a_).extend(origin_ + b_).extend(origin_ + a_ + b_);
  }
  void tessellate(Index face, Tessellation& mesh) const override { add_grid(*this, face, mesh, {8, 8}); }

 private:
  Vec3 origin_, a_, b_;
};

}  // namespace

Frame frame_along(const Vec3& origin, const Vec3& z) {
  int smallest = 0;
  z.cwiseAbs().minCoeff(&smallest);
  const Vec3 x = (Vec3::Unit(smallest) - z[smallest] * z).normalized();
  return {origin, x, z.cross(x), z};
}

Profile arc_profile(const Vec2& center, double radius, const Vec2& first_last) {
  return {center, radius, Vec2::Zero(), first_last.x(), first_last.y()};
}

Profile segment_profile(const Vec2& start, const Vec2& end) {
  return {start, 0, end, 0, (end - start).norm()};
}

std::unique_ptr<AnalyticFace> revolution_face(std::string name, const Frame& frame, const Profile& profile) {
  return std::make_unique<RevolutionFace>(std::move(name), frame, profile);
}

std::unique_ptr<AnalyticFace> rectangle_face(std::string name, const Vec3& origin, const Vec3& a,
                                             const Vec3& b) {
  return std::make_unique<RectangleFace>(std::move(name), origin, a, b);
}

}  // namespace flowcage
