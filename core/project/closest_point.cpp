#include "core/project/closest_point.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "core/project/quadratic_model.hpp"

namespace flowcage {
namespace {

class Search {
 public:
  Search(const ParametricPatch& patch, const Vec3& query, const ClosestPointSettings& settings)
      : patch_(patch), query_(query), settings_(settings), domain_(settings.window.value_or(patch.domain())) {
    if (!settings.window) periodic_ = {patch.periodic_u(), patch.periodic_v()};
  }

  PatchFoot run(const Vec2& start) {
    PatchFoot foot;
    if (!query_.allFinite() || !start.allFinite()) return foot;
    uv_ = inside(start);
    evaluate();
    if (!std::isfinite(f_)) return foot;
    const Vec2 extent = domain_.sizes();
    length_ = settings_.length;
    if (!(length_ > 0)) {
      for (int axis = 0; axis < 2; ++axis) {
        const double size = (axis == 0 ? at_.du : at_.dv).norm() * extent[axis];
        if (std::isfinite(size)) length_ = std::max(length_, size);
      }
      length_ = std::max({length_, 1e-3 * std::sqrt(2 * f_), 1e-300});
    }
    foot.convergence = FootConvergence::iteration_limit;
    for (; foot.iterations < settings_.max_iterations; ++foot.iterations) {
      if (const auto end = step()) {
        foot.convergence = *end;
        break;
      }
    }
    foot.uv = uv_;
    foot.evaluations = evaluations_;
    foot.point = {at_.position, at_.du, at_.dv};
    foot.distance = (at_.position - query_).norm();
    foot.at_border = held_;
    foot.convex = convex_;
    return foot;
  }

 private:
  Vec2 inside(Vec2 uv) const {
    for (int axis = 0; axis < 2; ++axis) {
      const double low = domain_.min()[axis], high = domain_.max()[axis];
      if (periodic_[axis] && (uv[axis] < low || uv[axis] >= high)) {
        uv[axis] -= (high - low) * std::floor((uv[axis] - low) / (high - low));
      }
      // Rounding must not leave a step to the border just short of it.
      const double rounding = 4 * std::numeric_limits<double>::epsilon() * (std::abs(low) + std::abs(high));
      if (uv[axis] < low + rounding) uv[axis] = low;
      if (uv[axis] > high - rounding) uv[axis] = high;
    }
    return uv;
  }

  void evaluate() {
    at_ = patch_.second(uv_);
    ++evaluations_;
    r_ = at_.position - query_;
    f_ = 0.5 * r_.squaredNorm();
  }

  ParameterBox room() const {
    ParameterBox box{domain_.min() - uv_, domain_.max() - uv_};
    for (int axis = 0; axis < 2; ++axis) {
      if (periodic_[axis]) {
        box.high[axis] = 0.5 * domain_.sizes()[axis];
        box.low[axis] = -box.high[axis];
      }
    }
    return box;
  }

  double step_length(const Vec2& d) const { return (at_.du * d.x() + at_.dv * d.y()).norm(); }

  std::optional<FootConvergence> step() {
    const Vec2 g(r_.dot(at_.du), r_.dot(at_.dv));
    const double E = at_.du.squaredNorm(), F = at_.du.dot(at_.dv), G = at_.dv.squaredNorm();
    const QuadraticModel tangent{g, E, F, G};
    const QuadraticModel full{g, E + r_.dot(at_.duu), F + r_.dot(at_.duv), G + r_.dot(at_.dvv)};
    const ParameterBox box = room();
    held_ = (g.x() > 0 && box.low.x() == 0) || (g.x() < 0 && box.high.x() == 0) ||
            (g.y() > 0 && box.low.y() == 0) || (g.y() < 0 && box.high.y() == 0);
    if (settings_.convexity_margin < std::numeric_limits<double>::infinity()) {
      if (!convex_ && smallest_eigenvalue(full, tangent) > settings_.convexity_margin) convex_ = true;
      const double descent = std::min(g.x() * box.low.x(), g.x() * box.high.x()) +
                             std::min(g.y() * box.low.y(), g.y() * box.high.y());
      if (convex_ && f_ + descent > 0.5 * settings_.give_up_above * settings_.give_up_above) {
        return FootConvergence::given_up;
      }
    }
    bool newton = settings_.method == FootMethod::newton;
    Vec2 d;
    if (newton) {
      newton = full.a > 0 && full.c > 0 && full.a * full.c - full.b * full.b > 1e-10 * full.a * full.c;
      if (newton) {
        d = minimise_in_box(full, box);
      } else if (jump(full, box)) {
        return std::nullopt;
      } else {
        // The tangent-plane step, damped by the model's largest stretch of it.
        const Vec2 whole = minimise_in_box(tangent, box);
        const double bent = whole.x() * whole.x() * full.a + 2 * whole.x() * whole.y() * full.b +
                            whole.y() * whole.y() * full.c;
        const double flat = std::pow(step_length(whole), 2);
        d = whole / std::max(1.0, flat > 0 ? bent / flat : 1.0);
      }
    } else {
      d = settings_.damping * minimise_in_box(tangent, box);
    }
    const double length = step_length(d);
    if (!std::isfinite(length)) return FootConvergence::no_number;
    if (length <= settings_.tolerance * length_) {
      if (leave_pole(E, G)) return std::nullopt;
      if (is_saddle(full, box)) {
        if (settings_.method == FootMethod::newton && leave_saddle(full, box)) return std::nullopt;
        return FootConvergence::stationary;
      }
      finish(d, length);
      return FootConvergence::converged;
    }
    const bool touches = (d.array() == box.low.array() || d.array() == box.high.array()).any();
    if (newton && !touches && length <= 1e-6 * length_ && bend(d) <= 0.1 * settings_.tolerance * length_) {
      if (leave_pole(E, G)) return std::nullopt;
      // The next correction is below the tolerance: the Taylor series gives the last point without another
      // evaluation.
      finish(d, length);
      return FootConvergence::converged;
    }
    return walk(d, g) ? std::nullopt : std::optional(FootConvergence::stalled);
  }

