#include "core/project/closest_point.hpp"

#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include "core/target/analytic_surfaces.hpp"
#include "tests/catch.hpp"

using namespace flowcage;

namespace {

constexpr double pi = std::numbers::pi;

/// z = a x^2 + b y^2 + c x y over [-2, 2]^2.
class Quadric final : public ParametricPatch {
 public:
  Quadric(double a, double b, double c) : a_(a), b_(b), c_(c) {}
  PatchPoint first(const Vec2& uv) const override {
    const PatchCurvature s = second(uv);
    return {s.position, s.du, s.dv};
  }
  PatchCurvature second(const Vec2& uv) const override {
    const double x = uv.x(), y = uv.y();
    return {Vec3(x, y, a_ * x * x + b_ * y * y + c_ * x * y),
            Vec3(1, 0, 2 * a_ * x + c_ * y),
            Vec3(0, 1, 2 * b_ * y + c_ * x),
            Vec3(0, 0, 2 * a_),
            Vec3(0, 0, c_),
            Vec3(0, 0, 2 * b_)};
  }
  Eigen::AlignedBox2d domain() const override { return {Vec2(-2, -2), Vec2(2, 2)}; }
  bool periodic_u() const override { return false; }
  bool periodic_v() const override { return false; }

 private:
  double a_, b_, c_;
};

/// z = 0.2 cos(4 x), several feet for one query.
class Waves final : public ParametricPatch {
 public:
  PatchPoint first(const Vec2& uv) const override {
    const PatchCurvature s = second(uv);
    return {s.position, s.du, s.dv};
  }
  PatchCurvature second(const Vec2& uv) const override {
    const double x = uv.x();
    return {Vec3(x, uv.y(), 0.2 * std::cos(4 * x)),
            Vec3(1, 0, -0.8 * std::sin(4 * x)),
            Vec3::UnitY(),
            Vec3(0, 0, -3.2 * std::cos(4 * x)),
            Vec3::Zero(),
            Vec3::Zero()};
  }
  Eigen::AlignedBox2d domain() const override { return {Vec2(-3, -1), Vec2(3, 1)}; }
  bool periodic_u() const override { return false; }
  bool periodic_v() const override { return false; }
};

std::vector<Vec3> random_points(int count, double reach) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> coordinate(-reach, reach);
  std::vector<Vec3> points;
  for (int i = 0; i < count; ++i) {
    const double x = coordinate(random), y = coordinate(random), z = coordinate(random);
    points.emplace_back(x, y, z);
  }
  return points;
}

/// Distance of the iterate from the foot after 0, 1, 2 ... iterations.
std::vector<double> errors(const ParametricPatch& patch, const Vec3& query, const Vec2& start,
                           const Vec3& foot, ClosestPointSettings settings) {
  std::vector<double> result;
  settings.tolerance = 1e-16;  // no early end
  for (int iterations = 0; iterations < 40; ++iterations) {
    settings.max_iterations = iterations;
    result.push_back((closest_point(patch, query, start, settings).point.position - foot).norm());
  }
  return result;
}

double tangential_residual(const PatchFoot& foot, const Vec3& query) {
  const Vec3 n = foot.point.du.cross(foot.point.dv).normalized();
  const Vec3 r = foot.point.position - query;
  return (r - r.dot(n) * n).norm();
}

}  // namespace

TEST_CASE("both methods reach the known foot on sphere, torus and cylinder") {
  struct Case {
    std::unique_ptr<AnalyticSurface> surface;
    Index face;
  };
  std::vector<Case> cases;
  cases.push_back({sphere_surface(Vec3(0.1, 0.2, 0.3), 1), 0});
  cases.push_back({torus_surface({Vec3::Zero(), Vec3(2, 1, 2) / 3, 1, 0.3}), 0});
  cases.push_back({cylinder_surface({Vec3(0, 0, -1), Vec3::UnitZ(), 0.8, 2}), 1});
  int compared = 0;
  for (const Case& c : cases) {
    const ParametricPatch& patch = c.surface->patch(c.face);
    for (const Vec3& query : random_points(300, 2)) {
      SurfacePoint exact;
      c.surface->closest_points({&query, 1}, {}, {&exact, 1});
      if (exact.face != c.face) continue;
      for (const FootMethod method : {FootMethod::newton, FootMethod::tangent_plane}) {
        ClosestPointSettings settings;
        settings.method = method;
        settings.max_iterations = 500;
        const Vec2 start = exact.uv + Vec2(0.2, -0.15);
        const PatchFoot foot = closest_point(patch, query, start, settings);
        if (method == FootMethod::newton) REQUIRE(foot.convergence == FootConvergence::converged);
        // The paper's step is slow near a centre of curvature, where its rate goes to one.
        if (foot.convergence == FootConvergence::iteration_limit) continue;
        ++compared;
        const double slack = method == FootMethod::newton ? 1e-11 : 1e-9;
        CHECK((foot.point.position - exact.position).norm() < slack);
        CHECK(foot.distance == Approx(exact.distance).margin(1e-12));
      }
    }
  }
  CHECK(compared > 1000);
}

