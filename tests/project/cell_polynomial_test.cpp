#include "core/project/cell_polynomial.hpp"

#include <cmath>

#include "core/project/cell_foot.hpp"
#include "core/project/closest_point.hpp"
#include "core/target/analytic_surfaces.hpp"
#include "core/target/bspline_patch.hpp"
#include "tests/catch.hpp"

using namespace flowcage;

namespace {

/// The box of a patch as the interpolation sees it.
GridSampler sampler(const ParametricPatch& patch, const Eigen::AlignedBox2d& box) {
  return [&patch, box](std::span<const double> s, std::span<const double> t, std::span<Vec3> points) {
    for (std::size_t j = 0; j < t.size(); ++j) {
      for (std::size_t i = 0; i < s.size(); ++i) {
        const Vec2 fraction(0.5 * (1 + s[i]), 0.5 * (1 + t[j]));
        points[j * s.size() + i] = patch.first(box.min() + fraction.cwiseProduct(box.sizes())).position;
      }
    }
  };
}

CellPolynomial view(const CellPolynomials::Fitted& fitted) {
  return {fitted.degree_s, fitted.degree_t, fitted.coefficients.data()};
}

/// A bicubic surface with a middle knot along u.
BSplinePatch bicubic() {
  auto surface = std::make_shared<BSplineSurface>();
  surface->degree_u = surface->degree_v = 3;
  surface->knots_u = {0, 0, 0, 0, 0.5, 1, 1, 1, 1};
  surface->knots_v = {0, 0, 0, 0, 1, 1, 1, 1};
  for (int i = 0; i < 5; ++i) {
    for (int j = 0; j < 4; ++j) surface->poles.emplace_back(i + 0.1 * j, j, std::sin(1.3 * i) * std::cos(j));
  }
  return {surface, {Vec2(0, 0), Vec2(1, 1)}};
}

}  // namespace

TEST_CASE("a cell polynomial has the surface's degree, its points and its derivatives") {
  const BSplinePatch patch = bicubic();
  const Eigen::AlignedBox2d box(Vec2(0.5, 0.25), Vec2(0.75, 0.5));
  const auto fitted = fit_cell_polynomial(sampler(patch, box), CellKind::surface, 1e-14);
  CHECK(fitted.degree_s == 3);
  CHECK(fitted.degree_t == 3);
  for (const Vec2& st : {Vec2(-1, -1), Vec2(0.3, -0.7), Vec2(1, 1)}) {
    const PatchCurvature at = evaluate(view(fitted), st);
    const PatchCurvature exact =
        patch.second(box.center() + 0.5 * st.cwiseProduct(box.sizes()) * (1 - 1e-15));
    CHECK((at.position - exact.position).norm() < 1e-14);
    CHECK((at.du - 0.125 * exact.du).norm() < 1e-13);
    CHECK((at.dv - 0.125 * exact.dv).norm() < 1e-13);
    CHECK((at.duu - 0.125 * 0.125 * exact.duu).norm() < 1e-12);
    CHECK((at.duv - 0.125 * 0.125 * exact.duv).norm() < 1e-12);
    CHECK((at.dvv - 0.125 * 0.125 * exact.dvv).norm() < 1e-12);
  }
}

TEST_CASE("a cell of a sphere is a polynomial to rounding; a kink is none") {
  const auto sphere = sphere_surface(Vec3::Zero(), 1);
  const Eigen::AlignedBox2d box(Vec2(0.2, 0.3), Vec2(0.4, 0.45));
  const auto fitted = fit_cell_polynomial(sampler(sphere->patch(0), box), CellKind::surface, 1e-14);
  REQUIRE(fitted.degree_s >= 5);
  for (const Vec2& st : {Vec2(-0.9, 0.1), Vec2(0.3, -0.7), Vec2(0.8, 0.95)}) {
    CHECK(std::abs(evaluate(view(fitted), st).position.norm() - 1) < 2e-14);
  }
  const GridSampler kink = [](std::span<const double> s, std::span<const double> t, std::span<Vec3> points) {
    for (std::size_t k = 0; k < points.size(); ++k) {
      points[k] = Vec3(s[k % s.size()], t[k / s.size()], std::abs(s[k % s.size()] - 0.3));
    }
  };
  CHECK(view(fit_cell_polynomial(kink, CellKind::surface, 1e-14)).empty());
  CHECK(view(fit_cell_polynomial(kink, CellKind::curve, 1e-14)).empty());
}

