#include "core/volume/wall_lines.hpp"

#include "core/base/parallel.hpp"
#include "core/blocks/farfield.hpp"
#include "core/mesh/visit_cells.hpp"
#include "core/quality/jacobian.hpp"
#include "core/subdivide/refine.hpp"
#include "core/volume/leaning_lines.hpp"
#include "core/volume/refine_volume.hpp"
#include "core/volume/wall_columns.hpp"
#include "core/volume/wall_normals.hpp"
#include "tests/blocks/sample_cages.hpp"
#include "tests/catch.hpp"

using namespace flowcage;
using sample::box_cage;

namespace {

/// A shell refined `depth` times, with the cage's levels refined by core/subdivide beside it.
struct Refined {
  Shell shell;
  BlockMesh mesh;
  SurfaceLevel level, outer_level;
  std::vector<Vec3> wall, outer;

  Refined(Shell s, int depth, Index layers = 1)
      : shell(std::move(s)),
        mesh(start_volume(shell, shell.wall_points, layers)),
        level(shell.wall),
        outer_level(shell.outer),
        wall(shell.wall_points),
        outer(shell.outer_points) {
    for (int d = 0; d < depth; ++d) {
      mesh = refine_volume(mesh);
      wall = apply_stencils(refinement_stencils(level), wall);
      outer = apply_stencils(refinement_stencils(outer_level), outer);
      level = build_child_level(level);
      outer_level = build_child_level(outer_level);
    }
  }
};

double min_scaled_jacobian(const HexView& mesh) {
  double least = 1;
  visit_cells(mesh, 0, mesh.cell_count(), [&](Offset, const HexPoints& cell) {
    least = std::min(least, scaled_jacobian(corners_of(mesh, cell)));
  });
  return least;
}

Cage half_box(const Vec3& size, double plane) {
  Cage cage = box_cage(size, true);
  for (Vec3& p : cage.points) p.y() = p.y() < 0 ? plane : plane + size.y();
  return cage;
}

}  // namespace

TEST_CASE("the volume's boundary is the surface that core/subdivide refines") {
  Cage creased = box_cage({1, 1, 1});
  creased.creases = {{0, 1, 10}, {1, 3, 2.5}, {3, 7, 0.3}, {4, 5, 1}};
  creased.corners = {{6, 1.5}};
  Cage outer = box_cage({4, 3, 3});
  outer.creases = {{0, 1, 10}, {1, 5, 10}, {5, 4, 10}, {4, 0, 10}, {2, 3, 1.7}};
  const Cage half = half_box({1, 1, 1}, 0.3);
  const Cage half_outer = half_box({5, 5, 5}, 0.3);
  const std::pair<Cage, Cage> pairs[] = {{creased, outer},
                                         {sample::prism_cage(5, 1, 1), sample::prism_cage(5, 4, 3)},
                                         {sample::torus_cage(6, 4, 3, 1), sample::torus_cage(6, 4, 3, 2)},
                                         {half, half_outer}};
  for (const auto& [in, out] : pairs) {
    for (int depth = 0; depth <= 4; ++depth) {
      const Refined r(build_shell(in, out), depth);
      const auto lines = wall_lines(r.shell, r.level);
      const auto wall = layer_points(r.mesh, r.shell, lines, 0);
      const auto outside = layer_points(r.mesh, r.shell, lines, r.mesh.chord_divisions()[r.shell.k_chord]);
      double worst = 0;
      for (std::size_t v = 0; v < wall.size(); ++v) {
        worst = std::max(worst, (r.mesh.points()[wall[v]] - r.wall[v]).norm());
        worst = std::max(worst, (r.mesh.points()[outside[v]] - r.outer[v]).norm());
      }
      CHECK(worst < 1e-14);
    }
  }
}