TEST_CASE("Newton converges quadratically, the tangent-plane step linearly at the predicted rate") {
  const auto sphere = sphere_surface(Vec3::Zero(), 1);
  const ParametricPatch& patch = sphere->patch(0);
  for (const double radius : {1.5, 0.7}) {
    const Vec3 n = Vec3(1, 1, 0.4).normalized();
    const Vec2 start(pi / 4 + 0.1, 0.3);
    ClosestPointSettings settings;
    const auto newton = errors(patch, radius * n, start, n, settings);
    bool quadratic = false;
    for (std::size_t k = 1; k + 1 < newton.size(); ++k) {
      if (newton[k] < 1e-7 || newton[k] > 0.2) continue;
      INFO("iteration " << k << ": " << newton[k] << " then " << newton[k + 1]);
      CHECK(newton[k + 1] <= 2 * newton[k] * newton[k] + 1e-15);
      quadratic = true;
    }
    CHECK(quadratic);
    settings.method = FootMethod::tangent_plane;
    for (const double lambda : {1.0, 0.5}) {
      settings.damping = lambda;
      const auto plane = errors(patch, radius * n, start, n, settings);
      // H = 1 - d k relative to the first fundamental form: here the query's own radius.
      const double rate = std::abs(1 - lambda * radius);
      int counted = 0;
      for (std::size_t k = 3; k + 1 < plane.size(); ++k) {
        if (plane[k] < 1e-6 || plane[k] > 1e-2) continue;
        CHECK(plane[k + 1] / plane[k] == Approx(rate).epsilon(0.03));
        ++counted;
      }
      CHECK(counted >= 3);
    }
  }
}

TEST_CASE("few iterations from near starts, and the stated precision") {
  const auto torus = torus_surface({Vec3::Zero(), Vec3::UnitZ(), 1, 0.3});
  const ParametricPatch& patch = torus->patch(0);
  int iterations = 0, count = 0;
  for (const Vec3& query : random_points(500, 1.5)) {
    SurfacePoint exact;
    torus->closest_points({&query, 1}, {}, {&exact, 1});
    const PatchFoot foot = closest_point(patch, query, exact.uv + Vec2(0.02, 0.03));
    if (std::hypot(query.x(), query.y()) < 0.2) continue;  // near the axis, where every longitude is as good
    const Vec3 middle = Vec3(query.x(), query.y(), 0).normalized();
    if ((query - middle).norm() < 0.05) continue;  // near the tube's centre circle
    REQUIRE(foot.convergence == FootConvergence::converged);
    CHECK(tangential_residual(foot, query) < 1e-12 * 8);
    CHECK((foot.point.position - exact.position).norm() < 1e-11);
    iterations += foot.iterations;
    ++count;
  }
  CHECK(static_cast<double>(iterations) / count < 3.5);
}

TEST_CASE("poles: from any longitude, over the pole and onto it") {
  const auto sphere = sphere_surface(Vec3::Zero(), 1);
  const ParametricPatch& patch = sphere->patch(0);
  for (const double radius : {0.4, 1.0, 3.0}) {
    for (const double tilt : {0.0, 1e-9, 1e-4, 0.05, 0.4}) {
      for (const double side : {-1.0, 1.0}) {
        const Vec3 n(std::sin(tilt), 0, side * std::cos(tilt));
        for (double u = 0; u < 6.2; u += 0.7) {
          for (const double v : {0.2, 1.2, 1.5, pi / 2}) {
            INFO("radius " << radius << " tilt " << tilt << " start " << u << ' ' << v);
            const PatchFoot foot = closest_point(patch, radius * n, Vec2(u, side * v));
            CHECK((foot.point.position - n).norm() < 1e-8);
            CHECK(foot.distance == Approx(std::abs(radius - 1)).margin(1e-11));
            CHECK(foot.uv.y() <= pi / 2);
          }
        }
      }
    }
  }
}

