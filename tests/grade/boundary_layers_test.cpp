#include "core/grade/boundary_layers.hpp"

#include "core/grade/wall_units.hpp"

#include <cmath>
#include <numeric>

#include "core/base/parallel.hpp"
#include "core/blocks/farfield.hpp"
#include "core/mesh/visit_cells.hpp"
#include "core/quality/jacobian.hpp"
#include "core/volume/refine_volume.hpp"
#include "core/volume/wall_columns.hpp"
#include "core/volume/wall_lines.hpp"
#include "tests/blocks/sample_cages.hpp"
#include "tests/catch.hpp"

using namespace flowcage;
using sample::box_cage;

namespace {

std::vector<double> lengths_of(std::initializer_list<double> cells) {
  std::vector<double> out{0};
  for (const double cell : cells) out.push_back(out.back() + cell);
  return out;
}

struct Sphere {
  Shell shell;
  BlockMesh mesh;
  explicit Sphere(int depth)
      : shell(build_farfield_shell(box_cage({1, 1, 1}), {OuterShape::Kind::sphere, 5}, Box3())),
        mesh(start_volume(shell, shell.wall_points, 2)) {
    for (int d = 0; d < depth; ++d) mesh = refine_volume(mesh);
    for (BoundaryPatch const& patch : mesh.patches()) {
      const double radius = patch.type == PatchType::wall ? 1 : 10;
      for (const auto& quad : patch.quads) {
        for (const Index p : quad) mesh.mutable_points()[p] = radius * mesh.points()[p].normalized();
      }
    }
    spread_lines(mesh, shell);
    for (Vec3& p : mesh.mutable_points()) p = p.normalized() * std::clamp(p.norm(), 1.0, 10.0);
  }
};

}  // namespace

TEST_CASE("cells along a line: first height, growth, then the line's own sizes") {
  std::vector<double> lengths(11);
  std::iota(lengths.begin(), lengths.end(), 0.0);
  const LayerSettings settings{0.01, 1.2, 0};
  const std::vector<double> cells = graded_cells(lengths, settings);
  CHECK(std::accumulate(cells.begin(), cells.end(), 0.0) == Approx(10).epsilon(1e-13));
  CHECK(cells[0] == 0.01);
  CHECK(cells[1] == 0.01);
  double most = 1;
  for (std::size_t k = 2; k < cells.size(); ++k) most = std::max(most, cells[k] / cells[k - 1]);
  CHECK(most <= 1.2 * (1 + 1e-9));
  CHECK(most > 1.15);  // no more cells than the growth needs: one cell's worth of slack
  for (std::size_t k = cells.size() - 4; k < cells.size(); ++k) CHECK(cells[k] == Approx(1).epsilon(0.02));
  // log(1 / .01) / log 1.2 = 25.3 cells of growth reach size 1 within 6 of the 10 lengths.
  CHECK(cells.size() == Approx(31).margin(2));
}

TEST_CASE("layers that are asked for follow the growth exactly") {
  const std::vector<double> lengths = lengths_of({1, 1, 1, 1});
  for (const Index layers : {3, 8, 12}) {
    const std::vector<double> cells = graded_cells(lengths, {1e-3, 1.3, layers});
    CHECK(cells[0] == 1e-3);
    CHECK(cells[1] == 1e-3);
    for (Index k = 2; k < layers; ++k) CHECK(cells[k] / cells[k - 1] == Approx(1.3).epsilon(1e-13));
    CHECK(std::accumulate(cells.begin(), cells.end(), 0.0) == Approx(4).epsilon(1e-13));
  }
}

TEST_CASE("a first height beyond the line's own sizes ends in the line's own cells") {
  const std::vector<double> lengths = lengths_of({0.1, 0.1, 0.1, 0.1, 0.1});
  const std::vector<double> cells = graded_cells(lengths, {0.2, 1.2, 0});
  CHECK(std::accumulate(cells.begin(), cells.end(), 0.0) == Approx(0.5).epsilon(1e-13));
  for (const double cell : cells) CHECK(cell > 0);
}

TEST_CASE("every line of a sphere starts with the first height; ends keep every bit; outer layers stay") {
  const Sphere sphere(2);
  LayerReport report;
  const BlockMesh out = insert_boundary_layers(sphere.mesh, sphere.shell, {1e-4, 1.2, 0}, report);
  CHECK(report.min_height == Approx(1e-4).epsilon(1e-3));  // facets lean a little
  CHECK(report.max_height == Approx(1e-4).epsilon(0.03));
  const WallColumns before = wall_columns(sphere.mesh, sphere.shell);
  const WallColumns after = wall_columns(out, sphere.shell);
  REQUIRE(before.lines.size() == after.lines.size());
  CHECK(after.layers == report.cells);
  double off = 0;
  for (std::size_t l = 0; l < before.lines.size(); ++l) {
    const auto old = line_positions(sphere.mesh, sphere.shell, before.lines[l], before.layers);
    const auto now = line_positions(out, sphere.shell, after.lines[l], after.layers);
    CHECK(now.front() == old.front());
    CHECK(now.back() == old.back());
    for (const Vec3& p : now) off = std::max(off, p.normalized().cross(old.front().normalized()).norm());
  }
  CHECK(off < 0.02);  // radial lines stay radial
  double least = 1;
  visit_cells(out, 0, out.cell_count(), [&](Offset, const HexPoints& cell) {
    least = std::min(least, scaled_jacobian(corners_of(out, cell)));
  });
  CHECK(least > 0.75);  // .79 at the cube's corners, where three quads meet, before layers
  set_thread_count(1);
  const BlockMesh again = insert_boundary_layers(sphere.mesh, sphere.shell, {1e-4, 1.2, 0}, report);
  set_thread_count(0);
  CHECK(std::equal(again.points().begin(), again.points().end(), out.points().begin()));
}

TEST_CASE("on the ridges of a box the height is the length along the line") {
  Cage cage = sample::sharp_box_cage({2, 2, 2});
  Cage outer = box_cage({12, 12, 12});
  const Shell shell = build_shell(cage, outer);
  BlockMesh mesh = start_volume(shell, shell.wall_points, 4);
  LayerReport report;
  const BlockMesh out = insert_boundary_layers(mesh, shell, {1e-3, 1.2, 0}, report);
  CHECK(report.min_height == Approx(1e-3).epsilon(1e-12));  // every vertex of a box is a ridge
  CHECK(report.max_height == Approx(1e-3).epsilon(1e-12));
}

TEST_CASE("first height of a y+: the one-seventh power law of a flat plate") {
  // Re = 1e7: c_f = 0.026 / 10, u_tau / U = sqrt(0.0013).
  CHECK(first_height_of_yplus(1, 1e7) == Approx(1e-7 / std::sqrt(0.0013)).epsilon(1e-14));
  CHECK(first_height_of_yplus(30, 1e7) == Approx(30 * first_height_of_yplus(1, 1e7)));
  // Heights fall with Re^(-13/14).
  CHECK(first_height_of_yplus(1, 1e6) / first_height_of_yplus(1, 1e7) == Approx(std::pow(10, 13.0 / 14)));
}