TEST_CASE("a sphere's shell has no inverted cell to level 4") {
  for (int depth = 0; depth <= 4; ++depth) {
    Refined r(build_shell(box_cage({1, 1, 1}), box_cage({6, 6, 6})), depth, 2);
    for (auto* side : {&r.wall, &r.outer}) {
      const double radius = side == &r.wall ? 1 : 6;
      for (Vec3& p : *side) p *= radius / p.norm();
    }
    place_boundary(r.mesh, r.shell, r.level, {r.wall, r.outer});
    CHECK(min_scaled_jacobian(r.mesh) > 0.4);
    const auto wall = layer_points(r.mesh, r.shell, wall_lines(r.shell, r.level), 0);
    for (std::size_t v = 0; v < wall.size(); ++v) CHECK(r.mesh.points()[wall[v]] == r.wall[v]);
    spread_lines(r.mesh, r.shell);
    CHECK(min_scaled_jacobian(r.mesh) > 0.4);
  }
}

TEST_CASE("tori joined: no inverted cell") {
  Refined r(build_shell(sample::torus_cage(8, 4, 3, 1), sample::torus_cage(8, 4, 3, 2)), 2);
  CHECK(min_scaled_jacobian(r.mesh) > 0.5);
}

TEST_CASE("a half model's symmetry plane stays flat to the last bit through every step") {
  for (const double plane : {0.0, 0.1, -7.0 / 3}) {
    Refined r(build_shell(half_box({1, 1, 1}, plane), half_box({5, 5, 5}, plane)), 3, 2);
    const auto check = [&] {
      const BoundaryPatch& patch = r.mesh.patches().back();
      REQUIRE(patch.name == "symmetry");
      REQUIRE(patch.quads.size() == 4 * 8 * 16);
      for (const auto& q : patch.quads) {
        for (const Index v : q) REQUIRE(r.mesh.points()[v].y() == plane);
      }
    };
    check();
    for (std::size_t v = 0; v < r.wall.size(); ++v)
      r.wall[v] += Vec3(0.01, 1e-7 * static_cast<double>(v % 3), 0.02);
    place_boundary(r.mesh, r.shell, r.level, {r.wall, {}});
    check();
    spread_lines(r.mesh, r.shell);
    check();
  }
}

TEST_CASE("boundary displacements fall evenly to zero along the lines") {
  Refined r(build_shell(box_cage({1, 1, 1}), box_cage({4, 4, 4})), 2);
  const BlockMesh before = r.mesh;
  const Vec3 shift(0.1, -0.05, 0.2);
  std::vector<Vec3> moved = r.wall;
  for (Vec3& p : moved) p += shift;
  place_boundary(r.mesh, r.shell, r.level, {moved, {}});
  const auto lines = wall_lines(r.shell, r.level);
  for (Index k = 0; k <= 4; ++k) {
    for (const Index p : layer_points(r.mesh, r.shell, lines, k)) {
      CHECK((r.mesh.points()[p] - before.points()[p] - (1 - k / 4.0) * shift).norm() < 1e-14);
    }
  }
}

TEST_CASE("cells along a line: two of the first size, then geometric, filling the length") {
  const auto cells = geometric_cells(10, 20, 0.01, 3);
  double sum = 0;
  for (const double c : cells) sum += c;
  CHECK(sum == Approx(10).epsilon(1e-14));
  CHECK(cells[0] == 0.01);
  CHECK(cells[1] == 0.01);
  const double ratio = cells[2] / cells[1];
  for (std::size_t k = 2; k < 20; ++k) CHECK(cells[k] / cells[k - 1] == Approx(ratio).epsilon(1e-10));

  // The first cell is enlarged where the growth would be too large.
  const auto enlarged = geometric_cells(10, 20, 1e-9, 1.5);
  for (std::size_t k = 2; k < 20; ++k) CHECK(enlarged[k] / enlarged[k - 1] == Approx(1.5).epsilon(1e-9));
  CHECK(enlarged[0] > 1e-9);

  for (const double c : geometric_cells(10, 20, 1, 1.5)) CHECK(c == 0.5);  // no room for growth: even cells
}

