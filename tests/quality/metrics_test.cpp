#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "core/base/parallel.hpp"
#include "core/mesh/hex_adjacency.hpp"
#include "core/quality/foam_metrics.hpp"
#include "core/quality/quality_report.hpp"
#include "tests/catch.hpp"
#include "tests/export/sample_meshes.hpp"

using namespace flowcage;
using namespace flowcage::tests;

namespace {

HexCorners unit_cube() {
  return {{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}}};
}

HexCorners mapped_cube(const std::function<Vec3(const Vec3&)>& map) {
  HexCorners hex = unit_cube();
  for (Vec3& p : hex) p = map(p);
  return hex;
}

QualityReport measure(const HexView& mesh) {
  return measure_quality(mesh, build_hex_adjacency(mesh));
}

}  // namespace

TEST_CASE("Jacobians of a box are its volume, and its scaled Jacobian is 1") {
  const HexCorners box = mapped_cube([](const Vec3& p) { return Vec3(2 * p.x(), 3 * p.y(), 1e-6 * p.z()); });
  for (const double j : corner_jacobians(box)) CHECK(j == Approx(6e-6).epsilon(1e-14));
  const HexCorners tiny = mapped_cube([](const Vec3& p) { return Vec3(1e-120 * p); });
  CHECK(scaled_jacobian(tiny) == Approx(1));
  CHECK_FALSE(is_inverted(tiny));
  CHECK(scaled_jacobian(box) == Approx(1).margin(1e-15));
  CHECK_FALSE(is_inverted(box));
}

TEST_CASE("A parallelepiped's scaled Jacobian is the sine of its angle") {
  for (const double degrees : {80.0, 45.0, 10.0, 1.0}) {
    const double angle = degrees * std::numbers::pi / 180;
    const HexCorners sheared = mapped_cube(
        [&](const Vec3& p) { return Vec3(p.x() + std::cos(angle) * p.y(), std::sin(angle) * p.y(), p.z()); });
    CHECK(scaled_jacobian(sheared) == Approx(std::sin(angle)).epsilon(1e-12));
  }
}

TEST_CASE("A corner pushed through its cell inverts it") {
  // Corner 6 at (t, t, t) has edges (t, t-1, t-1) and so on: Jacobian of the corner = t^3 - ... = 3t - 2.
  for (const double t : {0.9, 0.7, 0.66, 0.5}) {
    HexCorners hex = unit_cube();
    hex[6] = Vec3(t, t, t);
    CHECK(corner_jacobians(hex)[6] == Approx(3 * t - 2).margin(1e-14));
    CHECK(is_inverted(hex) == (3 * t - 2 <= 0));
  }
  HexCorners flat = unit_cube();
  flat[6] = Vec3(2.0 / 3, 2.0 / 3, 2.0 / 3);
  CHECK(std::abs(scaled_jacobian(flat)) < 1e-15);
}

TEST_CASE("Corner Jacobians and the verdict agree on random hexes") {
  std::mt19937 random(9);
  std::uniform_real_distribution<double> move(-0.6, 0.6);
  for (int round = 0; round < 1000; ++round) {
    const HexCorners hex =
        mapped_cube([&](const Vec3& p) { return Vec3(p + Vec3(move(random), move(random), move(random))); });
    const auto jacobians = corner_jacobians(hex);
    const double least = *std::min_element(jacobians.begin(), jacobians.end());
    CHECK(is_inverted(hex) == (least <= 0));
    if (least <= 0) CHECK(scaled_jacobian(hex) <= 0);
  }
}

TEST_CASE("Collapsed, mirrored and non-finite cells are inverted") {
  HexCorners collapsed = unit_cube();
  collapsed[1] = collapsed[0];
  CHECK(is_inverted(collapsed));
  CHECK(scaled_jacobian(collapsed) <= 0);
  const HexCorners mirrored = mapped_cube([](const Vec3& p) { return Vec3(-p.x(), p.y(), p.z()); });
  CHECK(is_inverted(mirrored));
  CHECK(scaled_jacobian(mirrored) == Approx(-1));
  HexCorners broken = unit_cube();
  broken[3].y() = std::numeric_limits<double>::quiet_NaN();
  CHECK(is_inverted(broken));
  CHECK(scaled_jacobian(broken) == -1);
}