TEST_CASE("the foot on a cell: interior, side and corner; given up; concave where no minimum can be") {
  // The dish z = (x^2 + y^2) / 2 over [-0.1, 0.1]^2, by s = 10 x, t = 10 y: radius of curvature 1.
  const std::vector<double> dish{0, 0, 0, 0.1, 0, 0, 0,     0, 0.005, 0, 0.1, 0, 0, 0,
                                 0, 0, 0, 0,   0, 0, 0.005, 0, 0,     0, 0,   0, 0};
  const CellPolynomial cell{2, 2, dish.data()};
  CellFootSettings settings;
  settings.give_up_above = 10;
  settings.eigenvalue_change = 0.02;
  const auto foot_of = [&](const Vec3& query) { return cell_foot(cell, query, Vec2(0.2, -0.3), settings); };

  // From (0.05, 0.02, h) along the normal (-x, -y, 1).
  const Vec3 on(0.05, 0.02, 0.5 * (0.0025 + 0.0004));
  const Vec3 normal = Vec3(-0.05, -0.02, 1).normalized();
  for (const double height : {-2.0, -1e-3, 0.0, 0.3}) {
    const CellFoot foot = foot_of(on + height * normal);
    REQUIRE(foot.end == CellFootEnd::found);
    CHECK((foot.point.position - on).norm() < 1e-12);
    CHECK((foot.st - Vec2(0.5, 0.2)).norm() < 1e-11);
    CHECK(foot.distance == Approx(std::abs(height)).margin(1e-12));
    CHECK(foot.evaluations <= 5);
  }
  const CellFoot side = foot_of(Vec3(0.5, 0, -0.1));
  REQUIRE(side.end == CellFootEnd::found);
  CHECK((side.st - Vec2(1, 0)).norm() < 1e-11);
  const CellFoot corner = foot_of(Vec3(0.5, -0.6, -0.1));
  REQUIRE(corner.end == CellFootEnd::found);
  CHECK(corner.st == Vec2(1, -1));

  // Above the centre of curvature the distance has a maximum inside, and nothing else.
  CHECK(foot_of(Vec3(0, 0, 2)).end == CellFootEnd::concave);
  CHECK(foot_of(Vec3(0.01, 0, 1)).end == CellFootEnd::undecided);
  settings.give_up_above = 0.25;
  CHECK(foot_of(on + 0.3 * normal).end == CellFootEnd::given_up);
}

TEST_CASE("close to a surface far from the origin, rounding costs no evaluations") {
  auto surface = std::make_shared<BSplineSurface>();
  surface->degree_u = surface->degree_v = 2;
  surface->knots_u = surface->knots_v = {0, 0, 0, 1, 1, 1};
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) surface->poles.emplace_back(50 + i, 70 + j, 90 + 0.3 * i * j + 0.2 * i * i);
  }
  const BSplinePatch patch(surface, {Vec2(0, 0), Vec2(1, 1)});
  ClosestPointSettings settings;
  settings.length = 3;
  int most = 0;
  for (int k = 0; k < 200; ++k) {
    const Vec2 uv(0.1 + 0.8 * std::fmod(0.618 * k, 1), 0.1 + 0.8 * std::fmod(0.414 * k, 1));
    const Vec3 query = patch.first(uv).position + 1e-4 * Vec3(std::sin(k), std::cos(k), std::sin(2.0 * k));
    const PatchFoot foot = closest_point(patch, query, Vec2(0.5, 0.5), settings);
    CHECK(foot.convergence == FootConvergence::converged);
    most = std::max(most, foot.evaluations);
  }
  CHECK(most <= 12);
}