TEST_CASE("spreading gives the same bits on any number of threads") {
  Refined one(build_shell(box_cage({1, 2, 1}), box_cage({6, 6, 6})), 3);
  Refined four = one;
  set_thread_count(1);
  spread_lines(one.mesh, one.shell);
  set_thread_count(4);
  spread_lines(four.mesh, four.shell);
  set_thread_count(0);
  CHECK(std::equal(one.mesh.points().begin(), one.mesh.points().end(), four.mesh.points().begin()));
}

TEST_CASE("volumes between bodies and their grown far fields have no inverted cell") {
  for (const auto kind : {OuterShape::Kind::sphere, OuterShape::Kind::box}) {
    for (const Cage& cage : {box_cage({1, 0.2, 2}), sample::wing_cage(), sample::prism_cage(6, 1, 3)}) {
      Refined r(build_farfield_shell(cage, {kind, 20}, Box3()), 3, 2);
      place_boundary(r.mesh, r.shell, r.level, {r.wall, outer_points(r.shell, 3, true)});
      CHECK(min_scaled_jacobian(r.mesh) > 0);
      spread_lines(r.mesh, r.shell);
      CHECK(min_scaled_jacobian(r.mesh) > 0);
    }
  }
}

TEST_CASE("lines are turned to the wall's normals without harm to any cell") {
  for (const double plane : {0.0, 0.1}) {
    Cage wing = sample::wing_cage();
    for (Vec3& p : wing.points) p.y() += plane;
    Refined r(build_farfield_shell(wing, {OuterShape::Kind::sphere, 20}, Box3()), 2, 4);
    place_boundary(r.mesh, r.shell, r.level, {r.wall, outer_points(r.shell, 2, true)});
    spread_lines(r.mesh, r.shell);
    const BlockMesh before = r.mesh;
    const NormalReport report = turn_lines_to_wall(r.mesh, r.shell, {});
    CHECK(report.mean_cosine_before < 0.8);
    CHECK(report.mean_cosine > report.mean_cosine_before + 0.15);
    CHECK(report.min_cosine > 0);
    CHECK(report.mean_reach > 0.01);
    double sum_before = 0;
    double sum = 0;
    visit_cells(r.mesh, 0, r.mesh.cell_count(), [&](Offset, const HexPoints& cell) {
      const auto corners = [&](const BlockMesh& mesh) {
        const auto jacobians = corner_jacobians(corners_of(mesh, cell));
        return *std::min_element(jacobians.begin(), jacobians.end());
      };
      CHECK(corners(r.mesh) > 0);
      const double was = scaled_jacobian(corners_of(before, cell));
      const double is = scaled_jacobian(corners_of(r.mesh, cell));
      REQUIRE(is >= std::min(0.3, 0.9 * was) - 1e-6);
      sum_before += was;
      sum += is;
    });
    CHECK(sum > sum_before);
    for (const BoundaryPatch& patch : r.mesh.patches()) {
      for (const auto& quad : patch.quads) {
        for (const Index v : quad) {
          if (patch.type == PatchType::symmetry) {
            REQUIRE(r.mesh.points()[v].y() == plane);
          } else {
            REQUIRE(r.mesh.points()[v] == before.points()[v]);
          }
        }
      }
    }
    set_thread_count(1);
    BlockMesh again = before;
    turn_lines_to_wall(again, r.shell, {});
    set_thread_count(0);
    CHECK(std::equal(again.points().begin(), again.points().end(), r.mesh.points().begin()));
  }
}

TEST_CASE("lines that are normal to the wall stay") {
  Refined r(build_shell(box_cage({1, 1, 1}), box_cage({6, 6, 6})), 3, 2);
  for (auto* side : {&r.wall, &r.outer}) {
    for (Vec3& p : *side) p *= (side == &r.wall ? 1 : 6) / p.norm();
  }
  place_boundary(r.mesh, r.shell, r.level, {r.wall, r.outer});
  for (Vec3& p : r.mesh.mutable_points()) p = p.normalized() * std::clamp(p.norm(), 1.0, 6.0);
  const NormalReport report = turn_lines_to_wall(r.mesh, r.shell, {});
  CHECK(report.min_cosine_before > 0.97);
  CHECK(report.min_cosine >= report.min_cosine_before);
  CHECK(report.mean_reach == Approx(0.25));
}

