#include "tests/refit/patch_target.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "core/base/parallel.hpp"
#include "core/project/closest_point.hpp"

namespace flowcage::test {
namespace {

constexpr int starts_u = 40;
constexpr int starts_v = 24;
constexpr int arc_samples = 2000;

double half_thickness(const WingCageShape& wing, double u) {
  // x = u^2: smooth in u at the leading edge.
  const double x = u * u;
  return 5 * wing.thickness *
             (0.2969 * u - 0.1260 * x - 0.3516 * x * x + 0.2843 * x * x * x - 0.1036 * x * x * x * x) +
         wing.half_base * x;
}

}  // namespace

struct PatchTarget::Patch final : ParametricPatch {
  PatchFunction f;

  explicit Patch(PatchFunction function) : f(std::move(function)) {}
  // Central differences inside, shifted at the border: h^2 errors of 1e-10 in first derivatives, which only
  // steer Newton's method; positions are exact.
  PatchPoint first(const Vec2& uv) const override {
    const PatchCurvature all = second(uv);
    return {all.position, all.du, all.dv};
  }
  PatchCurvature second(const Vec2& uv) const override {
    constexpr double h = 1e-4;
    const double u = std::clamp(uv.x(), h, 1 - h);
    const double v = std::clamp(uv.y(), h, 1 - h);
    const Vec3 middle = f(u, v);
    const Vec3 du = (f(u + h, v) - f(u - h, v)) / (2 * h);
    const Vec3 dv = (f(u, v + h) - f(u, v - h)) / (2 * h);
    const Vec3 duu = (f(u + h, v) - 2 * middle + f(u - h, v)) / (h * h);
    const Vec3 dvv = (f(u, v + h) - 2 * middle + f(u, v - h)) / (h * h);
    const Vec3 duv = (f(u + h, v + h) - f(u - h, v + h) - f(u + h, v - h) + f(u - h, v - h)) / (4 * h * h);
    const double a = uv.x() - u;
    const double b = uv.y() - v;
    return {f(uv.x(), uv.y()), du + a * duu + b * duv, dv + a * duv + b * dvv, duu, duv, dvv};
  }
  Eigen::AlignedBox2d domain() const override { return {Vec2(0, 0), Vec2(1, 1)}; }
  bool periodic_u() const override { return false; }
  bool periodic_v() const override { return false; }
};

PatchTarget::PatchTarget(std::vector<PatchFunction> patches, std::vector<Vec3> corners,
                         std::vector<ChainOfTarget> chains)
    : curves_(std::move(chains)) {
  graph_.corners = std::move(corners);
  for (PatchFunction& f : patches) {
    patches_.push_back(std::make_unique<Patch>(std::move(f)));
    const Patch& patch = *patches_.back();
    Starts starts;
    const Index base = static_cast<Index>(tessellation_.points.size());
    const Index face = static_cast<Index>(patches_.size()) - 1;
    for (int j = 0; j <= starts_v; ++j) {
      for (int i = 0; i <= starts_u; ++i) {
        starts.uv.emplace_back(static_cast<double>(i) / starts_u, static_cast<double>(j) / starts_v);
        starts.points.push_back(patch.f(starts.uv.back().x(), starts.uv.back().y()));
        tessellation_.points.push_back(starts.points.back());
        bounds_.extend(starts.points.back());
        if (i == starts_u || j == starts_v) continue;
        const Index a = base + j * (starts_u + 1) + i;
        tessellation_.triangles.push_back({a, a + 1, a + starts_u + 2});
        tessellation_.triangles.push_back({a, a + starts_u + 2, a + starts_u + 1});
        tessellation_.triangle_face.insert(tessellation_.triangle_face.end(), {face, face});
      }
    }
    starts_.push_back(std::move(starts));
  }
  for (const ChainOfTarget& c : curves_) {
    FeatureChain chain;
    chain.kind = c.kind;
    chain.start = c.start;
    chain.end = c.end;
    // Arc length by Simpson's rule on each interval's speed (differences of the exact curve).
    constexpr double h = 1e-5;
    const auto speed = [&](double t) {
      const double m = std::clamp(t, h, 1 - h);
      return (c.curve(m + h) - c.curve(m - h)).norm() / (2 * h);
    };
    double s = 0;
    for (int i = 0; i <= arc_samples; ++i) {
      const double t = static_cast<double>(i) / arc_samples;
      if (i > 0) {
        const double before = t - 1.0 / arc_samples;
        s += (speed(before) + 4 * speed(0.5 * (before + t)) + speed(t)) / (6 * arc_samples);
      }
      chain.polyline.push_back(c.curve(t));
      chain.polyline_s.push_back(s);
    }
    chain.length = s;
    graph_.chains.push_back(std::move(chain));
  }
}

PatchTarget::~PatchTarget() = default;

SurfacePoint PatchTarget::point_on(Index patch, const Vec2& uv, const Vec3& query) const {
  SurfacePoint p;
  const PatchPoint at = patches_[patch]->first(uv);
  p.position = at.position;
  p.normal = at.du.cross(at.dv);
  if (p.normal.norm() < 1e-9) {  // a pole: the normal a little inside
    const Vec2 inside = uv + 1e-3 * (Vec2(0.5, 0.5) - uv);
    const PatchPoint near = patches_[patch]->first(inside);
    p.normal = near.du.cross(near.dv);
  }
  p.normal.normalize();
  p.face = patch;
  p.uv = uv;
  p.distance = (p.position - query).norm();
  return p;
}

std::vector<SurfacePoint> PatchTarget::local_minima(const Vec3& query) const {
  std::vector<SurfacePoint> found;
  ClosestPointSettings settings;
  settings.length = bounds_.diagonal().norm();
  for (Index f = 0; f < face_count(); ++f) {
    const Starts& starts = starts_[f];
    std::array<std::pair<double, std::size_t>, 3> best;
    best.fill({1e300, 0});
    for (std::size_t i = 0; i < starts.points.size(); ++i) {
      const double d = (starts.points[i] - query).squaredNorm();
      if (d >= best[2].first) continue;
      // Starts far apart in the patch: neighbours of a better one lead to the same place.
      bool near = false;
      for (auto& b : best) {
        if (b.first < 1e300 && (starts.uv[b.second] - starts.uv[i]).cwiseAbs().maxCoeff() < 0.2) {
          near = true;
          if (d < b.first) b = {d, i};
          break;
        }
      }
      if (!near) best[2] = {d, i};
      std::sort(best.begin(), best.end());
    }
    for (const auto& b : best) {
      if (b.first >= 1e300) continue;
      const PatchFoot foot = closest_point(*patches_[f], query, starts.uv[b.second], settings);
      if (foot.convergence == FootConvergence::no_number) continue;
      SurfacePoint p = point_on(f, foot.uv, query);
      const Vec3 way = query - p.position;
      const double along = std::abs(way.dot(p.normal));
      p.status = along > 0.999 * way.norm() || way.norm() < 1e-12 * settings.length ? FootStatus::interior
                                                                                    : FootStatus::boundary;
      found.push_back(p);
    }
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const auto& a, const auto& b) { return a.distance < b.distance; });
  return found;
}

