#include "core/project/cell_foot.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/project/quadratic_model.hpp"

namespace flowcage {
namespace {

constexpr double least_eigenvalue = 0.05;

/// Half the squared distance at a point of the cell.
struct Here {
  PatchCurvature at;
  Vec3 r;
  QuadraticModel flat, full;  // Hessians I and H = I + r . S''

  Here(const CellPolynomial& cell, const Vec3& query, const Vec2& st)
      : at(evaluate(cell, st)),
        r(at.position - query),
        flat{Vec2(r.dot(at.du), r.dot(at.dv)), at.du.squaredNorm(), at.du.dot(at.dv), at.dv.squaredNorm()},
        full{flat.g, flat.a + r.dot(at.duu), flat.b + r.dot(at.duv), flat.c + r.dot(at.dvv)} {}
};

enum class Shape : std::uint8_t { convex, concave, undecided };

/// All eigenvalues of H relative to I above lambda, or one of them below -lambda.
Shape shape_of(const QuadraticModel& full, const QuadraticModel& flat, double lambda) {
  const double a = full.a - lambda * flat.a, b = full.b - lambda * flat.b, c = full.c - lambda * flat.c;
  if (a > 0 && c > 0 && a * c > b * b) return Shape::convex;
  const double p = full.a + lambda * flat.a, q = full.b + lambda * flat.b, s = full.c + lambda * flat.c;
  return p < 0 || s < 0 || p * s < q * q ? Shape::concave : Shape::undecided;
}

/// From H at the four corners: over a cell that is nearly flat it is nearly bilinear, and a mean of positive
/// definite matrices is positive definite (as is w . H w < 0 at all corners so at their means). What the
/// middle's H differs from the corners' mean is left as a margin, twice.
Shape shape_from_corners(const CellPolynomial& cell, const Vec3& query) {
  const Here middle(cell, query, Vec2(0, 0));
  std::array<QuadraticModel, 4> corners;
  double a = 0, b = 0, c = 0;
  for (int k = 0; k < 4; ++k) {
    corners[k] = Here(cell, query, Vec2(k % 2 == 0 ? -1 : 1, k / 2 == 0 ? -1 : 1)).full;
    a += 0.25 * corners[k].a;
    b += 0.25 * corners[k].b;
    c += 0.25 * corners[k].c;
  }
  a = 2 * std::abs(a - middle.full.a) + least_eigenvalue * middle.flat.a;
  b = 2 * std::abs(b - middle.full.b);
  c = 2 * std::abs(c - middle.full.c) + least_eigenvalue * middle.flat.c;
  // The norm of (a b; b c) in the metric I is at most `away`, for directions that are not nearly parallel.
  const double cosine2 = middle.flat.b * middle.flat.b / (middle.flat.a * middle.flat.c);
  if (!(cosine2 < 0.99)) return Shape::undecided;
  const double away =
      (std::max(a / middle.flat.a, c / middle.flat.c) + b / std::sqrt(middle.flat.a * middle.flat.c)) /
      (1 - std::sqrt(cosine2));
  if (std::all_of(corners.begin(), corners.end(), [&](const QuadraticModel& corner) {
        return shape_of(corner, middle.flat, away) == Shape::convex;
      })) {
    return Shape::convex;
  }
  // The middle's direction of least curvature, by the rotation that diagonalises H in the scaled parameters.
  const double su = 1 / std::sqrt(middle.flat.a), sv = 1 / std::sqrt(middle.flat.c);
  const double angle =
      0.5 * std::atan2(2 * middle.full.b * su * sv, middle.full.a * su * su - middle.full.c * sv * sv);
  const Vec2 w(-std::sin(angle) * su, std::cos(angle) * sv);
  const auto along = [&](const QuadraticModel& m) {
    return m.a * w.x() * w.x() + 2 * m.b * w.x() * w.y() + m.c * w.y() * w.y();
  };
  const double length2 = along(middle.flat);
  const bool falls = std::all_of(corners.begin(), corners.end(), [&](const QuadraticModel& corner) {
    return along(corner) < -away * length2;
  });
  return falls ? Shape::concave : Shape::undecided;
}

}  // namespace

CellFoot cell_foot(const CellPolynomial& cell, const Vec3& query, const Vec2& start,
                   const CellFootSettings& settings) {
  constexpr int max_iterations = 8;
  constexpr double rounding = 1e-15;
  CellFoot foot;
  foot.st = start.cwiseMax(-1.0).cwiseMin(1.0);
  const double give_up = 0.5 * settings.give_up_above * settings.give_up_above;
  const double least_step = settings.tolerance * settings.length;
  bool convex = false;
  double last = 0;
  for (int iteration = 0; iteration < max_iterations; ++iteration) {
    const Here here(cell, query, foot.st);
    ++foot.evaluations;
    const PatchCurvature& at = here.at;
    const double f = 0.5 * here.r.squaredNorm();
    if (!convex) {
      Shape shape = shape_of(here.full, here.flat, least_eigenvalue + settings.eigenvalue_change);
      if (shape == Shape::undecided && std::isfinite(settings.eigenvalue_change)) {
        shape = shape_from_corners(cell, query);
        foot.evaluations += 5;
      }
      convex = shape == Shape::convex;
      if (!convex) {
        foot.end = shape == Shape::concave ? CellFootEnd::concave : CellFootEnd::undecided;
        return foot;
      }
    } else if (f > last * (1 + 1e-9) + rounding * here.r.norm() * at.position.cwiseAbs().maxCoeff()) {
      return foot;  // a step that overshot
    }
    last = f;
    const Vec2& g = here.flat.g;
    const ParameterBox room{-Vec2::Ones() - foot.st, Vec2::Ones() - foot.st};
    const double descent = std::min(g.x() * room.low.x(), g.x() * room.high.x()) +
                           std::min(g.y() * room.low.y(), g.y() * room.high.y());
    if (f + descent > give_up) {
      foot.end = CellFootEnd::given_up;
      return foot;
    }
    const Vec2 d = minimise_in_box(here.full, room);
    const double length = (at.du * d.x() + at.dv * d.y()).norm();
    const Vec3 bend = at.duu * (d.x() * d.x()) + at.duv * (2 * d.x() * d.y()) + at.dvv * (d.y() * d.y());
    // As in closest_point: the Taylor series gives the last point where the next correction is below the
    // tolerance.
    if (length <= least_step || (length <= 1e-6 * settings.length && bend.norm() <= 0.1 * least_step)) {
      foot.st = (foot.st + d).cwiseMax(-1.0).cwiseMin(1.0);
      foot.point = {at.position + at.du * d.x() + at.dv * d.y() + 0.5 * bend,
                    at.du + at.duu * d.x() + at.duv * d.y(), at.dv + at.duv * d.x() + at.dvv * d.y()};
      foot.distance = (foot.point.position - query).norm();
      foot.end = CellFootEnd::found;
      return foot;
    }
    if (!std::isfinite(length)) return foot;
    foot.st = (foot.st + d).cwiseMax(-1.0).cwiseMin(1.0);
  }
  return foot;
}

}  // namespace flowcage
