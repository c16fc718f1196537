#include "core/refit/fit_surface.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/base/error.hpp"
#include "core/base/parallel.hpp"
#include "core/limit/evaluate.hpp"
#include "core/target/analytic_surfaces.hpp"
#include "tests/catch.hpp"
#include "tests/refit/hand_drawn_cages.hpp"

using namespace flowcage;
using namespace flowcage::test;

namespace {

Index total_folds(const SurfaceFit& fit) {
  Index folds = 0;
  for (const FittedLevel& level : fit.levels) folds += level.report.folds;
  return folds;
}

SurfaceFit fitted(const Cage& cage, const TargetSurface& target, int levels = 3) {
  FitSettings settings;
  settings.levels = levels;
  Progress silent;
  return fit_surface(cage, target, settings, silent);
}

std::string failure(const Cage& cage, const TargetSurface& target) {
  try {
    fitted(cage, target, 0);
  } catch (const Error& error) {
    CHECK(error.kind() == ErrorKind::input);
    return fmt::format("{} | {}", error.what(), error.remedy());
  }
  return "";
}

bool contains(const std::string& text, const std::string& part) {
  if (text.find(part) != std::string::npos) return true;
  WARN("not in: " << text);
  return false;
}

Cage sphere_cage() {
  return box_cage(Vec3::Constant(-0.35), Vec3::Constant(0.35), false);
}

}  // namespace

TEST_CASE("a cube of 8 vertices becomes a sphere", "[fit]") {
  const auto target = sphere_surface(Vec3::Zero(), 0.5);
  const SurfaceFit fit = fitted(sphere_cage(), *target);
  REQUIRE(fit.levels.size() == 4);
  CHECK(total_folds(fit) == 0);
  CHECK(fit.max_deviation < 2e-5);
  CHECK(fit.coverage_deviation < 1.5 * fit.max_deviation);
  // Extraordinary vertices: at least a factor 5 a level.
  for (std::size_t l = 1; l < 4; ++l) {
    CHECK(fit.levels[l].report.max_deviation < fit.levels[l - 1].report.max_deviation / 4);
  }
  CHECK(fit.vertex_targets.size() == fit.levels.back().control_points.size());
  for (const VertexTarget& t : fit.vertex_targets) {
    CHECK(t.kind == VertexTarget::Kind::face);
    CHECK(t.position.norm() == Approx(0.5).epsilon(1e-12));
  }
}

TEST_CASE("16 vertices become a torus, at the order of the regular surface", "[fit]") {
  TorusShape shape;
  shape.major_radius = 1;
  shape.minor_radius = 0.35;
  const auto target = torus_surface(shape);
  const SurfaceFit fit = fitted(torus_cage(1, 0.4, 4, 4), *target);
  CHECK(total_folds(fit) == 0);
  CHECK(fit.max_deviation < 2e-5);
  CHECK(fit.coverage_deviation < 1.5 * fit.max_deviation);
  // Regular everywhere: close to h^4, a factor 16; the constant is not yet in its limit on coarse levels.
  CHECK(fit.levels[3].report.max_deviation < fit.levels[2].report.max_deviation / 10);
}

TEST_CASE("a cylinder keeps its sharp rims", "[fit]") {
  const auto target = cylinder_surface({});
  const SurfaceFit fit = fitted(cylinder_cage(1, 1), *target);
  CHECK(total_folds(fit) == 0);
  CHECK(fit.unmatched_chains.empty());
  CHECK(fit.max_deviation < 4e-7);
  CHECK(fit.coverage_deviation < 1.5 * fit.max_deviation);
  Index on_rims = 0;
  for (const VertexTarget& t : fit.vertex_targets) {
    if (t.kind != VertexTarget::Kind::chain) continue;
    ++on_rims;
    CHECK(std::hypot(t.position.x(), t.position.y()) == Approx(1).epsilon(1e-12));
    CHECK((t.position.z() == Approx(0).margin(1e-12) || t.position.z() == Approx(1).epsilon(1e-12)));
  }
  CHECK(on_rims == 2 * 8 * 8);
}

