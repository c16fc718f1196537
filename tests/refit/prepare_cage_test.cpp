#include "core/refit/prepare_cage.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iostream>
#include <numeric>

#include "core/base/error.hpp"
#include "core/cage/lint_cage.hpp"
#include "core/limit/limit_stencils.hpp"
#include "core/refit/cage_topology.hpp"
#include "core/refit/fit_surface.hpp"
#include "core/target/analytic_surfaces.hpp"
#include "tests/catch.hpp"
#include "tests/refit/hand_drawn_cages.hpp"

using namespace flowcage;
using namespace flowcage::test;

namespace {

class Listener final : public Progress {
 public:
  void warn(std::string_view message) override { warnings.emplace_back(message); }
  std::vector<std::string> warnings;
};

PreparedCage prepared(const Cage& cage, const TargetSurface& target, bool new_faces = true) {
  Progress silent;
  PrepareSettings settings;
  settings.new_faces = new_faces;
  return prepare_cage(cage, target, settings, silent);
}

std::string refusal(const Cage& cage, const TargetSurface& target) {
  try {
    prepared(cage, target);
  } catch (const Error& error) {
    CHECK(error.kind() == ErrorKind::input);
    return fmt::format("{} | {}", error.what(), error.remedy());
  }
  return "";
}

std::vector<std::string> rules(const LintReport& report) {
  std::vector<std::string> names;
  for (const LintFinding& finding : report) names.push_back(finding.rule);
  return names;
}

/// The smallest scaled Jacobian (sine of a corner's angle) of a fitted level's quads.
double worst_corner(const FittedLevel& level) {
  const std::vector<Vec3> points = apply_stencils(limit_stencils(level.topology), level.control_points);
  double worst = 1;
  for (Index f = 0; f < level.topology.face_count(); ++f) {
    const auto face = level.topology.face_vertices[f];
    const std::size_t n = face.size();
    Vec3 area = Vec3::Zero();
    for (std::size_t i = 1; i + 1 < n; ++i) {
      area += (points[face[i]] - points[face[0]]).cross(points[face[i + 1]] - points[face[0]]);
    }
    for (std::size_t i = 0; i < n; ++i) {
      const Vec3 a = points[face[(i + 1) % n]] - points[face[i]];
      const Vec3 b = points[face[(i + n - 1) % n]] - points[face[i]];
      worst = std::min(worst, a.cross(b).dot(area) / (a.norm() * b.norm() * area.norm()));
    }
  }
  return worst;
}

SurfaceFit fitted(const Cage& cage, const TargetSurface& target, int levels) {
  FitSettings settings;
  settings.levels = levels;
  Progress silent;
  return fit_surface(cage, target, settings, silent);
}

/// A cylinder whose caps are four quads about their centre: every other rim vertex has one face on the cap.
Cage pie_cylinder(Index rim_size = 8) {
  Cage cage = empty_cage();
  for (int end = 0; end < 2; ++end) {
    for (Index i = 0; i < rim_size; ++i) {
      const double a = 2 * std::numbers::pi * i / rim_size;
      cage.points.emplace_back(std::cos(a), std::sin(a), end);
    }
    cage.points.emplace_back(0, 0, end);
  }
  const Index n = rim_size + 1;
  for (Index i = 0; i < rim_size; ++i) {
    const Index k = (i + 1) % rim_size;
    add_face(cage, {i, k, n + k, n + i});
    add_crease(cage, i, k);
    add_crease(cage, n + i, n + k);
    if (i % 2 != 0) continue;
    const Index l = (i + 2) % rim_size;
    add_face(cage, {rim_size, l, k, i});
    add_face(cage, {n + rim_size, n + i, n + k, n + l});
  }
  return cage;
}

Cage diagonal_split(const Cage& cage, Index rim_size) {
  Cage result = cage;
  result.faces = {};
  result.face_patch.clear();
  const Index n = rim_size + 1;
  for (Index f = 0; f < cage.faces.size(); ++f) {
    const auto face = cage.faces[f];
    if (face[0] == rim_size || face[0] == n + rim_size) {
      add_face(result, {face[0], face[1], face[2]});
      add_face(result, {face[0], face[2], face[3]});
    } else {
      result.faces.push_row(face);
      result.face_patch.push_back(0);
    }
  }
  return result;
}

/// A cylinder whose caps are single faces.
Cage drum(Index n) {
  Cage cage = empty_cage();
  std::vector<Index> bottom, top;
  for (Index end = 0; end < 2; ++end) {
    for (Index i = 0; i < n; ++i) {
      const double a = 2 * std::numbers::pi * i / n;
      cage.points.emplace_back(std::cos(a), std::sin(a), end);
      (end == 0 ? bottom : top).push_back(end * n + i);
    }
  }
  for (Index i = 0; i < n; ++i) {
    const Index k = (i + 1) % n;
    add_face(cage, {i, k, n + k, n + i});
    add_crease(cage, i, k);
    add_crease(cage, n + i, n + k);
  }
  std::reverse(bottom.begin(), bottom.end());
  for (const auto& cap : {bottom, top}) {
    cage.faces.push_row(cap);
    cage.face_patch.push_back(0);
  }
  return cage;
}

}  // namespace