void PatchTarget::closest_points(std::span<const Vec3> queries, std::span<const SurfacePoint>,
                                 std::span<SurfacePoint> results) const {
  parallel_for(static_cast<Offset>(queries.size()), 16, [&](Offset begin, Offset end) {
    for (Offset i = begin; i < end; ++i) {
      const auto found = local_minima(queries[i]);
      results[i] = found.empty() ? SurfacePoint{} : found.front();
    }
  });
}

void PatchTarget::closest_compatible(std::span<const Vec3> queries, std::span<const Vec3> normals,
                                     double min_cosine, double max_distance,
                                     std::span<SurfacePoint> results) const {
  parallel_for(static_cast<Offset>(queries.size()), 16, [&](Offset begin, Offset end) {
    for (Offset i = begin; i < end; ++i) {
      results[i] = {};
      for (const SurfacePoint& p : local_minima(queries[i])) {
        if (p.distance > max_distance || p.normal.dot(normals[i]) < min_cosine) continue;
        results[i] = p;
        break;
      }
    }
  });
}

void PatchTarget::intersect_lines(std::span<const Vec3> queries, std::span<const Vec3> directions,
                                  double min_cosine, double max_distance,
                                  std::span<SurfacePoint> results) const {
  parallel_for(static_cast<Offset>(queries.size()), 16, [&](Offset begin, Offset end) {
    for (Offset i = begin; i < end; ++i) {
      results[i] = {};
      const Vec3& q = queries[i];
      const Vec3& n = directions[i];
      for (Index f = 0; f < face_count(); ++f) {
        std::array<std::pair<double, std::size_t>, 3> best;
        best.fill({1e300, 0});
        for (std::size_t k = 0; k < starts_[f].points.size(); ++k) {
          const Vec3 way = starts_[f].points[k] - q;
          const double d = way.cross(n).squaredNorm() + 1e-2 * way.squaredNorm();
          if (d < best[2].first) best[2] = {d, k};
          std::sort(best.begin(), best.end());
        }
        for (const auto& b : best) {
          // Newton for S(u,v) - q - t n = 0.
          Vec2 uv = starts_[f].uv[b.second];
          double t = (starts_[f].points[b.second] - q).dot(n);
          bool hit = false;
          for (int step = 0; step < 30; ++step) {
            const PatchPoint p = patches_[f]->first(uv);
            const Vec3 r = q + t * n - p.position;
            if (r.norm() < 1e-13 * bounds_.diagonal().norm()) {
              hit = true;
              break;
            }
            Eigen::Matrix3d jacobian;
            jacobian << p.du, p.dv, -n;
            const Vec3 move = jacobian.partialPivLu().solve(r);
            if (!move.allFinite()) break;
            uv = (uv + move.head<2>().cwiseMax(-0.2).cwiseMin(0.2)).cwiseMax(0.0).cwiseMin(1.0);
            t += move.z();
          }
          if (!hit || std::abs(t) > max_distance) continue;
          SurfacePoint p = point_on(f, uv, q);
          if (p.normal.dot(n) < min_cosine) continue;
          p.status = FootStatus::interior;
          if (results[i].status == FootStatus::failed || p.distance < results[i].distance) results[i] = p;
        }
      }
    }
  });
}

