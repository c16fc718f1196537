#include "core/quality/topology_bound.hpp"

#include <cmath>
#include <numbers>

#include "core/blocks/farfield.hpp"
#include "core/volume/corner_fan.hpp"
#include "core/volume/refine_volume.hpp"
#include "tests/blocks/sample_cages.hpp"
#include "tests/catch.hpp"

using namespace flowcage;

TEST_CASE("the nearest point of a hull") {
  const std::vector<Vec3> axes{Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ()};
  CHECK((nearest_in_hull(axes) - Vec3::Constant(1.0 / 3)).norm() < 1e-5);
  const std::vector<Vec3> edge{Vec3::UnitX(), Vec3::UnitY()};
  CHECK(nearest_in_hull(edge).norm() == Approx(std::sqrt(0.5)).epsilon(1e-6));
  const std::vector<Vec3> opposite{Vec3::UnitX(), -Vec3::UnitX(), Vec3(0, 3, 0)};
  CHECK(nearest_in_hull(opposite).norm() < 1e-6);
}

TEST_CASE("bounds of a box: .707 on edges, .577 at corners, 1 on faces") {
  const Shell shell = build_shell(sample::sharp_box_cage({2, 2, 2}), sample::sharp_box_cage({12, 12, 12}));
  const BlockMesh mesh = refine_volume(start_volume(shell, shell.wall_points, 1));
  const TopologyBound bound = topology_bound(mesh);
  CHECK(bound.min == Approx(std::sqrt(1.0 / 3)).epsilon(1e-5));
  CHECK(bound.place.cwiseAbs().maxCoeff() == Approx(bound.place.cwiseAbs().minCoeff()));
  for (std::size_t p = 0; p < mesh.points().size(); ++p) {
    const Vec3 q = mesh.points()[p].cwiseAbs();
    const double side = q.maxCoeff();
    if (std::abs(side - 2) > 1e-9 && std::abs(side - 12) > 1e-9) {
      // Three blocks meet along the lines from corner to corner.
      const bool diagonal = q.minCoeff() > side - 1e-9;
      CHECK(bound.points[p] == Approx(diagonal ? std::sin(2 * std::numbers::pi / 3) : 1).epsilon(1e-6));
      continue;
    }
    const auto sides = (q.array() > side - 1e-9).count();
    const double known = sides == 1 ? 1 : sides == 2 ? std::sqrt(0.5) : std::sqrt(1.0 / 3);
    CHECK(bound.points[p] == Approx(known).epsilon(1e-5));
  }
}

TEST_CASE("an edge of angle delta: sin(delta / 2); a lone valence of three: sin 120 degrees") {
  for (const double degrees : {20.0, 60.0, 120.0}) {
    const double half = degrees / 2 * std::numbers::pi / 180;
    const std::vector<Vec3> normals{Vec3(std::sin(half), std::cos(half), 0),
                                    Vec3(std::sin(half), -std::cos(half), 0)};
    CHECK(nearest_in_hull(normals).norm() == Approx(std::sin(half)).epsilon(1e-6));
  }
  std::vector<FanCorner> fan;
  for (Index i = 0; i < 3; ++i) {
    fan.push_back({i, (i + 1) % 3, Vec3::UnitZ(), (i == 0 ? 100 : 130) * std::numbers::pi / 180});
  }
  for (const double s : best_sines(fan))
    CHECK(s == Approx(std::sin(2 * std::numbers::pi / 3)).epsilon(1e-12));
}
