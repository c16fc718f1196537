#include "core/target/bspline_patch.hpp"

#include <cmath>
#include <numbers>
#include <random>

#include "tests/catch.hpp"

using namespace flowcage;

namespace {

/// Random poles and weights; knots clamped, one of them repeated.
std::shared_ptr<BSplineSurface> random_surface(int p, int q, bool rational) {
  std::mt19937 random(17);
  std::uniform_real_distribution<double> unit(0, 1);
  auto s = std::make_shared<BSplineSurface>();
  s->degree_u = p;
  s->degree_v = q;
  const auto knots = [](int degree) {
    std::vector<double> k(static_cast<std::size_t>(degree) + 1, 0.0);
    for (const double t : {0.2, 0.5, 0.5, 0.9}) {
      if (degree > 2 || t != 0.5 || k.back() != 0.5) k.push_back(t);
    }
    k.insert(k.end(), static_cast<std::size_t>(degree) + 1, 1.0);
    return k;
  };
  s->knots_u = knots(p);
  s->knots_v = knots(q);
  for (int i = 0; i < s->count_u(); ++i) {
    for (int j = 0; j < s->count_v(); ++j) {
      const double a = unit(random), b = unit(random), c = unit(random);
      s->poles.emplace_back(i + 0.3 * a, j + 0.3 * b, c);
      if (rational) s->weights.push_back(0.5 + unit(random));
    }
  }
  return s;
}

const Eigen::AlignedBox2d unit_square(Vec2(0, 0), Vec2(1, 1));

}  // namespace

TEST_CASE("derivatives are the differences, for degrees 1 to 22, rational or not") {
  for (const bool rational : {false, true}) {
    for (const auto& [p, q] : {std::pair{1, 1}, {1, 3}, {2, 2}, {3, 3}, {5, 4}, {22, 3}}) {
      INFO("degrees " << p << ' ' << q << " rational " << rational);
      const BSplinePatch patch(random_surface(p, q, rational), unit_square);
      const double h = 1e-5;
      for (const Vec2& uv : {Vec2(0.1, 0.7), Vec2(0.35, 0.05), Vec2(0.95, 0.6)}) {
        const PatchCurvature c = patch.second(uv);
        const auto u1 = patch.first(uv + Vec2(h, 0)), u0 = patch.first(uv - Vec2(h, 0));
        const auto v1 = patch.first(uv + Vec2(0, h)), v0 = patch.first(uv - Vec2(0, h));
        const auto near = [](const Vec3& a, const Vec3& b) { return (a - b).norm() < 1e-5 * (1 + a.norm()); };
        CHECK(near(c.du, (u1.position - u0.position) / (2 * h)));
        CHECK(near(c.dv, (v1.position - v0.position) / (2 * h)));
        CHECK(near(c.duu, (u1.du - u0.du) / (2 * h)));
        CHECK(near(c.duv, (v1.du - v0.du) / (2 * h)));
        CHECK(near(c.dvv, (v1.dv - v0.dv) / (2 * h)));
      }
    }
  }
}

TEST_CASE("a rational quadratic is an exact cylinder; a plane's poles give the plane") {
  auto s = std::make_shared<BSplineSurface>();
  s->degree_u = 2;
  s->degree_v = 1;
  s->knots_u = {0, 0, 0, 1, 1, 1};
  s->knots_v = {0, 0, 3, 3};
  for (const Vec2& p : {Vec2(1, 0), Vec2(1, 1), Vec2(0, 1)}) {
    for (const double z : {0.0, 2.0}) {
      s->poles.emplace_back(p.x(), p.y(), z);
      s->weights.push_back(p == Vec2(1, 1) ? std::numbers::sqrt2 / 2 : 1.0);
    }
  }
  const BSplinePatch patch(s, {Vec2(0, 0), Vec2(1, 3)});
  for (double u = 0; u <= 1; u += 0.125) {
    const PatchCurvature c = patch.second({u, 1.2});
    CHECK(std::abs(c.position.head<2>().norm() - 1) < 1e-15);
    CHECK(c.position.z() == Approx(0.8));
    CHECK(std::abs(c.du.dot(Vec3(c.position.x(), c.position.y(), 0))) < 1e-14);
    // Normal curvature -1 along the circle.
    CHECK(-c.duu.dot(Vec3(c.position.x(), c.position.y(), 0)) == Approx(c.du.squaredNorm()));
  }
}

TEST_CASE("a grid of positions is that of single ones") {
  for (const bool rational : {false, true}) {
    const BSplinePatch patch(random_surface(5, 2, rational), unit_square);
    const std::vector<double> u{0, 0.31, 0.5, 1}, v{1, 0.2, 0.77};
    std::vector<Vec3> grid(u.size() * v.size());
    patch.positions(u, v, grid);
    for (std::size_t k = 0; k < grid.size(); ++k) {
      CHECK((grid[k] - patch.first({u[k % 4], v[k / 4]}).position).norm() < 1e-14);
    }
  }
}

