#include "core/refit/cgls.hpp"

#include <Eigen/Dense>
#include <random>

#include "core/base/parallel.hpp"
#include "core/limit/limit_stencils.hpp"
#include "core/mesh/mirror.hpp"
#include "core/refit/hierarchical_solve.hpp"
#include "tests/catch.hpp"
#include "tests/subdivide/cage_zoo.hpp"

using namespace flowcage;

namespace {

struct RandomSystem {
  StencilTable rows;
  std::vector<Vec3> right_side;
  Eigen::MatrixXd dense;
};

RandomSystem random_system(Index row_count, Index column_count, Index entries, unsigned seed) {
  std::mt19937 random(seed);
  const auto number = [&] { return 2.0 * static_cast<double>(random()) / std::mt19937::max() - 1; };
  RandomSystem s;
  s.rows.control_vertex_count = column_count;
  s.dense = Eigen::MatrixXd::Zero(row_count, column_count);
  for (Index r = 0; r < row_count; ++r) {
    std::vector<Index> columns;
    while (static_cast<Index>(columns.size()) < entries) {
      const Index c = static_cast<Index>(random() % static_cast<unsigned>(column_count));
      if (std::find(columns.begin(), columns.end(), c) == columns.end()) columns.push_back(c);
    }
    columns.front() = r % column_count;  // no empty column
    std::sort(columns.begin(), columns.end());
    columns.erase(std::unique(columns.begin(), columns.end()), columns.end());
    for (const Index c : columns) {
      s.rows.indices.push_back(c);
      s.rows.weights.push_back(number() * std::pow(10.0, c % 3));
      s.dense(r, c) = s.rows.weights.back();
    }
    s.rows.offsets.push_back(static_cast<Offset>(s.rows.indices.size()));
    s.right_side.emplace_back(number(), number(), number());
  }
  return s;
}

// An uneven half sheet, mirrored at x = 0.7 (vertices 0, 5, .. 20), its other sides open.
struct HalfSheet {
  std::vector<Vec3> points;
  SurfaceLevel level;
  StencilTable rows;
};
HalfSheet half_sheet() {
  Cage cage = zoo::grid(4, 4);
  zoo::Random random(11);
  zoo::perturb(cage, random, 0.1);
  for (Vec3& p : cage.points) p.x() += 0.7;
  for (Index v = 0; v < 25; v += 5) cage.points[v].x() = 0.7;
  SurfaceLevel level = build_surface_level(cage);
  std::vector<Index> edges;
  for (Index e = 0; e < level.edge_count(); ++e) {
    const auto [a, b] = level.edge_vertices[e];
    if (a % 5 == 0 && b % 5 == 0) edges.push_back(e);
  }
  level = mirrored(std::move(level), 0, 0.7, edges);
  StencilTable rows = oversampled_limit_stencils(level).position;
  return {std::move(cage.points), std::move(level), std::move(rows)};
}

}  // namespace

TEST_CASE("the transpose of the transpose is the matrix", "[cgls]") {
  const RandomSystem s = random_system(40, 15, 4, 1);
  const StencilTable twice = transpose_of(transpose_of(s.rows));
  CHECK(twice.offsets == s.rows.offsets);
  CHECK(twice.indices == s.rows.indices);
  CHECK(twice.weights == s.rows.weights);
}

TEST_CASE("CGLS agrees with a dense QR solution", "[cgls]") {
  const RandomSystem s = random_system(90, 25, 5, 2);
  Eigen::MatrixXd b(90, 3);
  for (int r = 0; r < 90; ++r) b.row(r) = s.right_side[r].transpose();
  const Eigen::MatrixXd exact = s.dense.colPivHouseholderQr().solve(b);

  CglsSettings settings;
  settings.max_iterations = 400;
  settings.tolerance = 1e-14;
  const std::vector<Vec3> start(25, Vec3(0.3, -0.2, 0.1));
  const CglsResult result = solve_cgls(prepare_least_squares(s.rows), s.right_side, start, settings);
  for (int c = 0; c < 25; ++c) {
    CHECK((result.solution[c].transpose() - exact.row(c)).norm() < 1e-9 * (1 + exact.row(c).norm()));
  }
  CHECK(result.residual_norm == Approx((s.dense * exact - b).norm()).epsilon(1e-9));
  // n unknowns need at most about n steps: three columns share their Krylov polynomial.
  CHECK(result.iterations <= 60);
}