  /// Of H d = lambda I d.
  static double smallest_eigenvalue(const QuadraticModel& full, const QuadraticModel& tangent) {
    const double det = tangent.a * tangent.c - tangent.b * tangent.b;
    if (!(det > 1e-12 * tangent.a * tangent.c)) return -std::numeric_limits<double>::infinity();
    const double trace = full.a * tangent.c + full.c * tangent.a - 2 * full.b * tangent.b;
    const double product = (full.a * full.c - full.b * full.b) / det, half = 0.5 * trace / det;
    return half - std::sqrt(std::max(0.0, half * half - product));
  }

  /// Where the model is not convex its minimum lies on the box's border: goes there if f falls as foreseen.
  bool jump(const QuadraticModel& full, const ParameterBox& box) {
    const Vec2 d = minimise_in_box(full, box);
    const double gain = full.value(d);
    if (!(gain < 0) || !(step_length(d) > settings_.tolerance * length_)) return false;
    const Vec2 from = uv_;
    const PatchCurvature at = at_;
    const Vec3 r = r_;
    const double f = f_;
    uv_ = inside(from + d);
    evaluate();
    if (f_ < f + 0.1 * gain) return true;
    uv_ = from;
    at_ = at;
    r_ = r;
    f_ = f;
    return false;
  }

  double bend(const Vec2& d) const {
    return (at_.duu * (d.x() * d.x()) + at_.duv * (2 * d.x() * d.y()) + at_.dvv * (d.y() * d.y())).norm();
  }

  void finish(const Vec2& d, double length) {
    if (length == 0) return;
    uv_ = inside(uv_ + d);
    at_.position +=
        at_.du * d.x() + at_.dv * d.y() +
        0.5 * (at_.duu * (d.x() * d.x()) + at_.duv * (2 * d.x() * d.y()) + at_.dvv * (d.y() * d.y()));
    at_.du += at_.duu * d.x() + at_.duv * d.y();
    at_.dv += at_.duv * d.x() + at_.dvv * d.y();
  }

  /// Halves d until f falls (Armijo); a tie within rounding counts as long as the gradient still shrinks.
  bool walk(const Vec2& d, const Vec2& g) {
    const Vec2 from = uv_;
    const PatchCurvature at = at_;
    const Vec3 r = r_;
    const double f = f_, slope = g.dot(d), noise = rounding_of_f();
    for (double lambda = 1; lambda > 1e-9; lambda *= 0.5) {
      uv_ = inside(from + lambda * d);
      evaluate();
      if (f_ <= f + 1e-4 * lambda * slope) return true;
      if (f_ <= f + noise && -slope <= 1e3 * noise) return true;
    }
    uv_ = from;
    at_ = at;
    r_ = r;
    f_ = f;
    return false;
  }

  /// r carries the rounding of the position's coordinates.
  double rounding_of_f() const {
    return 8 * std::numeric_limits<double>::epsilon() * (f_ + r_.norm() * at_.position.cwiseAbs().maxCoeff());
  }

  bool is_saddle(const QuadraticModel& full, const ParameterBox& box) const {
    const bool free_u = box.low.x() < 0 && box.high.x() > 0, free_v = box.low.y() < 0 && box.high.y() > 0;
    const double small = -1e-9;
    if (free_u && full.a < small * at_.du.squaredNorm() &&
        at_.du.norm() * domain_.sizes().x() > 1e-8 * length_)
      return true;
    if (free_v && full.c < small * at_.dv.squaredNorm() &&
        at_.dv.norm() * domain_.sizes().y() > 1e-8 * length_)
      return true;
    return free_u && free_v && full.a > 0 && full.c > 0 &&
           full.a * full.c - full.b * full.b < small * full.a * full.c;
  }