TEST_CASE("OpenFOAM's figures of shapes with known answers") {
  SECTION("a box a x b x c") {
    const CellGeometry cell =
        cell_geometry(mapped_cube([](const Vec3& p) { return Vec3(2 * p.x(), 3 * p.y(), 4 * p.z()); }));
    CHECK(cell.volume == Approx(24).epsilon(1e-14));
    CHECK((cell.centre - Vec3(1, 1.5, 2)).norm() < 1e-14);
    CHECK(cell_openness(cell) < 1e-15);
    CHECK(cell_aspect_ratio(cell) == Approx(2).epsilon(1e-14));  // 3x4 face over 2x3 face
  }
  SECTION("a square pyramid frustum's volume and centre") {
    // Base 2x2 at z=0, top 1x1 at z=1: V = (4+2+1)/3; z of the centre = int z (2-z)^2 dz / V = 11/12 / (7/3).
    const CellGeometry cell = cell_geometry(mapped_cube([](const Vec3& p) {
      const double w = 2 - p.z();
      return Vec3(w * (p.x() - 0.5), w * (p.y() - 0.5), p.z());
    }));
    CHECK(cell.volume == Approx(7.0 / 3).epsilon(1e-14));
    CHECK(cell.centre.z() == Approx(11.0 / 12 / (7.0 / 3)).epsilon(1e-14));
  }
  SECTION("skewness of a displaced neighbour") {
    const std::array<Vec3, 4> quad{{{1, 0, 0}, {1, 1, 0}, {1, 1, 1}, {1, 0, 1}}};
    const FaceGeometry face = face_geometry(quad);
    CHECK(face_skewness(quad, face, {Vec3(0.5, 0.5, 0.5), Vec3(1.5, 0.5, 0.5)}) == Approx(0).margin(1e-15));
    // The line crosses the face's plane at y = 0.75; the face reaches 0.5 in that direction.
    CHECK(face_skewness(quad, face, {Vec3(0.5, 0.5, 0.5), Vec3(1.5, 1.0, 0.5)}) ==
          Approx(0.5).epsilon(1e-14));
    CHECK(face_orthogonality({1, 0, 0}, {0.5, 0.5, 0.5}, {1.5, 1.5, 0.5}) ==
          Approx(std::sqrt(0.5)).epsilon(1e-14));
  }
}

TEST_CASE("A sheared box has its shear's angle as non-orthogonality everywhere") {
  // y runs along (tan a, 1, 0): the normals of the i-faces turn by a, and so do the j lines.
  const double a = 35 * std::numbers::pi / 180;
  const HexMesh mesh =
      box_mesh({5, 4, 3}, [&](const Vec3& p) { return Vec3(p.x() + std::tan(a) * p.y(), p.y(), p.z()); });
  const QualityReport report = measure(mesh);
  CHECK(report.non_orthogonality.max == Approx(35).epsilon(1e-10));
  CHECK(report.total_volume == Approx(1).epsilon(1e-13));
  CHECK(report.inverted_cells == 0);
  CHECK(report.scaled_jacobian.min == Approx(std::cos(a)).epsilon(1e-12));
  CHECK(report.scaled_jacobian.mean == Approx(std::cos(a)).epsilon(1e-12));
  CHECK(check_mesh_failures(report).empty());
}

TEST_CASE("Counts, histograms and lists of worst cells") {
  HexMesh mesh = box_mesh({6, 6, 6}, [](const Vec3& p) {
    const bool moved = (p - Vec3(0.5, 0.5, 0.5)).norm() < 1e-9;
    return moved ? Vec3(0.5 + 0.4, 0.5, 0.5) : p;  // past the next grid plane
  });
  const QualityReport report = measure(mesh);
  CHECK(report.cells == 216);
  CHECK(report.points == 343);
  CHECK(report.internal_faces == 3 * 5 * 36);
  CHECK(report.boundary_faces == 6 * 36);
  CHECK(report.inverted_cells == 4);  // those on the +x side of the moved point
  CHECK(report.total_volume == Approx(1).epsilon(1e-12));
  CHECK(report.scaled_jacobian.min < 0);
  const auto sum = [](const Histogram& h) {
    Offset n = 0;
    for (const Offset c : h.counts) n += c;
    return n;
  };
  CHECK(sum(report.scaled_jacobian.histogram) == 216);
  CHECK(sum(report.aspect_ratio.histogram) == 216);
  CHECK(sum(report.non_orthogonality.histogram) == 540);
  CHECK(sum(report.skewness.histogram) == 756);
  REQUIRE(report.scaled_jacobian.worst.size() == 10);
  for (std::size_t i = 0; i < 4; ++i) {
    const WorstCell& w = report.scaled_jacobian.worst[i];
    CHECK(w.value < 0);
    CHECK((w.place - Vec3(0.6, 0.5, 0.5)).norm() < 0.3);
  }
  CHECK(report.scaled_jacobian.worst[0].value == report.scaled_jacobian.min);
  CHECK_FALSE(check_mesh_failures(report).empty());
}