TEST_CASE("enough layers for a gentle growth") {
  const Shell shell = build_farfield_shell(box_cage({1, 1, 1}), {OuterShape::Kind::sphere, 20}, Box3());
  for (const int refinements : {2, 3, 4}) {
    const Index layers = layers_for_growth(shell, refinements, 1.25);
    for (const Index n : {layers, layers - 1}) {
      if (n == 0) continue;
      const auto cells =
          geometric_cells(40 - std::sqrt(3.0), n << refinements, 2.0 / (1 << refinements), 100);
      const double growth = cells[3] / cells[2];
      CHECK((growth <= 1.25) == (n == layers));
    }
  }
}

namespace {

/// A lens of four sharp edges along z, two of them (at x = 1 and -1) with an angle of 11 degrees.
Cage sharp_lens() {
  Cage cage = sample::prism_cage(4, 1, 1);
  for (Vec3& p : cage.points) p.y() *= 0.1;
  for (Index f = 0; f < static_cast<Index>(cage.faces.size()); ++f) {
    const auto face = cage.faces[f];
    for (std::size_t c = 0; c < face.size(); ++c) {
      const auto [low, high] = std::minmax(face[c], face[(c + 1) % face.size()]);
      const bool there = std::any_of(cage.creases.begin(), cage.creases.end(),
                                     [&](const auto& e) { return e.a == low && e.b == high; });
      if (!there) cage.creases.push_back({low, high, 10});
    }
  }
  return cage;
}

}  // namespace

TEST_CASE("lines that lean over the faces beside a sharp edge start with short cells") {
  Refined lens(build_shell(sharp_lens(), sample::prism_cage(4, 12, 8)), 2);
  place_boundary(lens.mesh, lens.shell, lens.level, {lens.wall, lens.outer});
  turn_lines_to_wall(lens.mesh, lens.shell, {});
  const WallColumns columns = wall_columns(lens.mesh, lens.shell);
  const std::vector<float> before = column_values(lens.mesh, lens.shell, columns);
  const std::vector<Vec3> start(lens.mesh.points().begin(), lens.mesh.points().end());
  const LeanSettings settings;
  CHECK(shorten_leaning_lines(lens.mesh, lens.shell, settings) > 0);

  const std::vector<float> after = column_values(lens.mesh, lens.shell, columns);
  for (std::size_t n = 0; n < after.size(); ++n) {
    CAPTURE(n);
    CHECK(after[n] >= std::min(settings.good_enough, settings.keep * before[n]) * (1 - 1e-6));
  }
  const auto at = [&](Index l, Index k) { return line_point(lens.mesh, lens.shell, columns.lines[l], k); };
  double worst_before = 0, worst = 0;  // shift of the first cell in lengths of the wall's edge behind
  for (const auto& [a, b] : columns.edges) {
    for (const auto& [foot, behind] : {std::pair{a, b}, std::pair{b, a}}) {
      const Vec3 edge = lens.mesh.points()[at(foot, 0)] - lens.mesh.points()[at(behind, 0)];
      const auto shift = [&](const Vec3& end) {
        return (end - lens.mesh.points()[at(foot, 0)]).dot(edge) / edge.squaredNorm();
      };
      worst_before = std::max(worst_before, shift(start[at(foot, 1)]));
      worst = std::max(worst, shift(lens.mesh.points()[at(foot, 1)]));
    }
  }
  CHECK(worst_before > 4);
  CHECK(worst < 2.7);  // most_lean but for lines whose cells would lose too much
  for (Index l = 0; l < static_cast<Index>(columns.lines.size()); ++l) {
    CHECK(lens.mesh.points()[at(l, 0)] == start[at(l, 0)]);
    CHECK(lens.mesh.points()[at(l, columns.layers)] == start[at(l, columns.layers)]);
  }
}