CurvePoint PatchTarget::chain_point(Index chain, double s) const {
  const FeatureChain& c = graph_.chains[chain];
  s = std::clamp(s, 0.0, c.length);
  const auto above = std::upper_bound(c.polyline_s.begin() + 1, c.polyline_s.end() - 1, s);
  const std::size_t i = static_cast<std::size_t>(above - c.polyline_s.begin()) - 1;
  const double part = (s - c.polyline_s[i]) / (c.polyline_s[i + 1] - c.polyline_s[i]);
  const double t = (static_cast<double>(i) + part) / arc_samples;
  CurvePoint p;
  p.s = s;
  p.position = curves_[chain].curve(t);
  const double m = std::clamp(t, 1e-5, 1 - 1e-5);
  p.tangent = (curves_[chain].curve(m + 1e-5) - curves_[chain].curve(m - 1e-5)).normalized();
  return p;
}

CurvePoint PatchTarget::closest_on_chain(Index chain, const Vec3& query) const {
  const FeatureChain& c = graph_.chains[chain];
  CurvePoint best;
  best.distance = 1e300;
  for (std::size_t i = 0; i < c.polyline.size(); ++i) {
    const double d = (c.polyline[i] - query).norm();
    if (d < best.distance) {
      best = chain_point(chain, c.polyline_s[i]);
      best.distance = d;
    }
  }
  return best;
}

std::unique_ptr<PatchTarget> wing_target(const WingCageShape& wing, TipShape tip) {
  const double slope = std::tan(wing.sweep_degrees * std::numbers::pi / 180);
  const auto at = [wing, slope](double span, double x, double z) {
    const double chord = wing.root_chord + span * (wing.tip_chord - wing.root_chord);
    const double y = span * wing.semi_span;
    return Vec3(y * slope + chord * x, y, chord * z);
  };
  const auto side = [wing, at](double sign, double span, double u) {
    return at(span, u * u, sign * half_thickness(wing, u));
  };
  std::vector<PatchFunction> patches;
  patches.emplace_back([side](double u, double v) { return side(1, v, u); });
  patches.emplace_back([side](double u, double v) { return side(-1, u, v); });
  const bool blunt = wing.half_base > 0;
  if (blunt) {
    patches.emplace_back(
        [side](double u, double v) { return Vec3((1 - v) * side(1, u, 1) + v * side(-1, u, 1)); });
    // Its normal must point downstream (+x): orient by the sense of (u, v).
    const PatchFunction base = patches.back();
    patches.back() = [base](double u, double v) { return base(v, u); };
  }
  std::vector<Vec3> corners;
  std::vector<ChainOfTarget> chains;
  if (tip == TipShape::flat) {
    patches.emplace_back(
        [side](double u, double v) { return Vec3((1 - v) * side(1, 1, u) + v * side(-1, 1, u)); });
  } else {
    patches.emplace_back([wing, at](double u, double v) {
      const double angle = std::numbers::pi * v;
      const double r = half_thickness(wing, u) * wing.tip_chord;
      Vec3 p = at(1, u * u, 0);
      p.y() += r * std::sin(angle);
      p.z() += r * std::cos(angle);
      return p;
    });
  }
  // Open at the root, sharp along the trailing edge and round a flat tip.
  const auto loop = [side](double span) {
    return [side, span](double t) { return t < 0.5 ? side(1, span, 1 - 2 * t) : side(-1, span, 2 * t - 1); };
  };
  corners = {side(1, 0, 1), side(1, 1, 1)};
  if (blunt) {
    corners.push_back(side(-1, 0, 1));
    corners.push_back(side(-1, 1, 1));
    chains.push_back({ChainKind::boundary, 0, 2, loop(0)});
    chains.push_back({ChainKind::boundary, 0, 2,
                      [side](double t) { return Vec3((1 - t) * side(1, 0, 1) + t * side(-1, 0, 1)); }});
    chains.push_back({ChainKind::sharp, 0, 1, [side](double t) { return side(1, t, 1); }});
    chains.push_back({ChainKind::sharp, 2, 3, [side](double t) { return side(-1, t, 1); }});
    chains.push_back({ChainKind::sharp, 1, 3, loop(1)});
    chains.push_back({ChainKind::sharp, 1, 3,
                      [side](double t) { return Vec3((1 - t) * side(1, 1, 1) + t * side(-1, 1, 1)); }});
  } else {
    chains.push_back({ChainKind::boundary, 0, 0, loop(0)});
    chains.push_back({ChainKind::sharp, 0, 1, [side](double t) { return side(1, t, 1); }});
    if (tip == TipShape::flat) chains.push_back({ChainKind::sharp, 1, 1, loop(1)});
  }
  return std::make_unique<PatchTarget>(std::move(patches), std::move(corners), std::move(chains));
}

}  // namespace flowcage::test
