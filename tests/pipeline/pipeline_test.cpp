#include "core/pipeline.hpp"

#include <algorithm>
#include <numbers>

#include "core/base/error.hpp"
#include "core/target/analytic_surfaces.hpp"
#include "tests/catch.hpp"
#include "tests/refit/hand_drawn_cages.hpp"
#include "tests/refit/patch_target.hpp"

using namespace flowcage;

namespace {

Cage cube(double half) {
  Cage cage;
  for (int i = 0; i < 8; ++i) {
    cage.points.emplace_back((i & 1 ? half : -half), (i & 2 ? half : -half), (i & 4 ? half : -half));
  }
  for (const std::array<Index, 4>& f : std::vector<std::array<Index, 4>>{
           {0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}) {
    cage.faces.push_row(f);
    cage.face_patch.push_back(0);
  }
  cage.patch_names = {"ball"};
  return cage;
}

}  // namespace

TEST_CASE("a sphere in a sphere: volume, patches, gates") {
  const auto sphere = sphere_surface(Vec3::Zero(), 0.5);
  const TargetSurface& ball = *sphere;
  VolumeSettings settings;
  settings.fit.levels = 4;
  const FarField farfield{OuterShape::Kind::sphere, 3};
  Progress silent;
  const VolumeResult result =
      make_volume(*shell_source(cube(0.4), nullptr, farfield, ball.bounds()), ball, settings, silent);
  CHECK(all_hold(result.gates));
  CHECK(result.mesh.cell_count() == 6 * 4096);
  CHECK(result.quality.inverted_cells == 0);
  const double exact = 4 * std::numbers::pi / 3 * (std::pow(3.0, 3) - std::pow(0.5, 3));
  CHECK(result.quality.total_volume == Approx(exact).epsilon(0.01));  // facets of the outer sphere
  REQUIRE(result.patches.size() == 2);
  CHECK(result.patches[0].name == "ball");
  CHECK(result.patches[0].faces == 6 * 256);
  CHECK(result.patches[0].max_deviation <= result.fit.max_deviation * 1.01);
  for (const auto& quad : result.mesh.patches()[0].quads) {
    for (Index p : quad) CHECK(result.mesh.points()[p].norm() == Approx(0.5).margin(1e-12));
  }
}

TEST_CASE("a tolerance that is missed is a gate that does not hold, with its place") {
  const auto sphere = sphere_surface(Vec3::Zero(), 0.5);
  const TargetSurface& ball = *sphere;
  SurfaceSettings settings;
  settings.fit.levels = 1;
  settings.tolerance = 1e-9;
  Progress silent;
  const SurfaceResult result = make_surface(cube(0.4), ball, settings, silent);
  CHECK_FALSE(all_hold(result.gates));
  CHECK_THAT(result.gates.front().detail, Catch::Contains("from the CAD near ("));
  CHECK(result.mesh.faces.size() == 24);
}

TEST_CASE("sampled surfaces lie on the limit surface, not on the CAD") {
  const auto sphere = sphere_surface(Vec3::Zero(), 0.5);
  const TargetSurface& ball = *sphere;
  SurfaceSettings settings;
  settings.fit.levels = 1;
  settings.sample = 2;
  Progress silent;
  const SurfaceResult result = make_surface(cube(0.4), ball, settings, silent);
  CHECK(result.mesh.faces.size() == 24 * 16);
  const double worst = *std::max_element(result.deviation.begin(), result.deviation.end());
  CHECK(worst / ball.diagonal() <= result.fit.max_deviation * 1.2);
  CHECK(worst / ball.diagonal() >= result.fit.max_deviation * 0.3);
}

TEST_CASE("a number of cells: the nearest level, even where the tolerance is met earlier") {
  const auto sphere = sphere_surface(Vec3::Zero(), 0.5);
  const TargetSurface& ball = *sphere;
  VolumeSettings settings;
  const FarField farfield{OuterShape::Kind::sphere, 3};
  settings.cells = 3000;  // 6 * 8^3 at level 3
  settings.fit.tolerance = 1e-2;
  Progress silent;
  CHECK(make_volume(*shell_source(cube(0.4), nullptr, farfield, ball.bounds()), ball, settings, silent)
            .fit.levels.size() == 4);
}

TEST_CASE("a half model whose CAD is open in another plane than the cage is refused") {
  const test::WingCageShape wing;
  const auto target = test::wing_target(wing, test::TipShape::flat);
  Cage cage = test::wing_cage(wing);
  VolumeSettings settings;
  settings.fit.levels = 1;
  const FarField farfield{OuterShape::Kind::sphere, 5};
  Progress silent;
  CHECK_NOTHROW(
      make_volume(*shell_source(cage, nullptr, farfield, target->bounds()), *target, settings, silent));
  for (Vec3& p : cage.points) {  // the cage's root, and with it its symmetry plane, tilted by 6 degrees
    if (p.y() == 0) p.y() = 0.1 * (p.x() - 0.5 * wing.root_chord);
  }
  CHECK_THROWS_WITH(
      make_volume(*shell_source(cage, nullptr, farfield, target->bounds()), *target, settings, silent),
      Catch::Contains("leaves the symmetry plane by"));
}