TEST_CASE("a window evaluates knots from its own side") {
  auto s = std::make_shared<BSplineSurface>();
  s->degree_u = s->degree_v = 1;
  s->knots_u = {0, 0, 1, 2, 2};
  s->knots_v = {0, 0, 1, 1};
  for (const Vec2& xz : {Vec2(0, 0), Vec2(1, 0), Vec2(1, 1)}) {
    for (const double y : {0.0, 1.0}) s->poles.emplace_back(xz.x(), y, xz.y());
  }
  const BSplinePatch left(s, {Vec2(0, 0), Vec2(1, 1)}), right(s, {Vec2(1, 0), Vec2(2, 1)});
  CHECK((left.first({1, 0.5}).du - Vec3::UnitX()).norm() < 1e-15);
  CHECK((right.first({1, 0.5}).du - Vec3::UnitZ()).norm() < 1e-15);
  CHECK((left.first({1, 0.5}).position - right.first({1, 0.5}).position).norm() < 1e-15);
  CHECK(left.breaks(0) == std::vector<double>{0, 1});
}

TEST_CASE("the Bezier form of a box, and what is halved out of it, is the surface") {
  for (const bool rational : {false, true}) {
    for (const auto& [p, q] : {std::pair{1, 3}, {3, 3}, {5, 2}, {22, 3}}) {
      INFO("degrees " << p << ' ' << q << " rational " << rational);
      const BSplinePatch patch(random_surface(p, q, rational), unit_square);
      const Eigen::AlignedBox2d box(Vec2(0.24, 0.52), Vec2(0.44, 0.84));
      const BezierNet upper = halves(*patch.bezier(box), 0)[1], part = halves(upper, 1)[0];
      const Eigen::AlignedBox2d of_part(Vec2(0.34, 0.52), Vec2(0.44, 0.68));
      const auto samples = nine_samples(part);
      for (int k = 0; k < 9; ++k) {
        const Vec2 size = of_part.sizes(), fraction = 0.5 * Vec2(k / 3, k % 3);
        const PatchCurvature c = patch.second(of_part.min() + fraction.cwiseProduct(size));
        const auto near = [&](const Vec3& a, const Vec3& b) {
          return (a - b).norm() < 1e-11 * (1 + b.norm());
        };
        CHECK(near(samples[k].position, c.position));
        CHECK(near(samples[k].du, size.x() * c.du));
        CHECK(near(samples[k].dv, size.y() * c.dv));
        CHECK(near(samples[k].duu, size.x() * size.x() * c.duu));
        CHECK(near(samples[k].duv, size.x() * size.y() * c.duv));
        CHECK(near(samples[k].dvv, size.y() * size.y() * c.dvv));
      }
      CHECK((part.point(p, 0) - samples[6].position).norm() < 1e-12);
      CHECK((middle_of(part).duv - samples[4].duv).norm() == 0);
      CHECK(bend(part).sum() < 0.5 * bend(upper).sum());
    }
  }
}

TEST_CASE("the deviation bounds the distance from the corners' hull, and falls with the square of the box") {
  for (const bool rational : {false, true}) {
    const BSplinePatch patch(random_surface(3, 3, rational), unit_square);
    double last = 0;
    for (const double size : {0.16, 0.04, 0.01, 0.005}) {
      const Eigen::AlignedBox2d box(Vec2(0.22, 0.55), Vec2(0.22 + size, 0.55 + size));
      const double bound = patch.deviation(box).sum();
      const Vec3 p00 = patch.first(box.min()).position, p11 = patch.first(box.max()).position;
      const Vec3 p10 = patch.first({box.max().x(), box.min().y()}).position;
      const Vec3 p01 = patch.first({box.min().x(), box.max().y()}).position;
      double farthest = 0;  // from the bilinear patch, at the best of many of its parameters
      for (double a = 0; a <= 1; a += 0.125) {
        for (double b = 0; b <= 1; b += 0.125) {
          const Vec3 p = patch.first(box.min() + size * Vec2(a, b)).position;
          double nearest = 1e300;
          for (double x = 0; x <= 1; x += 0.02) {
            for (double y = 0; y <= 1; y += 0.02) {
              const Vec3 q = (1 - x) * ((1 - y) * p00 + y * p01) + x * ((1 - y) * p10 + y * p11);
              nearest = std::min(nearest, (q - p).norm());
            }
          }
          farthest = std::max(farthest, nearest);
        }
      }
      CHECK(farthest <= bound + 0.03 * (p11 - p00).norm());
      CHECK(bound < 0.5 * (p11 - p00).norm());
      if (size < 0.007) CHECK(last / bound == Approx(4).epsilon(0.15));  // in the limit of small boxes
      last = bound;
    }
  }
}
