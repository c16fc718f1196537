#include "core/blocks/shell.hpp"

#include <fmt/format.h>

#include "core/base/error.hpp"
#include "core/blocks/enclosure.hpp"
#include "core/subdivide/refine.hpp"
#include "tests/blocks/sample_cages.hpp"
#include "tests/blocks/sample_complexes.hpp"
#include "tests/catch.hpp"

using namespace flowcage;
using sample::box_cage;
using sample::contains;
using sample::message_of;
using sample::scaled;

namespace {

std::vector<std::string> patch_names(const Shell& shell) {
  std::vector<std::string> names;
  for (const auto& p : shell.complex->patches) names.push_back(p.name);
  return names;
}

}  // namespace

TEST_CASE("shell: a box in a box") {
  const Shell shell = build_shell(box_cage({1, 1, 1}), box_cage({3, 3, 3}));
  CHECK(shell.complex->hexes.size() == 6);
  CHECK(shell.complex->points.size() == 16);
  CHECK(shell.complex->edges.size() == 12 + 12 + 8);
  CHECK(shell.complex->chord_count == 4);
  CHECK(patch_names(shell) == std::vector<std::string>{"wall", "farfield"});
  CHECK(!shell.symmetry);
  for (std::size_t v = 0; v < 8; ++v) CHECK(shell.outer_points[v] == 3 * shell.wall_points[v]);
  for (const double s : shell.complex->edge_sharpness) CHECK(s == 0);
}

TEST_CASE("shell: the outer polyhedron's numbering and orientation do not matter") {
  std::mt19937 random(1);
  const auto check = [&](const Cage& inner, const Cage& outer) {
    const Shell shell = build_shell(inner, outer);
    for (int trial = 0; trial < 10; ++trial) {
      Cage other = sample::renumbered(outer, random);
      if (trial % 2 == 1) {
        for (Index f = 0; f < other.faces.size(); ++f)
          std::reverse(other.faces[f].begin(), other.faces[f].end());
      }
      const Shell again = build_shell(inner, other);
      CHECK(again.complex->points == shell.complex->points);
      CHECK(again.complex->hexes == shell.complex->hexes);
      CHECK(again.complex->edge_sharpness == shell.complex->edge_sharpness);
      CHECK(again.complex->corner_sharpness == shell.complex->corner_sharpness);
    }
  };
  Cage creased = box_cage({5, 4, 3});
  creased.creases = {{0, 1, 10}, {1, 3, 2.5}};
  creased.corners = {{7, 10}};
  check(box_cage({1, 1, 1}), creased);
  check(sample::torus_cage(8, 4, 3, 1), sample::torus_cage(8, 4, 3.1, 1.8));
  check(sample::prism_cage(5, 1, 1), scaled(sample::prism_cage(5, 1, 1), 4));
  check(box_cage({1, 1, 1}, true), [] {
    Cage outer = box_cage({4, 4, 4}, true);
    for (Vec3& p : outer.points) p.y() = p.y() < 0 ? -1 : 5;
    return outer;
  }());
  // A box turned by 45 degrees fits in two ways equally well: still one answer.
  Cage turned = box_cage({4, 4, 4});
  for (Vec3& p : turned.points) p = Vec3(p.x() - p.y(), p.x() + p.y(), p.z());
  check(box_cage({1, 1, 1}), turned);
}

TEST_CASE("shell: of several isomorphisms the one with the least distance") {
  // The outer box is turned by 30 degrees about z: nearest is the turn back by 30, not the one by 60 on.
  Cage outer = box_cage({3, 3, 3});
  const Eigen::AngleAxisd turn(0.5235987755982988, Vec3::UnitZ());
  for (Vec3& p : outer.points) p = turn * p;
  const Shell shell = build_shell(box_cage({1, 1, 1}), outer);
  for (std::size_t v = 0; v < 8; ++v) {
    CHECK((shell.outer_points[v] - 3 * (turn * shell.wall_points[v])).norm() < 1e-14);
  }
}