TEST_CASE("The same report for any thread count, point order and cell order") {
  const HexMesh mesh = perturbed_box({40, 40, 40}, 0.006);
  set_thread_count(1);
  const QualityReport one = measure(mesh);
  for (const int threads : {2, 7}) {
    set_thread_count(threads);
    const QualityReport many = measure(mesh);
    CHECK(many.scaled_jacobian.mean == one.scaled_jacobian.mean);
    CHECK(many.non_orthogonality.mean == one.non_orthogonality.mean);
    CHECK(many.skewness.mean == one.skewness.mean);
    CHECK(many.total_volume == one.total_volume);
    for (std::size_t i = 0; i < one.skewness.worst.size(); ++i) {
      CHECK(many.skewness.worst[i].cell == one.skewness.worst[i].cell);
      CHECK(many.skewness.worst[i].value == one.skewness.worst[i].value);
    }
  }
  set_thread_count(0);
  const QualityReport other = measure(shuffled(mesh, 7));
  CHECK(other.scaled_jacobian.min == Approx(one.scaled_jacobian.min).epsilon(1e-12));
  CHECK(other.skewness.max == Approx(one.skewness.max).epsilon(1e-12));
  CHECK(other.non_orthogonality.max == Approx(one.non_orthogonality.max).epsilon(1e-12));
  CHECK(other.total_volume == Approx(one.total_volume).epsilon(1e-13));
}

TEST_CASE("A coordinate that is no number is counted, not passed on") {
  const HexMesh mesh = box_mesh({3, 3, 3}, [](const Vec3& p) {
    return (p - Vec3(1, 1, 1) / 3).norm() < 1e-9 ? Vec3(std::nan(""), 0, 0) : p;
  });
  const QualityReport report = measure(mesh);
  CHECK(report.inverted_cells == 8);
  CHECK(report.scaled_jacobian.min == -1);
  CHECK(std::isfinite(report.scaled_jacobian.mean));
  CHECK(std::isfinite(report.non_orthogonality.mean));
  CHECK_FALSE(check_mesh_failures(report).empty());
}

TEST_CASE("Adjacency finds what is wrong with a boundary, and where") {
  const HexMesh good = box_mesh({2, 2, 2});
  std::vector<HexPoints> cells(8);
  good.read_cells(0, cells);
  const std::vector<Vec3> points(good.points().begin(), good.points().end());
  auto patches = good.patches();
  const auto adjacency_of = [&] { return build_hex_adjacency(HexMesh(points, cells, patches)); };
  CHECK(adjacency_of().internal_faces == 12);
  SECTION("a quad is missing") {
    patches[0].quads.pop_back();
    CHECK_THROWS_WITH(adjacency_of(), Catch::Contains("belong to no patch") && Catch::Contains("(0, 0.75"));
  }
  SECTION("a quad is there twice") {
    patches[1].quads.push_back(patches[0].quads[0]);
    CHECK_THROWS_WITH(adjacency_of(), Catch::Contains("listed 2 times"));
  }
  SECTION("a quad lies inside") {
    patches[1].quads.push_back({cells[0][1], cells[0][2], cells[0][6], cells[0][5]});
    CHECK_THROWS_WITH(adjacency_of(), Catch::Contains("between two cells"));
  }
  SECTION("a quad of no cell") {
    patches[1].quads.push_back({0, 1, 7, 26});
    CHECK_THROWS_WITH(adjacency_of(), Catch::Contains("no cell's face"));
  }
  SECTION("a cell is there twice") {
    cells.push_back(cells[0]);
    CHECK_THROWS_WITH(adjacency_of(), Catch::Contains("between two cells") || Catch::Contains("shared by 3"));
  }
  SECTION("a point number out of range") {
    cells[3][2] = 27;
    CHECK_THROWS_WITH(adjacency_of(), Catch::Contains("cell 3 uses point 27"));
  }
}