TEST_CASE("a box is reproduced to rounding, with its corners", "[fit]") {
  const Box3 box(Vec3(0, 0, 0), Vec3(1, 2, 3));
  const auto target = box_surface(box);
  const SurfaceFit fit = fitted(box_cage(box.min(), box.max(), true), *target, 2);
  CHECK(total_folds(fit) == 0);
  CHECK(fit.max_deviation < 1e-14);
  CHECK(fit.coverage_deviation < 1e-14);
  CHECK(fit.unmatched_chains.empty());
  CHECK(std::count_if(fit.vertex_targets.begin(), fit.vertex_targets.end(),
                      [](const VertexTarget& t) { return t.kind == VertexTarget::Kind::corner; }) == 8);
}

TEST_CASE("noise of 3 % in the cage costs little", "[fit]") {
  const auto sphere = sphere_surface(Vec3::Zero(), 0.5);
  const auto cylinder = cylinder_surface({});
  for (const unsigned seed : {1U, 2U, 3U}) {
    const SurfaceFit fit = fitted(with_noise(sphere_cage(), 0.03, seed), *sphere);
    CHECK(total_folds(fit) == 0);
    CHECK(fit.max_deviation < 2e-5);
    const SurfaceFit rims = fitted(with_noise(cylinder_cage(1, 1), 0.03, seed), *cylinder, 2);
    CHECK(total_folds(rims) == 0);
    CHECK(rims.unmatched_chains.empty());
    CHECK(rims.max_deviation < 3e-5);
  }
}

TEST_CASE("tangent distance beats point distance on a curved body", "[fit]") {
  TorusShape shape;
  shape.major_radius = 1;
  shape.minor_radius = 0.35;
  const auto target = torus_surface(shape);
  FitSettings points;
  points.levels = 3;
  points.tangent_distance = false;
  Progress silent;
  const SurfaceFit published = fit_surface(torus_cage(1, 0.4, 4, 4), *target, points, silent);
  const SurfaceFit tangent = fitted(torus_cage(1, 0.4, 4, 4), *target, 3);
  CHECK(tangent.max_deviation < 0.5 * published.max_deviation);
}

TEST_CASE("an open cage keeps its boundary in the symmetry plane to the last bit", "[fit]") {
  const auto target = half_sphere_surface(Vec3::Zero(), Vec3::UnitY(), 0.5);
  // The upper half of a cube, open at y = 0, with a ring of 8 boundary vertices.
  Cage cage = empty_cage();
  const double r = 0.5;
  for (int ring = 0; ring < 2; ++ring) {
    for (Index i = 0; i < 8; ++i) {
      const double a = 2 * std::numbers::pi * i / 8;
      const double height = ring * 0.6 * r;
      const double radius = ring == 0 ? r : 0.75 * r;
      cage.points.emplace_back(radius * std::sin(a), height, radius * std::cos(a));
    }
  }
  cage.points.emplace_back(0, r, 0);
  for (Index i = 0; i < 8; ++i) add_face(cage, {i, (i + 1) % 8, 8 + (i + 1) % 8, 8 + i});
  for (Index i = 0; i < 8; i += 2) add_face(cage, {16, 8 + i, 8 + (i + 1) % 8, 8 + (i + 2) % 8});
  const SurfaceFit fit = fitted(with_noise(cage, 0.01, 7), *target);
  CHECK(total_folds(fit) == 0);
  CHECK(fit.unmatched_chains.empty());
  CHECK(fit.max_deviation < 1e-4);
  CHECK(fit.coverage_deviation < 1.5 * fit.max_deviation);
  for (const FittedLevel& level : fit.levels) {
    for (Index e = 0; e < level.topology.edge_count(); ++e) {
      if (!level.topology.is_boundary_edge(e)) continue;
      for (const Index v : level.topology.edge_vertices[e]) CHECK(level.control_points[v].y() == 0.0);
    }
  }
}

TEST_CASE("a crease where the CAD has none is laid on the surface, with a warning", "[fit]") {
  const auto target = sphere_surface(Vec3::Zero(), 0.5);
  Cage cage = sphere_cage();
  for (const auto& [a, b] : {std::pair<Index, Index>{0, 1}, {1, 3}, {3, 2}, {2, 0}}) add_crease(cage, a, b);
  const SurfaceFit fit = fitted(cage, *target, 2);
  CHECK(total_folds(fit) == 0);
  REQUIRE(fit.warnings.size() == 1);
  CHECK(contains(fit.warnings[0], "follows no sharp edge"));
  CHECK(fit.max_deviation < 5e-3);
}