TEST_CASE("shell: creases, corners and patches come from both polyhedra") {
  Cage inner = box_cage({1, 1, 1});
  inner.patch_names = {"top", "", "unused"};
  inner.face_patch = {1, 0, 1, 1, 1, 1};
  inner.creases = {{4, 5, 10}};
  inner.corners = {{0, 3}};
  Cage outer = box_cage({3, 3, 3});
  outer.creases = {{0, 1, 2}, {2, 3, 10}};
  const Shell shell = build_shell(inner, outer);
  const HexComplex& c = *shell.complex;
  CHECK(patch_names(shell) == std::vector<std::string>{"top", "wall", "farfield"});
  CHECK(c.corner_sharpness[0] == 3);
  CHECK(c.corner_sharpness[8] == 0);
  double sum = 0;
  for (std::size_t e = 0; e < c.edges.size(); ++e) {
    const auto [a, b] = c.edges[e];
    const double want = a == 4 && b == 5 ? 10 : (a == 8 && b == 9 ? 2 : (a == 10 && b == 11 ? 10 : 0));
    CHECK(c.edge_sharpness[e] == want);  // none where "top" meets "wall": the cage has no crease there
    sum += c.edge_sharpness[e];
  }
  CHECK(sum == 22);
  CHECK(contains(message_of([&] {
                   inner.patch_names[0] = "farfield";
                   build_shell(inner, outer);
                 }),
                 "farfield"));
}

TEST_CASE("shell: a half model has its symmetry patch exactly in its plane") {
  for (const double value : {0.0, 0.1, -7.0 / 3}) {
    const auto half = [&](const Vec3& size, double noise) {
      Cage cage = box_cage(size, true);
      for (std::size_t v = 0; v < 8; ++v) {
        Vec3& p = cage.points[v];
        p.y() = p.y() < 0 ? value + noise * static_cast<double>(v % 3) : value + size.y();
        std::swap(p.y(), p.x());  // the plane is x = value
        p.z() = -p.z();
      }
      return cage;
    };
    const Shell shell = build_shell(half({1, 1, 1}, 0), half({5, 4, 5}, 1e-6));
    REQUIRE(shell.symmetry);
    CHECK(shell.symmetry->axis == 0);
    CHECK(shell.symmetry->normal == Vec3::UnitX());
    CHECK(patch_names(shell).back() == "symmetry");
    Index quads = 0;
    for (std::size_t q = 0; q < shell.complex->quads.size(); ++q) {
      if (shell.complex->quad_patch[q] != 2) continue;
      ++quads;
      for (const Index v : shell.complex->quads[q]) CHECK(shell.complex->points[v].x() == value);
    }
    CHECK(quads == 4);
  }
}

TEST_CASE("shell: faces that are no quads are split once") {
  const Shell shell = build_shell(sample::prism_cage(5, 1, 1), sample::prism_cage(5, 4, 3));
  CHECK(shell.cage_level == 1);
  CHECK(shell.wall.depth == 1);
  CHECK(shell.complex->hexes.size() == 5 * 4 + 2 * 5);
}

TEST_CASE("shell: torus in torus") {
  const Shell shell = build_shell(sample::torus_cage(8, 4, 3, 1), sample::torus_cage(8, 4, 3, 2));
  CHECK(shell.complex->hexes.size() == 32);
  CHECK(shell.complex->points.size() == 64);
}

TEST_CASE("shell lines: wall and outer points by vertex of the surface level") {
  std::mt19937 random(9);
  Cage creased = box_cage({1, 1, 1});
  creased.creases = {{0, 1, 10}, {1, 3, 2.5}, {4, 5, 1}};
  for (const Cage& inner :
       {creased, sample::prism_cage(5, 1, 1), sample::torus_cage(6, 4, 3, 1), box_cage({1, 1, 1}, true)}) {
    const Cage outer = [&] {
      Cage o = scaled(inner, 1.25);
      if (inner.faces.size() == 5) {
        for (Vec3& p : o.points) p.y() = p.y() < 0 ? -1 : 3;
      }
      if (inner.faces.size() == 24) o = sample::torus_cage(6, 4, 3, 2);
      return o;
    }();
    const Shell shell = build_shell(inner, outer);
    const std::vector<SurfaceLevel> levels = build_levels(inner, 3);
    for (int depth = shell.cage_level; depth <= 3; ++depth) {
      const BlockMesh mesh = [&] {
        std::vector<Index> divisions(shell.complex->chord_count, 1 << (depth - shell.cage_level));
        divisions[shell.k_chord] = 2;
        std::vector<Vec3> points(BlockMesh::point_count(*shell.complex, divisions), Vec3::Zero());
        return BlockMesh(shell.complex, divisions, points);
      }();
      const SurfaceLevel& level = levels[depth];
      const auto lines = wall_lines(shell, level);
      const auto wall = layer_points(mesh, shell, lines, 0);
      // The wall's quads are the level's faces.
      std::vector<std::array<Index, 4>> faces;
      for (Index f = 0; f < level.face_count(); ++f) {
        std::array<Index, 4> q{};
        for (int c = 0; c < 4; ++c) q[c] = wall[level.face_vertices[f][c]];
        std::sort(q.begin(), q.end());
        faces.push_back(q);
      }
      std::vector<std::array<Index, 4>> quads;
      for (std::array<Index, 4> q : mesh.patches()[0].quads) {
        std::sort(q.begin(), q.end());
        quads.push_back(q);
      }
      std::sort(faces.begin(), faces.end());
      std::sort(quads.begin(), quads.end());
      CHECK(faces == quads);
    }
  }
}