TEST_CASE("CGLS in the tangent-plane metric agrees with the dense block system", "[cgls]") {
  const RandomSystem s = random_system(60, 10, 4, 3);
  RowMetric metric;
  metric.across = 0.2;
  for (Index r = 0; r < 60; ++r) {
    metric.directions.push_back(r % 7 == 0 ? Vec3(Vec3::Zero()) : Vec3(s.right_side[r].normalized()));
  }
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(180, 30);
  Eigen::VectorXd b(180);
  for (Index r = 0; r < 60; ++r) {
    Eigen::Matrix3d root = Eigen::Matrix3d::Identity();
    const Vec3& n = metric.directions[r];
    if (!n.isZero(0)) root = n * n.transpose() + 0.2 * (Eigen::Matrix3d::Identity() - n * n.transpose());
    for (Index c = 0; c < 10; ++c) a.block<3, 3>(3 * r, 3 * c) = s.dense(r, c) * root;
    b.segment<3>(3 * r) = root * s.right_side[r];
  }
  const Eigen::VectorXd exact = a.colPivHouseholderQr().solve(b);
  CglsSettings settings;
  settings.max_iterations = 500;
  settings.tolerance = 1e-14;
  const std::vector<Vec3> start(10, Vec3::Zero());
  const CglsResult result = solve_cgls(prepare_least_squares(s.rows), s.right_side, start, settings, metric);
  for (Index c = 0; c < 10; ++c) {
    CHECK((result.solution[c] - exact.segment<3>(3 * c)).norm() < 1e-8 * (1 + exact.norm()));
  }
}

TEST_CASE("damping keeps a singular system at its start, and an exact start costs nothing", "[cgls]") {
  // Two unknowns that only appear as their sum: the difference stays what it was.
  StencilTable rows;
  rows.control_vertex_count = 2;
  for (int r = 0; r < 3; ++r) {
    rows.indices.insert(rows.indices.end(), {0, 1});
    rows.weights.insert(rows.weights.end(), {0.5, 0.5});
    rows.offsets.push_back(static_cast<Offset>(rows.indices.size()));
  }
  const std::vector<Vec3> right_side(3, Vec3(1, 2, 3));
  const std::vector<Vec3> start{Vec3(1, 0, 0), Vec3(0, 0, 1)};
  CglsSettings settings;
  settings.damping = 1e-6;
  const CglsResult result = solve_cgls(prepare_least_squares(rows), right_side, start, settings);
  CHECK((0.5 * (result.solution[0] + result.solution[1]) - right_side[0]).norm() < 1e-9);
  CHECK((result.solution[0] - result.solution[1] - (start[0] - start[1])).norm() < 1e-9);

  // Iterating on rounding noise must not wander off: far from the origin, solved, then solved again.
  const RandomSystem far = random_system(90, 25, 5, 5);
  const LeastSquaresMatrix matrix = prepare_least_squares(far.rows);
  const std::vector<Vec3> truth(25, Vec3(1000, -2000, 3000.1));
  const std::vector<Vec3> exact = apply_stencils(far.rows, truth);
  CglsSettings endless;
  endless.max_iterations = 5000;
  endless.tolerance = 1e-16;
  CglsResult solved = solve_cgls(matrix, exact, truth, endless);
  for (int round = 0; round < 3; ++round) solved = solve_cgls(matrix, exact, solved.solution, endless);
  for (const Vec3& x : solved.solution) CHECK((x - truth[0]).norm() < 1e-8);

  const CglsResult again =
      solve_cgls(prepare_least_squares(rows), std::vector<Vec3>(3, Vec3(0.5, 0, 0.5)), start, settings);
  CHECK(again.iterations == 0);
  CHECK(again.solution == start);
}

TEST_CASE("CGLS gives the same bits on any number of threads", "[cgls][determinism]") {
  const RandomSystem s = random_system(6000, 1500, 6, 4);
  const LeastSquaresMatrix matrix = prepare_least_squares(s.rows);
  const std::vector<Vec3> start(1500, Vec3::Zero());
  CglsSettings settings;
  settings.max_iterations = 20;
  set_thread_count(1);
  const CglsResult one = solve_cgls(matrix, s.right_side, start, settings);
  set_thread_count(7);
  const CglsResult seven = solve_cgls(matrix, s.right_side, start, settings);
  set_thread_count(0);
  CHECK(one.solution == seven.solution);
  CHECK(one.residual_norm == seven.residual_norm);
}

TEST_CASE("stages: creases do not feel the interior, the interior sees creases fixed", "[hierarchical]") {
  // Vertices 0 corner, 1 crease, 2 interior; rows: the corner, a crease row, a smooth row of crease vertices
  // only (a coarse cage's face), a smooth row.
  StencilTable rows;
  rows.control_vertex_count = 3;
  const auto add = [&](std::vector<Index> columns, std::vector<double> weights) {
    rows.indices.insert(rows.indices.end(), columns.begin(), columns.end());
    rows.weights.insert(rows.weights.end(), weights.begin(), weights.end());
    rows.offsets.push_back(static_cast<Offset>(rows.indices.size()));
  };
  add({0}, {1});
  add({0, 1}, {0.25, 0.75});
  add({0, 1}, {0.5, 0.5});
  add({1, 2}, {0.5, 0.5});
  const std::vector<SolveStage> vertices{SolveStage::corner, SolveStage::crease, SolveStage::interior};
  const std::vector<SolveStage> samples{SolveStage::corner, SolveStage::crease, SolveStage::interior,
                                        SolveStage::interior};
  const HierarchicalSystem system = build_hierarchical_system(rows, vertices, samples);
  REQUIRE(system.stages.size() == 3);
  CHECK(system.stages[1].rows == std::vector<Index>{1});
  CHECK(system.stages[2].rows == std::vector<Index>{3});
  const std::vector<Vec3> targets{Vec3(4, 0, 0), Vec3(1, 0, 3), Vec3(9, 9, 9), Vec3(1, 1, 1)};
  const std::vector<Vec3> start(3, Vec3::Zero());
  const HierarchicalResult result = solve_hierarchical(system, targets, start, {});
  CHECK((result.control_points[0] - Vec3(4, 0, 0)).norm() < 1e-12);
  CHECK((result.control_points[1] - Vec3(0, 0, 4)).norm() < 1e-12);
  CHECK((result.control_points[2] - Vec3(2, 2, -2)).norm() < 1e-9);
}

