#include "core/project/winding_number.hpp"

#include <cmath>
#include <cstdio>
#include <ctime>
#include <limits>
#include <map>
#include <numbers>
#include <random>

#include "core/base/parallel.hpp"
#include "core/target/analytic_surfaces.hpp"
#include "tests/catch.hpp"

using namespace flowcage;

namespace {

constexpr double exact = std::numeric_limits<double>::infinity();

WindingTree tree_of(const Tessellation& mesh) {
  return build_winding_tree(mesh.points, mesh.triangles);
}

Tessellation both(Tessellation a, const Tessellation& b) {
  const auto shift = static_cast<Index>(a.points.size());
  a.points.insert(a.points.end(), b.points.begin(), b.points.end());
  for (auto t : b.triangles) a.triangles.push_back({t[0] + shift, t[1] + shift, t[2] + shift});
  return a;
}

std::vector<Vec3> random_points(int count, double size) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> unit(-size, size);
  std::vector<Vec3> points;
  for (int i = 0; i < count; ++i) {
    const double x = unit(random), y = unit(random), z = unit(random);
    points.emplace_back(x, y, z);
  }
  return points;
}

}  // namespace

TEST_CASE("one face of a cube seen from its centre is a sixth of the whole angle, a far triangle its area") {
  const Vec3 a(1, -1, -1), b(1, 1, -1), c(1, 1, 1), d(1, -1, 1);
  CHECK(solid_angle(a, b, c) + solid_angle(a, c, d) == Approx(4 * std::numbers::pi / 6).epsilon(1e-14));
  CHECK(solid_angle(a, c, b) == Approx(-solid_angle(a, b, c)).epsilon(1e-14));
  const Vec3 far(1e4, 0, 0);  // area 2, seen face on
  CHECK(solid_angle(a + far, b + far, c + far) == Approx(2e-8).epsilon(1e-3));
}

TEST_CASE("closed bodies: 1 inside, 0 outside, 2 where two of them overlap") {
  const Tessellation mesh = both(sphere_surface({0, 0, 0}, 1)->tessellation(),
                                 box_surface({Vec3(0, -0.4, -0.4), Vec3(3, 0.4, 0.4)})->tessellation());
  const WindingTree tree = tree_of(mesh);
  std::vector<Vec3> points = random_points(2000, 3.2);
  for (Vec3& p : points) p.tail<2>() *= 0.4;
  int seen[3] = {0, 0, 0};
  for (const Vec3& p : points) {
    const double radius = p.norm();
    if (std::abs(radius - 1) < 0.02) continue;  // the sphere's facets lie a little inside of it
    const bool in_box = p.x() > 0 && p.x() < 3 && std::abs(p.y()) < 0.4 && std::abs(p.z()) < 0.4;
    const int expected = (radius < 1 ? 1 : 0) + (in_box ? 1 : 0);
    ++seen[expected];
    CHECK(std::abs(winding_number(tree, p, exact) - expected) < 1e-12);
    CHECK(std::abs(winding_number(tree, p) - expected) < 1e-2);
  }
  for (const int count : seen) CHECK(count > 5);
}

TEST_CASE("open bodies: a half in the mouth of a half sphere, what a hole lets through") {
  const Tessellation half = half_sphere_surface({0, 0, 0}, {0, 0, 1}, 1)->tessellation();
  const WindingTree tree = tree_of(half);
  for (const double x : {0.0, 0.3, 0.9}) {
    CHECK(std::abs(winding_number(tree, Vec3(x, 0.1 * x, 0), exact) - 0.5) < 1e-9);
    CHECK(std::abs(winding_number(tree, Vec3(x, 0.1 * x, 0)) - 0.5) < 1e-2);
  }
  CHECK(std::abs(winding_number(tree, Vec3(1.5, 0, 0), exact)) < 1e-9);
  // A sphere with one triangle missing: its share of the whole angle is missing, from wherever it is seen.
  Tessellation holed = sphere_surface({0, 0, 0}, 1)->tessellation();
  const auto lost = holed.triangles[holed.triangles.size() / 2];
  holed.triangles.erase(holed.triangles.begin() + static_cast<std::ptrdiff_t>(holed.triangles.size() / 2));
  const WindingTree with_hole = tree_of(holed);
  for (const Vec3& p : {Vec3(0, 0, 0), Vec3(0.5, -0.2, 0.3), Vec3(1.4, 0.8, -2)}) {
    const double share =
        solid_angle(holed.points[lost[0]] - p, holed.points[lost[1]] - p, holed.points[lost[2]] - p) /
        (4 * std::numbers::pi);
    CHECK(std::abs(winding_number(with_hole, p, exact) - ((p.norm() < 1 ? 1 : 0) - share)) < 1e-12);
  }
}