TEST_CASE("shell: what cannot be joined is refused with numbers") {
  const Cage box = box_cage({1, 1, 1});
  const auto refusal = [&](const Cage& inner, const Cage& outer) {
    return message_of([&] { build_shell(inner, outer); });
  };
  CHECK(contains(refusal(box, sample::torus_cage(4, 4, 9, 2)), "genus 1"));
  CHECK(contains(refusal(box, box_cage({3, 3, 3}, true)), "1 boundary loops"));
  CHECK(contains(refusal(box, box_cage({0.5, 0.5, 0.5})), "inside of the cage"));
  CHECK(contains(refusal(box, box_cage({0.5, 0.5, 0.5})), "1 x 1 x 1"));
  CHECK(contains(refusal(box, box_cage({3, 3, 0.9})), "outside of it"));
  Cage shifted = box_cage({3, 3, 3});
  for (Vec3& p : shifted.points) p.x() += 2.5;
  CHECK(contains(refusal(box, shifted), "(-1,"));
  Cage far = box_cage({3, 3, 3});
  for (Vec3& p : far.points) p.x() += 100;
  CHECK(contains(refusal(box, far), "outside of it"));
  Cage inverted = box;
  for (Index f = 0; f < inverted.faces.size(); ++f)
    std::reverse(inverted.faces[f].begin(), inverted.faces[f].end());
  CHECK(contains(refusal(inverted, box_cage({3, 3, 3})), "inside out"));
  Cage bent = box_cage({1, 1, 1}, true);
  bent.points[0].y() -= 0.3;
  CHECK(contains(refusal(bent, box_cage({3, 3, 3}, true)), "not planar"));
  Cage two = box;
  for (Index f = 0; f < box.faces.size(); ++f) {
    std::vector<Index> row(box.faces[f].begin(), box.faces[f].end());
    for (Index& v : row) v += 8;
    two.faces.push_row(row);
    two.face_patch.push_back(0);
  }
  for (const Vec3& p : box.points) two.points.push_back(p + Vec3(9, 0, 0));
  CHECK(contains(refusal(two, two), "2 separate parts"));
  // Same counts, other connectivity: a torus of 3 x 8 sections is none of 4 x 6.
  CHECK(contains(refusal(sample::torus_cage(4, 6, 3, 1), sample::torus_cage(3, 8, 3, 2)),
                 "connected differently"));
  // Another plane.
  Cage moved = box_cage({5, 5, 5}, true);
  for (Vec3& p : moved.points) p.y() += 9;
  CHECK(contains(refusal(box_cage({1, 1, 1}, true), moved), "symmetry plane"));
}

TEST_CASE("winding numbers and volumes of closed and mirrored polyhedra") {
  const Cage box = box_cage({1, 2, 3});
  const SurfaceLevel level = build_surface_level(box);
  const TriangleSoup closed = closed_triangles({level, box.points}, std::nullopt);
  CHECK(signed_volume(closed) == Approx(48).epsilon(1e-14));
  CHECK(winding_number(closed, {0.9, -1.9, 2.9}) == Approx(1).epsilon(1e-12));
  CHECK(winding_number(closed, {1.1, 0, 0}) == Approx(0).margin(1e-12));
  const Cage half = box_cage({1, 2, 3}, true);
  const SurfaceLevel open = build_surface_level(half);
  const auto plane = find_symmetry_plane(open, half.points, "half");
  REQUIRE(plane);
  const TriangleSoup mirrored = closed_triangles({open, half.points}, plane);
  CHECK(signed_volume(mirrored) == Approx(96).epsilon(1e-14));
  CHECK(winding_number(mirrored, {0, -5.9, 0}) == Approx(1).epsilon(1e-12));
  CHECK(winding_number(mirrored, {0, -2, 0}) == Approx(1).epsilon(1e-12));
}
