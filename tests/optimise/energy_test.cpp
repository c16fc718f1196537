#include "core/base/parallel.hpp"
#include "core/optimise/foldover_energy.hpp"
#include "core/optimise/lbfgs.hpp"
#include "core/optimise/target_lengths.hpp"
#include "tests/catch.hpp"
#include "tests/optimise/sample_meshes.hpp"

using namespace flowcage;

namespace {

struct Setup {
  FoldoverProblem problem;
  std::vector<Vec3> positions;
};

/// Every point moves.
Setup setup_of(const BlockMesh& mesh) {
  Setup out;
  out.positions.assign(mesh.points().begin(), mesh.points().end());
  FoldoverProblem& problem = out.problem;
  problem.cells.resize(static_cast<std::size_t>(mesh.cell_count()));
  mesh.read_cells(0, problem.cells);
  for (std::size_t p = 0; p < out.positions.size(); ++p) problem.moving.push_back(static_cast<Index>(p));
  problem.moving_corners =
      corners_of_points(problem.cells, problem.moving, static_cast<Index>(out.positions.size()));
  problem.kinds.resize(problem.cells.size());
  const std::vector<std::uint8_t> moves(out.positions.size(), 1);
  problem.inverse_lengths = inverse_target_lengths(out.positions, problem.cells, moves, {});
  return out;
}

}  // namespace

TEST_CASE("foldover energy: 3 + 2 lambda on target cells, whatever their lengths") {
  BlockMesh mesh = sample::box_mesh({3, 2, 4});
  sample::map_points(mesh,
                     [](const Vec3& p) { return Vec3(std::exp(p[0]), 1e-3 * p[1], std::pow(1.7, p[2])); });
  const Setup s = setup_of(mesh);
  std::vector<Vec3> gradient(s.positions.size());
  for (const int exponent : {1, 4}) {
    const EnergyValue value = evaluate_energy(s.problem, s.positions, {0.3, 0, 1, exponent}, gradient);
    CHECK(value.energy == Approx(3.6).epsilon(1e-6));
    CHECK(value.min_determinant == Approx(1).epsilon(1e-6));
  }
}

TEST_CASE("foldover energy: the gradient agrees with central differences") {
  std::mt19937 random(5);
  BlockMesh mesh = sample::box_mesh({3, 3, 2});
  Setup s = setup_of(mesh);
  for (const double shake : {0.15, 0.8}) {
    sample::shake(mesh, shake, random);
    for (Vec3& p : mesh.mutable_points())
      p += 0.02 * Vec3(std::sin(7 * p[1]), std::cos(5 * p[2]), std::sin(3 * p[0]));
    s.positions.assign(mesh.points().begin(), mesh.points().end());
    for (std::size_t n = 0; n < s.problem.kinds.size(); ++n) {
      s.problem.kinds[n] = {n % 3 == 0, n % 5 == 4};
    }
    std::vector<EnergyParameters> cases{{0.3, 0.4, 0.9, 1}, {1.0, 0.05, 0.5, 3}};
    if (shake < 0.5) cases.push_back({0.3, 0, 0.5, 4});
    for (const EnergyParameters& parameters : cases) {
      std::vector<Vec3> gradient(s.positions.size());
      REQUIRE(std::isfinite(evaluate_energy(s.problem, s.positions, parameters, gradient).energy));
      double largest = 0;
      for (const Vec3& g : gradient) largest = std::max(largest, g.norm());
      for (std::size_t p = 0; p < s.positions.size(); ++p) {
        for (int a = 0; a < 3; ++a) {
          const double h = 1e-6;
          std::array<double, 2> value{};
          for (const int side : {0, 1}) {
            std::vector<Vec3> moved = s.positions;
            moved[p][a] += side == 0 ? -h : h;
            value[side] = evaluate_energy(s.problem, moved, parameters, {}).energy;
          }
          CHECK(gradient[p][a] ==
                Approx((value[1] - value[0]) / (2 * h)).margin(1e-5 * largest).epsilon(1e-5));
        }
      }
    }
  }
}