TEST_CASE("at a mirror plane CGLS agrees with the dense system of all coordinates", "[cgls][mirror]") {
  const HalfSheet sheet = half_sheet();
  const Index rows = sheet.rows.size(), columns = sheet.rows.control_vertex_count;
  zoo::Random random(12);
  const auto vector = [&] {
    return Vec3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
  };
  std::vector<Vec3> right_side;
  RowMetric metric;
  metric.across = 0.2;
  for (Index r = 0; r < rows; ++r) {
    right_side.push_back(3 * vector());
    metric.directions.push_back(vector().normalized());  // oblique: the coordinates do not part
  }
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(3 * rows, 3 * columns);
  Eigen::VectorXd b(3 * rows);
  const std::vector<Vec3> at_start = apply_stencils(sheet.rows, sheet.points);
  for (Index r = 0; r < rows; ++r) {
    const Vec3& n = metric.directions[r];
    const Eigen::Matrix3d root = n * n.transpose() + 0.2 * (Eigen::Matrix3d::Identity() - n * n.transpose());
    for (Offset k = sheet.rows.offsets[r]; k < sheet.rows.offsets[r + 1]; ++k) {
      Vec3 weights;
      for (int axis = 0; axis < 3; ++axis) weights[axis] = sheet.rows.axis_weights(axis)[k];
      a.block<3, 3>(3 * r, 3 * sheet.rows.indices[k]) = root * weights.asDiagonal();
    }
    b.segment<3>(3 * r) = root * (right_side[r] - at_start[r]);
  }
  const Eigen::VectorXd step = a.completeOrthogonalDecomposition().solve(b);
  CglsSettings settings;
  settings.max_iterations = 2000;
  settings.tolerance = 1e-14;
  const CglsResult result =
      solve_cgls(prepare_least_squares(sheet.rows), right_side, sheet.points, settings, metric);
  for (Index c = 0; c < columns; ++c) {
    CHECK((result.solution[c] - sheet.points[c] - step.segment<3>(3 * c)).norm() < 1e-8);
    if (c % 5 == 0) CHECK(result.solution[c].x() == 0.7);  // stays in the plane to the last bit
  }
  CHECK(result.residual_norm == Approx((a * step - b).norm()).epsilon(1e-9));
}

TEST_CASE("stages at a mirror plane find the control points that the limits come from",
          "[hierarchical][mirror]") {
  // Open sides are creases that go on beyond the plane: their ends there are no corners.
  const HalfSheet sheet = half_sheet();
  const auto is_open = [&](Index e) {
    return sheet.level.is_boundary_edge(e) && sheet.level.edge_mirror_axis[e] < 0;
  };
  std::vector<SolveStage> vertices(25, SolveStage::interior);
  for (Index e = 0; e < sheet.level.edge_count(); ++e) {
    if (!is_open(e)) continue;
    for (const Index v : sheet.level.edge_vertices[e]) vertices[v] = SolveStage::crease;
  }
  vertices[4] = vertices[24] = SolveStage::corner;
  std::vector<SolveStage> samples = vertices;
  for (Index e = 0; e < sheet.level.edge_count(); ++e) {
    samples.push_back(is_open(e) ? SolveStage::crease : SolveStage::interior);
  }
  samples.resize(static_cast<std::size_t>(sheet.rows.size()), SolveStage::interior);

  const HierarchicalSystem system = build_hierarchical_system(sheet.rows, vertices, samples);
  REQUIRE(system.stages.size() == 3);
  std::vector<Vec3> start = sheet.points;
  zoo::Random random(13);
  for (Index v = 0; v < 25; ++v) {
    for (int axis = v % 5 == 0 ? 1 : 0; axis < 3; ++axis) start[v][axis] += random.uniform(-0.3, 0.3);
  }
  CglsSettings settings;
  settings.max_iterations = 500;
  settings.tolerance = 1e-13;
  const HierarchicalResult result =
      solve_hierarchical(system, apply_stencils(sheet.rows, sheet.points), start, settings);
  for (Index v = 0; v < 25; ++v) CHECK((result.control_points[v] - sheet.points[v]).norm() < 1e-10);
}