TEST_CASE("a single face at a crease is split, and its cells stay sound", "[prepare]") {
  // The caps' quads have the rim's vertices at 180 degrees: with every level the worst corner's angle halves.
  const auto cylinder = cylinder_surface({});
  const SurfaceFit drawn = fitted(pie_cylinder(), *cylinder, 4);
  for (std::size_t l = 3; l < 5; ++l) {
    CHECK(worst_corner(drawn.levels[l]) < 0.6 * worst_corner(drawn.levels[l - 1]));
  }
  const PreparedCage mended = prepared(pie_cylinder(), *cylinder);
  CHECK(rules(mended.lint) == std::vector<std::string>{"crease_sector"});
  CHECK(mended.creases == PreparedCage::Creases::drawn);
  const SurfaceFit fit = fitted(mended.cage, *cylinder, 4);
  for (std::size_t l = 2; l < 5; ++l) CHECK(worst_corner(fit.levels[l]) > 0.3);
  CHECK(fit.max_deviation < 2 * drawn.max_deviation);
  // An outer polyhedron must have the same faces: nothing is split then, only said.
  const PreparedCage left = prepared(pie_cylinder(), *cylinder, false);
  REQUIRE(rules(left.lint) == std::vector<std::string>{"crease_sector"});
  CHECK(left.lint[0].severity == LintFinding::Severity::warning);
  CHECK(left.cage.faces == pie_cylinder().faces);
}

TEST_CASE("a part that is turned inside out is reversed", "[prepare]") {
  const auto sphere = sphere_surface(Vec3::Zero(), 0.5);
  const Cage cube = box_cage(Vec3::Constant(-0.35), Vec3::Constant(0.35), false);
  Cage turned = cube;
  for (Index f = 0; f < 6; ++f) std::reverse(turned.faces[f].begin() + 1, turned.faces[f].end());
  const PreparedCage mended = prepared(turned, *sphere);
  CHECK(rules(mended.lint) == std::vector<std::string>{"inside_out"});
  CHECK(mended.cage.faces == cube.faces);
  CHECK(rules(prepared(cube, *sphere).lint).empty());
}

TEST_CASE("a cage of another genus is refused with the numbers", "[prepare]") {
  TorusShape shape;
  shape.minor_radius = 0.35;
  const auto torus = torus_surface(shape);
  const auto sphere = sphere_surface(Vec3::Zero(), 1);
  const std::string ball = refusal(box_cage(Vec3(-1.3, -1.3, -0.4), Vec3(1.3, 1.3, 0.4), false), *torus);
  CHECK_THAT(ball, contains_text("the cage has genus 0 (V - E + F = 2, 0 open boundaries), the CAD genus 1 "
                                 "(V - E + F = 0, 0 open boundaries)"));
  CHECK_THAT(ball, contains_text("draw the holes"));
  CHECK_THAT(refusal(torus_cage(0.7, 0.4, 4, 4), *sphere), contains_text("close the holes"));
  CHECK(refusal(torus_cage(1, 0.4, 4, 4), *torus).empty());
}

TEST_CASE("the topology of a target is known where its faces make one surface", "[prepare]") {
  const auto topology = [](const TargetSurface& target) { return target_topology(target).value(); };
  CHECK(topology(*sphere_surface(Vec3::Zero(), 1)).genus == 0);
  CHECK(topology(*torus_surface({})).genus == 1);
  CHECK(topology(*cylinder_surface({})).euler == 2);
  CHECK(topology(*box_surface(Box3(Vec3::Zero(), Vec3::Ones()))).boundary_loops == 0);
  const Topology half = topology(*half_sphere_surface(Vec3::Zero(), Vec3::UnitY(), 1));
  CHECK(half.boundary_loops == 1);
  CHECK(half.genus == 0);
}

TEST_CASE("a cage that is open where the CAD is closed is warned of, and the other way round", "[prepare]") {
  const auto sphere = sphere_surface(Vec3::Zero(), 0.5);
  const Cage cube = box_cage(Vec3::Constant(-0.35), Vec3::Constant(0.35), false);
  Cage open = cube;
  open.faces = {};
  open.face_patch.clear();
  for (Index f = 0; f < 5; ++f) {
    open.faces.push_row(cube.faces[f]);
    open.face_patch.push_back(0);
  }
  const PreparedCage warned = prepared(open, *sphere);
  REQUIRE(rules(warned.lint) == std::vector<std::string>{"open_boundary"});
  CHECK_THAT(warned.lint[0].message, contains_text("the CAD is closed"));
  const auto half = half_sphere_surface(Vec3::Zero(), Vec3::UnitY(), 0.5);
  const PreparedCage closed = prepared(box_cage(Vec3(-0.35, 0, -0.35), Vec3(0.35, 0.4, 0.35), false), *half);
  REQUIRE(rules(closed.lint) == std::vector<std::string>{"open_boundary"});
  CHECK_THAT(closed.lint[0].message, contains_text("the cage is closed"));
}