TEST_CASE("a start on a maximum or saddle of the distance is left") {
  const auto sphere = sphere_surface(Vec3::Zero(), 1);
  const PatchFoot opposite = closest_point(sphere->patch(0), Vec3(2, 0, 0), Vec2(pi, 0));
  CHECK(opposite.convergence == FootConvergence::converged);
  CHECK((opposite.point.position - Vec3(1, 0, 0)).norm() < 1e-11);
  // Over a bowl's centre of curvature: the middle of the valley is a saddle of the distance.
  const Quadric bowl(1, 0.1, 0);
  const Vec3 query(0, 0, 1.5);
  const PatchFoot foot = closest_point(bowl, query, Vec2(0, 0));
  CHECK(foot.convergence == FootConvergence::converged);
  // d/dx of x^2 + (x^2 - 1.5)^2: x = +-1
  CHECK(std::abs(std::abs(foot.uv.x()) - 1) < 1e-10);
  CHECK(std::abs(foot.uv.y()) < 1e-10);
  ClosestPointSettings paper;
  paper.method = FootMethod::tangent_plane;
  CHECK(closest_point(bowl, query, Vec2(0, 0), paper).convergence == FootConvergence::stationary);
  const Quadric saddle(0.5, -0.5, 0.3);
  for (const Vec3& q : random_points(100, 1)) {
    const PatchFoot f = closest_point(saddle, q, q.head<2>());
    CHECK(f.convergence == FootConvergence::converged);
    if (!f.at_border) CHECK(tangential_residual(f, q) < 1e-11);
  }
}

TEST_CASE("far queries converge, and the distance never grows on the way") {
  const Quadric dome(-0.3, -0.2, 0.1);
  for (const Vec3& direction : random_points(100, 1)) {
    const Vec3 query = 1e4 * direction.normalized();
    ClosestPointSettings settings;
    double last = std::numeric_limits<double>::infinity();
    for (int iterations = 0; iterations < 60; ++iterations) {
      settings.max_iterations = iterations;
      const PatchFoot foot = closest_point(dome, query, Vec2(0.3, -0.4), settings);
      CHECK(foot.distance <= last * (1 + 1e-14));
      last = foot.distance;
    }
    const PatchFoot foot = closest_point(dome, query, Vec2(0.3, -0.4));
    CHECK(foot.convergence == FootConvergence::converged);
    if (!foot.at_border) CHECK(tangential_residual(foot, query) < 1e-7);
  }
}

TEST_CASE("several local minima: the best of several starts beats a dense search") {
  const Waves waves;
  for (const Vec3& q : random_points(60, 2)) {
    double best = std::numeric_limits<double>::infinity();
    for (double u = -2.8; u < 3; u += 0.4) {
      best = std::min(best, closest_point(waves, q, Vec2(u, 0)).distance);
    }
    double dense = std::numeric_limits<double>::infinity();
    for (double u = -3; u <= 3; u += 1e-3) {
      dense = std::min(dense, (waves.first(Vec2(u, std::clamp(q.y(), -1.0, 1.0))).position - q).norm());
    }
    CHECK(best <= dense + 1e-12);
    CHECK(best >= dense - 1e-3);
  }
}

TEST_CASE("the domain's border: active sets on sides and corners") {
  const Quadric bowl(0.1, 0.2, 0);
  const PatchFoot side = closest_point(bowl, Vec3(5, 0.5, 0), Vec2(0, 0));
  CHECK(side.at_border);
  CHECK(side.uv.x() == 2);
  CHECK(std::abs((side.point.position - Vec3(5, 0.5, 0)).dot(side.point.dv)) < 1e-10);
  const PatchFoot corner = closest_point(bowl, Vec3(5, 6, 0), Vec2(-1, -1));
  CHECK(corner.at_border);
  CHECK(corner.uv == Vec2(2, 2));
}

TEST_CASE("periodic parameters wrap") {
  const auto torus = torus_surface({Vec3::Zero(), Vec3::UnitZ(), 1, 0.3});
  const Vec3 query = 1.2 * Vec3(std::cos(-0.1), std::sin(-0.1), 0.05);
  const PatchFoot foot = closest_point(torus->patch(0), query, Vec2(0.15, 6.2));
  SurfacePoint exact;
  torus->closest_points({&query, 1}, {}, {&exact, 1});
  CHECK((foot.point.position - exact.position).norm() < 1e-11);
  CHECK((foot.uv - exact.uv).norm() < 1e-10);
  CHECK_FALSE(foot.at_border);
}

TEST_CASE("what is no number is reported as such") {
  const Quadric bowl(1, 1, 0);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  CHECK(closest_point(bowl, Vec3(nan, 0, 0), Vec2(0, 0)).convergence == FootConvergence::no_number);
  CHECK(closest_point(bowl, Vec3(0, 0, 0), Vec2(nan, 0)).convergence == FootConvergence::no_number);
  CHECK(closest_point(bowl, Vec3(1e200, 0, 0), Vec2(0, 0)).convergence == FootConvergence::no_number);
}