TEST_CASE("sharp edges of the CAD that no crease follows are named", "[fit]") {
  const auto target = cylinder_surface({});
  Cage cage = cylinder_cage(1, 1);
  cage.creases.clear();
  const SurfaceFit fit = fitted(cage, *target, 1);
  CHECK(fit.unmatched_chains == std::vector<Index>{0, 1});
  REQUIRE(fit.warnings.size() == 1);
  CHECK(contains(fit.warnings[0], "no crease of the cage follows 2 of the CAD's 2 chains"));
  FitSettings silent_about_them;
  silent_about_them.levels = 1;
  silent_about_them.name_unmatched = false;
  Progress silent;
  CHECK(fit_surface(cage, *target, silent_about_them, silent).warnings.empty());
}

TEST_CASE("the fit stops where the tolerance is met, and says so", "[fit]") {
  const auto target = sphere_surface(Vec3::Zero(), 0.5);
  FitSettings settings;
  settings.levels = 4;
  settings.tolerance = 1e-3;
  Progress silent;
  const SurfaceFit early = fit_surface(sphere_cage(), *target, settings, silent);
  CHECK(early.levels.back().report.level == 1);
  CHECK(early.max_deviation <= settings.tolerance);
  CHECK(early.stopped_because == "the tolerance is met");
  settings.levels = 2;
  settings.tolerance = 1e-9;
  const SurfaceFit late = fit_surface(sphere_cage(), *target, settings, silent);
  CHECK(late.levels.back().report.level == 2);
  CHECK(late.stopped_because == "all levels are done");
}

TEST_CASE("the deviation is that of the whole surface where sharp edges are rounded off", "[fit]") {
  // The error peaks in a narrow strip along the rim, between the samples.
  const auto target = cylinder_surface({});
  Cage cage = cylinder_cage(1, 1);
  cage.creases.clear();
  const SurfaceFit fit = fitted(cage, *target, 2);
  const FittedLevel& last = fit.levels.back();
  const std::vector<Vec3> dense = sample_limit_surface(last.topology, last.control_points, 6).points;
  std::vector<SurfacePoint> nearest(dense.size());
  target->closest_points(dense, {}, nearest);
  double largest = 0;
  for (const SurfacePoint& p : nearest) largest = std::max(largest, p.distance);
  CHECK(fit.max_deviation * target->diagonal() > 0.99 * largest);
  CHECK(fit.max_deviation * target->diagonal() < 1.05 * largest);
}

TEST_CASE("a cage that cannot belong is refused with numbers", "[fit]") {
  const auto target = sphere_surface(Vec3(1, 0, 0), 0.5);
  Cage good = sphere_cage();
  for (Vec3& p : good.points) p += Vec3(1, 0, 0);
  CHECK(failure(good, *target).empty());

  Cage far = good;
  for (Vec3& p : far.points) p += Vec3(0, 0, 7);
  CHECK(contains(failure(far, *target), "too far from the CAD"));

  Cage millimetres = good;
  for (Vec3& p : millimetres.points) p *= 1000;
  CHECK(contains(failure(millimetres, *target), "multiplied by 0.001"));
  CHECK(contains(failure(millimetres, *target), "--cage-unit"));
  Cage inches = good;
  for (Vec3& p : inches.points) p /= 0.0254;
  CHECK(contains(failure(inches, *target), "multiplied by 0.0254"));

  Cage reversed = good;
  for (Index f = 0; f < reversed.faces.size(); ++f) {
    std::reverse(reversed.faces[f].begin(), reversed.faces[f].end());
  }
  CHECK(contains(failure(reversed, *target), "inside out"));

  Cage broken = good;
  broken.points[3].y() = std::nan("");
  CHECK(contains(failure(broken, *target), "not finite"));
}

TEST_CASE("the fit is the same to the last bit on any number of threads", "[fit][determinism]") {
  const auto target = cylinder_surface({});
  set_thread_count(1);
  const SurfaceFit one = fitted(cylinder_cage(1, 1), *target, 2);
  set_thread_count(5);
  const SurfaceFit five = fitted(cylinder_cage(1, 1), *target, 2);
  set_thread_count(0);
  CHECK(one.levels.back().control_points == five.levels.back().control_points);
  CHECK(one.max_deviation == five.max_deviation);
  CHECK(one.coverage_deviation == five.coverage_deviation);
}