TEST_CASE("what is found is said, with the creases that were made", "[prepare]") {
  const auto cylinder = cylinder_surface({});
  Cage cage = cylinder_cage(1, 1);
  cage.creases.clear();
  Listener listener;
  const PreparedCage result = prepare_cage(cage, *cylinder, {}, listener);
  CHECK(result.creases == PreparedCage::Creases::found);
  CHECK(result.cage.creases.size() == 16);
  REQUIRE(listener.warnings.size() == 1);
  CHECK_THAT(listener.warnings[0], contains_text("16 of its edges were made creases along 2 of the CAD's 2"));
}

TEST_CASE("measure", "[.debug]") {
  const auto cylinder = cylinder_surface({});
  const auto show = [&](const char* what, const Cage& cage, const TargetSurface& target) {
    const SurfaceFit fit = fitted(cage, target, 4);
    std::cout << what << ":";
    for (std::size_t l = 1; l < fit.levels.size(); ++l) {
      std::cout << fmt::format("  {:.3g} ({} folds) sJ {:.3g}", fit.levels[l].report.max_deviation,
                               fit.levels[l].report.folds, worst_corner(fit.levels[l]));
    }
    std::cout << std::endl;
  };
  show("O-grid", cylinder_cage(1, 1), *cylinder);
  show("pie drawn", pie_cylinder(), *cylinder);
  show("pie diagonal", diagonal_split(pie_cylinder(), 8), *cylinder);
  show("pie ring", split_crease_sectors(pie_cylinder(), true).cage, *cylinder);
  for (Index n : {4, 6, 8, 12, 16}) {
    show(fmt::format("drum {} drawn", n).c_str(), drum(n), *cylinder);
    show(fmt::format("drum {} ring", n).c_str(), split_crease_sectors(drum(n), true).cage, *cylinder);
  }
  TorusShape shape;
  shape.minor_radius = 0.35;
  const auto torus = torus_surface(shape);
  for (const double ratio : {1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 10.0}) {
    // Sections at angles that alternate between wide and narrow.
    Cage cage = torus_cage(1, 0.4, 8, 6);
    for (Index i = 0; i < 8; ++i) {
      const double narrow = 2 * std::numbers::pi / 4 / (1 + ratio);
      const double a = (i / 2) * std::numbers::pi / 2 + (i % 2) * narrow;
      for (Index j = 0; j < 6; ++j) {
        const double b = 2 * std::numbers::pi * j / 6, r = 1 + 0.4 * std::cos(b);
        cage.points[i * 6 + j] = Vec3(r * std::cos(a), r * std::sin(a), 0.4 * std::sin(b));
      }
    }
    show(fmt::format("torus ratio {}", ratio).c_str(), cage, *torus);
  }
  const auto sphere = sphere_surface(Vec3::Zero(), 0.5);
  for (const Index n : {3, 4, 6, 8, 10, 12, 16, 24}) {
    // A prism with n-gons at the poles, and a double pyramid whose apices have n edges (with a belt).
    Cage prism = empty_cage(), pyramid = empty_cage();
    std::vector<Index> low, high;
    for (Index end = 0; end < 2; ++end) {
      for (Index i = 0; i < n; ++i) {
        const double a = 2 * std::numbers::pi * i / n;
        prism.points.emplace_back(0.4 * std::cos(a), 0.4 * std::sin(a), end ? 0.35 : -0.35);
        (end ? high : low).push_back(end * n + i);
      }
    }
    pyramid.points = prism.points;
    pyramid.points.emplace_back(0, 0, -0.55);
    pyramid.points.emplace_back(0, 0, 0.55);
    for (Index i = 0; i < n; ++i) {
      const Index k = (i + 1) % n;
      add_face(prism, {i, k, n + k, n + i});
      add_face(pyramid, {i, k, n + k, n + i});
      add_face(pyramid, {2 * n, k, i});
      add_face(pyramid, {2 * n + 1, n + i, n + k});
    }
    std::reverse(low.begin(), low.end());
    for (const auto& cap : {low, high}) {
      prism.faces.push_row(cap);
      prism.face_patch.push_back(0);
    }
    show(fmt::format("sphere {}-gons", n).c_str(), prism, *sphere);
    show(fmt::format("sphere valence {}", n).c_str(), pyramid, *sphere);
  }
  for (const double dent : {0.0, 0.2, 0.4, 0.6, 0.8}) {
    Cage cage = box_cage(Vec3::Constant(-0.35), Vec3::Constant(0.35), false);
    cage.points[7] = (1 - dent) * cage.points[7] + dent * Vec3(0.35, -0.35, 0.35) * 0.2;
    std::cout << fmt::format("folded {} ", dent);
    for (const auto& f : lint_cage_shape(cage)) std::cout << f.rule << ' ';
    show("sphere", cage, *sphere);
  }
}
