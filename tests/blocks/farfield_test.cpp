#include "core/blocks/farfield.hpp"

#include "core/base/error.hpp"
#include "core/blocks/spherical_embedding.hpp"
#include "core/subdivide/refine.hpp"
#include "tests/blocks/sample_cages.hpp"
#include "tests/blocks/sample_complexes.hpp"
#include "tests/catch.hpp"

using namespace flowcage;
using sample::box_cage;
using sample::contains;
using sample::message_of;

namespace {

const FarField sphere{OuterShape::Kind::sphere, 10};
const FarField box{OuterShape::Kind::box, 10};
const FarField bullet{OuterShape::Kind::bullet, 10};

SphericalEmbedding embed(const Cage& cage) {
  ShellParts parts = prepare_inner(cage);
  make_quads(parts);
  SphericalEmbedding map = embed_on_sphere({parts.inner, parts.inner_points}, parts.symmetry, "cage");
  // Checked here once more, by its definition.
  for (Index f = 0; f < parts.inner.face_count(); ++f) {
    const auto v = parts.inner.face_vertices[f];
    for (int c = 0; c < 4; ++c) {
      const auto& a = map.directions;
      REQUIRE(a[v[c]].dot(a[v[(c + 1) % 4]].cross(a[v[(c + 3) % 4]])) > 0);
      REQUIRE(std::abs(a[v[c]].norm() - 1) < 1e-14);
    }
  }
  return map;
}

/// A refined box pulled into another shape.
template <typename F>
Cage shaped(int levels, const F& place) {
  const Cage start = box_cage({1, 1, 1});
  const auto chain = build_levels(start, levels);
  Cage cage;
  cage.points = refine_points(chain, start.points);
  for (Vec3& p : cage.points) p = place(p.normalized());
  cage.faces = chain.back().face_vertices;
  cage.face_patch.assign(cage.faces.size(), 0);
  cage.patch_names = {""};
  return cage;
}

}  // namespace

TEST_CASE("a cube's map to the sphere is the radial one") {
  const SphericalEmbedding map = embed(box_cage({1, 1, 1}));
  const Cage cube = box_cage({1, 1, 1});
  for (std::size_t v = 0; v < 8; ++v) CHECK((map.directions[v] - cube.points[v].normalized()).norm() < 1e-6);
}

TEST_CASE("maps to the sphere do not fold: thin, swept, bent, noisy bodies") {
  CHECK(embed(box_cage({1, 0.01, 5})).min_determinant > 0.1);
  const SphericalEmbedding wing = embed(sample::wing_cage());
  CHECK(wing.min_determinant > 0.1);
  CHECK(wing.min_wall_cosine > 0);
  embed(sample::wing_cage(7, 1.2));
  std::mt19937 random(4);
  std::uniform_real_distribution<double> noise(-1, 1);
  for (int trial = 0; trial < 5; ++trial) {
    embed(shaped(2, [&](const Vec3& d) -> Vec3 { return d * (1 + 0.3 * noise(random)); }));
  }
  // A bent bar: not star-shaped about its centroid.
  embed(shaped(2, [](const Vec3& d) -> Vec3 {
    const double angle = 1.2 * d.x();
    const double r = 2 + 0.4 * d.y();
    return {r * std::sin(angle), r * std::cos(angle), 0.4 * d.z()};
  }));
}

TEST_CASE("what lies above goes up: the map is not rotated against the body") {
  const Cage cage = sample::wing_cage();
  const SphericalEmbedding map = embed(cage);
  const auto& d = map.directions;  // vertices keep their numbers in the subdivided cage
  for (int s = 0; s < 4; ++s) {
    CHECK(d[6 * s + 1].z() > 0.3);
    CHECK(d[6 * s + 2].z() > 0.3);
    CHECK(d[6 * s + 3].z() < -0.3);
    CHECK(d[6 * s + 4].z() < -0.3);
    CHECK(d[6 * s].x() < -0.3);
    CHECK(d[6 * s + 5].x() > 0.3);
  }
  CHECK(d[24].y() > 0.7);  // the tip goes outboard
  for (int n = 0; n < 6; ++n) CHECK(d[n].y() == 0);
}