TEST_CASE("foldover energy: infinite at an inverted corner without epsilon, finite in hopeless cells") {
  BlockMesh mesh = sample::box_mesh({2, 1, 1});
  mesh.mutable_points()[mesh.point_number(0, 0, 0, 0)] = Vec3(3, 3, 3);
  Setup s = setup_of(mesh);
  CHECK(std::isinf(evaluate_energy(s.problem, s.positions, {0.3, 0, 0.1, 1}, {}).energy));
  s.problem.kinds[0].hopeless = true;
  const EnergyValue value = evaluate_energy(s.problem, s.positions, {0.3, 0, 0.1, 4}, {});
  CHECK(std::isfinite(value.energy));
  CHECK(value.min_determinant > 0);
}

TEST_CASE("target lengths: bad cells' edges are filled in across the layer, growth is kept") {
  const Index layers = 6;
  BlockMesh mesh = sample::box_mesh({9, 9, layers});
  const auto height = [](double k) { return (std::pow(1.5, k) - 1) / 0.5; };
  sample::map_points(mesh, [&](const Vec3& p) { return Vec3(p[0], p[1], height(p[2])); });
  mesh.mutable_points()[mesh.point_number(0, 4, 4, 3)] += Vec3(0.1, 0.2, -6);
  Setup s = setup_of(mesh);
  for (std::size_t n = 0; n < s.problem.cells.size(); ++n) {
    const auto k = static_cast<Index>(n) / 81;
    for (int e = 0; e < 12; ++e) {
      const double length = 1 / static_cast<double>(s.problem.inverse_lengths[n][e]);
      CHECK(length == Approx(e < 8 ? 1 : std::pow(1.5, k)).epsilon(1e-4));
    }
  }
  const std::vector<std::uint8_t> moves(s.positions.size(), 1);
  TargetLengthSettings cubes;
  cubes.shape = TargetShape::equal_cubes;
  const auto inverse = inverse_target_lengths(s.positions, s.problem.cells, moves, cubes);
  const double size = std::cbrt(height(layers) / layers);
  CHECK(1 / static_cast<double>(inverse[0][0]) == Approx(size).epsilon(0.02));
}

TEST_CASE("L-BFGS: the quadratic's solution, Rosenbrock's valley, and a barrier that is never crossed") {
  LbfgsSettings settings;
  settings.max_iterations = 400;
  settings.relative_decrease = 0;
  const LbfgsPreconditioner identity = [](std::span<Vec3>) {};

  std::vector<Vec3> x(5, Vec3(3, -2, 1));
  const LbfgsFunction quadratic = [](std::span<const Vec3> at, std::span<Vec3> gradient) {
    double value = 0;
    for (std::size_t n = 0; n < at.size(); ++n) {
      const double stiffness = std::pow(10.0, static_cast<double>(n));
      gradient[n] = stiffness * (at[n] - Vec3(1, 2, 3));
      value += 0.5 * stiffness * (at[n] - Vec3(1, 2, 3)).squaredNorm();
    }
    return value;
  };
  minimise_lbfgs(quadratic, identity, settings, x);
  for (const Vec3& p : x) CHECK((p - Vec3(1, 2, 3)).norm() < 1e-6);

  std::vector<Vec3> r{Vec3(-1.2, 1, 0)};
  const LbfgsFunction rosenbrock = [](std::span<const Vec3> at, std::span<Vec3> gradient) {
    const double a = 1 - at[0][0];
    const double b = at[0][1] - at[0][0] * at[0][0];
    gradient[0] = Vec3(-2 * a - 400 * b * at[0][0], 200 * b, 0);
    return a * a + 100 * b * b;
  };
  minimise_lbfgs(rosenbrock, identity, settings, r);
  CHECK((r[0] - Vec3(1, 1, 0)).norm() < 1e-5);

  std::vector<Vec3> b{Vec3(5, 0, 0)};
  const LbfgsFunction barrier = [](std::span<const Vec3> at, std::span<Vec3> gradient) {
    gradient[0] = Vec3(1 - 1e-4 / at[0][0], 0, 0);
    return at[0][0] > 0 ? at[0][0] - 1e-4 * std::log(at[0][0]) : std::numeric_limits<double>::infinity();
  };
  minimise_lbfgs(barrier, identity, settings, b);
  CHECK(b[0][0] == Approx(1e-4).epsilon(1e-3));
}
