#include "core/subdivide/masks.hpp"

#include <vector>

#include "core/subdivide/refine.hpp"
#include "tests/catch.hpp"
#include "tests/subdivide/cage_zoo.hpp"

using namespace flowcage;

TEST_CASE("the rule at a vertex counts its sharp edges") {
  CHECK(vertex_rule(0, std::vector<double>{0, 0, 0}) == VertexRule::smooth);
  CHECK(vertex_rule(0, std::vector<double>{0, 0.1, 0}) == VertexRule::dart);
  CHECK(vertex_rule(0, std::vector<double>{10, 0.1, 0}) == VertexRule::crease);
  CHECK(vertex_rule(0, std::vector<double>{10, 0.1, 1}) == VertexRule::corner);
  CHECK(vertex_rule(0.1, std::vector<double>{0, 0, 0}) == VertexRule::corner);
}

TEST_CASE("sharpness decays by one a level unless infinite") {
  CHECK(decayed_sharpness(2.5) == 1.5);
  CHECK(decayed_sharpness(0.5) == 0);
  CHECK(decayed_sharpness(9.5) == 8.5);
  CHECK(decayed_sharpness(infinitely_sharp) == infinitely_sharp);
}

TEST_CASE("regular masks are those of the uniform bicubic B-spline") {
  const VertexMask smooth = vertex_mask(0, std::vector<double>(4, 0));
  // In ring points: P 9/16, E 3/32, F 1/64.
  CHECK(smooth.vertex + 4 * smooth.face / 4 == Approx(9.0 / 16).epsilon(1e-15));
  CHECK(smooth.edge + 2 * smooth.face / 4 == Approx(3.0 / 32).epsilon(1e-15));
  CHECK(smooth.face / 4 == Approx(1.0 / 64).epsilon(1e-15));
  const VertexMask crease = vertex_mask(0, std::vector<double>{0, 10, 0, 10});
  CHECK(crease.vertex == 0.75);
  CHECK(crease.crease == 0.125);
  CHECK(crease.crease_edges == std::array{1, 3});
  CHECK(edge_mask(0).end == 0.25);
  CHECK(edge_mask(0).face == 0.25);
  CHECK(edge_mask(1).end == 0.5);
}

TEST_CASE("semi-sharp rules are blended by the fraction that is left (DeRose et al. 1998)") {
  CHECK(edge_mask(0.25).end == Approx(0.25 * 0.5 + 0.75 * 0.25));
  // A crease whose sharpness 0.25 and 0.75 both end: half crease, half smooth.
  const VertexMask mask = vertex_mask(0, std::vector<double>{0.25, 0, 0.75, 0});
  CHECK(mask.vertex == Approx(0.5 * 0.75 + 0.5 * 0.5));
  CHECK(mask.crease == Approx(0.5 * 0.125));
  CHECK(mask.edge == Approx(0.5 / 16));
  CHECK(mask.crease_edges == std::array{0, 2});
  // A corner of which one edge ends: 0.4 corner, 0.6 crease of the two that stay.
  const VertexMask corner = vertex_mask(0, std::vector<double>{3, 0.4, 0, 10});
  CHECK(corner.vertex == Approx(0.4 + 0.6 * 0.75));
  CHECK(corner.crease == Approx(0.6 * 0.125));
  CHECK(corner.crease_edges == std::array{0, 3});
  // A sharp vertex that ends on a smooth surface.
  CHECK(vertex_mask(0.3, std::vector<double>(4, 0)).vertex == Approx(0.3 + 0.7 * 0.5));
}

TEST_CASE("one refinement of the unit cube: known points") {
  const Cage cage = zoo::cube();
  const std::vector<SurfaceLevel> levels = build_levels(cage, 1);
  const std::vector<Vec3> points = refine_points(levels, cage.points);
  const Vec3 middle(0.5, 0.5, 0.5);
  for (Index v = 0; v < 8; ++v) {  // F + 2R + (n - 3)P over n: 5/9 of the way out
    CHECK((points[v] - middle - (cage.points[v] - middle) * (5.0 / 9)).norm() < 1e-15);
  }
  for (Index e = 0; e < 12; ++e) {
    const auto [a, b] = levels[0].edge_vertices[e];
    CHECK((points[8 + e] - middle - 0.75 * (0.5 * (cage.points[a] + cage.points[b]) - middle)).norm() <
          1e-15);
  }
  for (Index f = 0; f < 6; ++f) CHECK((points[20 + f] - middle).norm() == Approx(0.5));
}

TEST_CASE("children: numbers, patches and the layout that the header describes") {
  Cage cage = zoo::prism(5);
  for (Index f = 0; f < cage.faces.size(); ++f) cage.face_patch[f] = f;
  cage.patch_names = {"a", "b", "c", "d", "e", "f", "g"};
  const std::vector<SurfaceLevel> levels = build_levels(cage, 1);
  const SurfaceLevel &parent = levels[0], &child = levels[1];
  const Index V = parent.vertex_count(), E = parent.edge_count();
  for (Index f = 0; f < parent.face_count(); ++f) {
    const Index n = parent.face_vertices.row_size(f);
    for (Index i = 0; i < n; ++i) {
      const auto c = static_cast<Index>(parent.face_vertices.offsets[f]) + i;
      CHECK(child.face_patch[c] == f);
      const auto row = child.face_vertices[c];
      CHECK(row[0] == parent.face_vertices[f][i]);
      CHECK(row[1] == V + parent.face_edges[f][i]);
      CHECK(row[2] == V + E + f);
      CHECK(row[3] == V + parent.face_edges[f][(i + n - 1) % n]);
    }
  }
  for (const auto& ends : child.edge_vertices) CHECK(ends[0] < ends[1]);  // the parent's vertex first
}

TEST_CASE("refinement is affine invariant and keeps points in the cage's hull") {
  zoo::Random random(11);
  for (const auto& [name, cage] : zoo::all()) {
    INFO(name);
    const std::vector<SurfaceLevel> levels = build_levels(cage, 2);
    Eigen::Matrix3d linear;
    for (int k = 0; k < 9; ++k) linear(k / 3, k % 3) = random.uniform(-1, 1);
    const Vec3 shift(3, -2, 5);
    std::vector<Vec3> moved = cage.points;
    for (Vec3& p : moved) p = linear * p + shift;
    const std::vector<Vec3> points = refine_points(levels, cage.points);
    moved = refine_points(levels, moved);
    Box3 hull;
    for (const Vec3& p : cage.points) hull.extend(p);
    double worst = 0;
    bool inside = true;
    for (std::size_t v = 0; v < points.size(); ++v) {
      worst = std::max(worst, (moved[v] - linear * points[v] - shift).norm());
      inside = inside && hull.exteriorDistance(points[v]) < 1e-14;
    }
    CHECK(worst < 1e-13);
    CHECK(inside);
  }
}