TEST_CASE("far-field points lie on the sphere, box or bullet, the rim in the plane to the last bit") {
  Cage wing = sample::wing_cage();
  for (Vec3& p : wing.points) p.y() += 0.1;
  for (const FarField& shape : {sphere, box, bullet}) {
    const Shell shell = build_farfield_shell(wing, shape, Box3());
    REQUIRE(shell.outer_shape);
    const Vec3 c = shell.outer_shape->centre;
    const double r = shell.outer_shape->radius;
    CHECK(r == Approx(10 * 1.22));  // ten times its span
    for (int depth = 0; depth < 4; ++depth) {
      const std::vector<Vec3> points = outer_points(shell, depth, depth == 3);
      for (const Vec3& p : points) {
        const Vec3 d = p - c;
        const bool ball =
            shape.kind == OuterShape::Kind::sphere || (shape.kind == OuterShape::Kind::bullet && d.x() <= 0);
        const double reach = ball ? d.norm()
                             : shape.kind == OuterShape::Kind::bullet
                                 ? std::max(d.x(), std::hypot(d.y(), d.z()))
                                 : d.cwiseAbs().maxCoeff();
        REQUIRE(std::abs(reach - r) < 1e-13 * r);
        REQUIRE(p.y() >= 0.1);
      }
      const auto levels = [&] {
        SurfaceLevel level = shell.outer;
        for (int d = 0; d < depth; ++d) level = build_child_level(level);
        return level;
      }();
      for (const Index v : boundary_vertices(levels)) REQUIRE(points[v].y() == 0.1);
    }
  }
}

TEST_CASE("a box far field's edges are edges of the mesh where the cage allows it") {
  const Shell shell = build_farfield_shell(box_cage({1, 0.5, 0.25}), box, Box3());
  CHECK(shell.box_edges_sharp);
  Index sharp = 0;
  for (const double s : shell.outer.edge_sharpness) sharp += s > 0 ? 1 : 0;
  CHECK(sharp == 12);
  for (const Vec3& p : shell.outer_points) CHECK(p.cwiseAbs() == Vec3(20, 20, 20));
  // On every level each quad lies within one side: three of its coordinates' extremes agree.
  const auto points = outer_points(shell, 3, false);
  SurfaceLevel level = shell.outer;
  for (int d = 0; d < 3; ++d) level = build_child_level(level);
  for (Index f = 0; f < level.face_count(); ++f) {
    bool flat = false;
    for (int axis = 0; axis < 3; ++axis) {
      const auto v = level.face_vertices[f];
      const double x = points[v[0]][axis];
      flat |=
          std::abs(x) == 20 && points[v[1]][axis] == x && points[v[2]][axis] == x && points[v[3]][axis] == x;
    }
    CHECK(flat);
  }
  // A finer body has the edges too.
  const Cage fine = shaped(2, [](const Vec3& d) { return d; });
  CHECK(build_farfield_shell(fine, box, Box3()).box_edges_sharp);
  // A tetrahedron split into 12 quads has no eight corners for a box: projection.
  const Cage tetrahedron = sample::make_cage({{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}},
                                             {{0, 1, 2}, {0, 3, 1}, {0, 2, 3}, {1, 3, 2}});
  const Shell projected = build_farfield_shell(tetrahedron, box, Box3());
  for (const Vec3& p : projected.outer_points) CHECK(p.cwiseAbs().maxCoeff() == Approx(20));
}

TEST_CASE("a far field that cannot be grown is refused") {
  const auto refusal = [](const Cage& cage, const FarField& shape) {
    return message_of([&] { build_farfield_shell(cage, shape, Box3()); });
  };
  CHECK(contains(refusal(sample::torus_cage(6, 4, 3, 1), sphere), "genus 1"));
  Cage tube = box_cage({1, 1, 1});
  tube.faces = {};
  for (const auto& f :
       std::vector<std::vector<Index>>{{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 4, 6, 2}, {1, 3, 7, 5}}) {
    tube.faces.push_row(f);
  }
  tube.face_patch.assign(4, 0);
  CHECK(!refusal(tube, sphere).empty());
  CHECK(contains(refusal(box_cage({1, 1, 1}), {OuterShape::Kind::sphere, 0.6}), "does not clear"));
  try {
    build_farfield_shell(box_cage({1, 1, 1}), {OuterShape::Kind::box, 0.4}, Box3());
    CHECK(false);
  } catch (const Error& e) {
    CHECK(e.kind() == ErrorKind::usage);
  }
}