  /// From a stationary point that is no minimum: along the direction of lowest curvature of f, the better
  /// way of the two, with growing steps shrunk until f falls.
  bool leave_saddle(const QuadraticModel& full, const ParameterBox& box) {
    const double su = 1 / std::max(at_.du.norm(), 1e-300), sv = 1 / std::max(at_.dv.norm(), 1e-300);
    Eigen::Matrix2d scaled;
    scaled << full.a * su * su, full.b * su * sv, full.b * su * sv, full.c * sv * sv;
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> eigen(scaled);
    Vec2 way(eigen.eigenvectors()(0, 0) * su, eigen.eigenvectors()(1, 0) * sv);
    // Along a border only its own direction is free.
    if (box.low.x() == 0 || box.high.x() == 0) way = Vec2(0, sv);
    if (box.low.y() == 0 || box.high.y() == 0) way = Vec2(su, 0);
    return best_way({way, Vec2(-way)}, box);
  }

  /// At (or within rounding of) a border that is one point in space: inward at the best of several places
  /// along it. Steps are short there whatever the angle is, so their length says nothing about convergence.
  bool leave_pole(double E, double G) {
    const Vec2 size = domain_.sizes();
    for (int axis = 0; axis < 2; ++axis) {
      const int other = 1 - axis;
      if (!(std::sqrt(axis == 0 ? E : G) * size[axis] <= 1e-7 * length_) || periodic_[other]) continue;
      const bool low = 2 * uv_[other] < domain_.min()[other] + domain_.max()[other];
      const double border = low ? domain_.min()[other] : domain_.max()[other];
      const double gap = std::abs(uv_[other] - border) * (other == 0 ? at_.du : at_.dv).norm();
      if (gap > 1e-7 * length_ || pole_visits_ == 4) continue;
      ++pole_visits_;
      constexpr int probes = 16;
      double steepest = -1e-9;
      Vec2 place = uv_;
      for (int probe = 0; probe <= probes; ++probe) {
        Vec2 uv = uv_;
        uv[other] = border;
        uv[axis] = domain_.min()[axis] + size[axis] * probe / probes;
        const PatchPoint p = patch_.first(uv);
        const Vec3 inward = (other == 0 ? p.du : p.dv) * (low ? 1 : -1), r = p.position - query_;
        const double slope = r.dot(inward) / std::max(inward.norm() * r.norm(), 1e-300);
        if (slope < steepest) {
          steepest = slope;
          place = uv;
        }
      }
      if (place == uv_) continue;
      const Vec2 from = uv_;
      const double f = f_;
      uv_ = place;
      evaluate();
      Vec2 way = Vec2::Zero();
      way[other] = (low ? 1 : -1) / std::max((other == 0 ? at_.du : at_.dv).norm(), 1e-300);
      if (best_way({way, way}, room()) && f_ < f) return true;
      uv_ = from;
      evaluate();
    }
    return false;
  }

  /// Walks from uv_ along the better of two ways (unit speed in space), first far, then ever shorter.
  bool best_way(const std::array<Vec2, 2>& ways, const ParameterBox& box) {
    const Vec2 from = uv_;
    const PatchCurvature at = at_;
    const Vec3 r = r_;
    const double f = f_;
    for (double reach = std::min(0.25 * length_, std::max(r.norm(), 1e-6 * length_));
         reach > settings_.tolerance * length_; reach *= 0.5) {
      double best = f * (1 - 4 * std::numeric_limits<double>::epsilon());
      Vec2 place = from;
      for (const Vec2& way : ways) {
        const Vec2 d = (way * reach).cwiseMax(box.low).cwiseMin(box.high);
        uv_ = inside(from + d);
        evaluate();
        if (f_ < best) {
          best = f_;
          place = uv_;
        }
      }
      if (place != from) {
        uv_ = place;
        evaluate();
        return true;
      }
    }
    uv_ = from;
    at_ = at;
    r_ = r;
    f_ = f;
    return false;
  }

  const ParametricPatch& patch_;
  Vec3 query_;
  ClosestPointSettings settings_;
  Eigen::AlignedBox2d domain_;
  std::array<bool, 2> periodic_{};
  double length_ = 0;
  Vec2 uv_ = Vec2::Zero();
  PatchCurvature at_;
  Vec3 r_ = Vec3::Zero();
  double f_ = 0;
  bool held_ = false, convex_ = false;
  int pole_visits_ = 0, evaluations_ = 0;
};

}  // namespace

PatchFoot closest_point(const ParametricPatch& patch, const Vec3& query, const Vec2& start,
                        const ClosestPointSettings& settings) {
  return Search(patch, query, settings).run(start);
}

}  // namespace flowcage