/// Points at one place become one: analytic tessellations have both sides of a seam, CAD's have not.
Tessellation welded(Tessellation mesh) {
  std::map<std::array<long, 3>, Index> number;
  std::vector<Index> same;
  std::vector<Vec3> points;
  for (const Vec3& p : mesh.points) {
    const auto at = [&](int axis) { return std::lround(1e9 * p[axis]); };
    const auto [known, added] = number.try_emplace({at(0), at(1), at(2)}, static_cast<Index>(points.size()));
    if (added) points.push_back(p);
    same.push_back(known->second);
  }
  mesh.points = points;
  for (auto& triangle : mesh.triangles) {
    for (Index& corner : triangle) corner = same[corner];
  }
  return mesh;
}

TEST_CASE("closed rims make the number whole: a half sphere is a half ball, a sphere with two holes a ball") {
  Tessellation half = welded(half_sphere_surface({0, 0, 0}, {0, 0, 1}, 1)->tessellation());
  close_rims(half.points, half.triangles);
  const WindingTree tree = tree_of(half);
  CHECK(std::abs(winding_number(tree, Vec3(0.2, 0.1, 0.01), exact) - 1) < 1e-12);
  CHECK(std::abs(winding_number(tree, Vec3(0.2, 0.1, -0.01), exact)) < 1e-12);
  Tessellation sphere = welded(sphere_surface({0, 0, 0}, 1)->tessellation());
  const std::size_t before = sphere.triangles.size();
  const auto far_apart = {before / 4, 3 * before / 4};
  for (const std::size_t t : far_apart) {
    sphere.triangles.erase(sphere.triangles.begin() + static_cast<std::ptrdiff_t>(t));
  }
  const std::size_t points = sphere.points.size();
  close_rims(sphere.points, sphere.triangles);
  CHECK(sphere.points.size() == points + 2);
  CHECK(sphere.triangles.size() == before - 2 + 6);
  for (const Vec3& p : random_points(200, 1.5)) {
    if (std::abs(p.norm() - 1) < 0.02) continue;
    CHECK(std::abs(winding_number(tree_of(sphere), p, exact) - (p.norm() < 1 ? 1 : 0)) < 1e-12);
  }
  close_rims(sphere.points, sphere.triangles);
  CHECK(sphere.points.size() == points + 2);
}

TEST_CASE("just off a triangle both sides differ by one, however near") {
  const Tessellation mesh = torus_surface({})->tessellation();
  const WindingTree tree = tree_of(mesh);
  for (std::size_t t = 0; t < mesh.triangles.size(); t += 37) {
    const auto& [i, j, k] = mesh.triangles[t];
    const Vec3 a = mesh.points[i], b = mesh.points[j], c = mesh.points[k];
    const Vec3 n = (b - a).cross(c - a).normalized(), middle = (a + b + c) / 3;
    for (const double away : {1e-3, 1e-6, 1e-9}) {
      CHECK(std::abs(winding_number(tree, middle + away * n)) < 1e-2);
      CHECK(std::abs(winding_number(tree, middle - away * n) - 1) < 1e-2);
    }
  }
}

TEST_CASE("the expansion converges with beta to the exact sum, with the order of its first neglected term") {
  const Tessellation mesh = both(torus_surface({})->tessellation(),
                                 half_sphere_surface({0.2, 0, 0}, {0, 1, 0}, 0.8)->tessellation());
  const WindingTree tree = tree_of(mesh);
  const std::vector<Vec3> points = random_points(1500, 1.6);
  std::vector<double> reference(points.size()), found(points.size());
  winding_numbers(tree, points, exact, reference);
  std::vector<double> worst, rms;
  for (const double beta : {2.0, 4.0, 8.0, 16.0}) {
    winding_numbers(tree, points, beta, found);
    double most = 0, squares = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double error = std::abs(found[i] - reference[i]);
      most = std::max(most, error);
      squares += error * error;
    }
    worst.push_back(most);
    rms.push_back(std::sqrt(squares / static_cast<double>(points.size())));
    std::printf("beta %4.0f: winding numbers off by at most %.1e, rms %.1e\n", beta, worst.back(),
                rms.back());
  }
  CHECK(worst[0] < 5e-3);
  CHECK(worst[1] < 5e-4);
  CHECK(worst[2] < 5e-5);
  CHECK(worst[3] < 5e-6);
  for (std::size_t k = 0; k + 1 < rms.size(); ++k) CHECK(rms[k + 1] < rms[k] / 10);  // 16: order 4
}

TEST_CASE("winding numbers are the same bits with one thread and with four; rate") {
  const Tessellation mesh = torus_surface({})->tessellation();
  const WindingTree tree = tree_of(mesh);
  const std::vector<Vec3> points = random_points(20000, 1.6);
  std::vector<double> one(points.size()), four(points.size());
  const int before = thread_count();
  set_thread_count(1);
  const std::clock_t start = std::clock();
  winding_numbers(tree, points, 2, one);
  const double seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  set_thread_count(4);
  winding_numbers(tree, points, 2, four);
  set_thread_count(before);
  CHECK(one == four);
  std::printf("%zu triangles: %.0f winding numbers a CPU second\n", mesh.triangles.size(),
              static_cast<double>(points.size()) / seconds);
}

TEST_CASE("nothing winds round anything where there is no triangle") {
  CHECK(winding_number(build_winding_tree({}, {}), Vec3(1, 2, 3)) == 0);
}
