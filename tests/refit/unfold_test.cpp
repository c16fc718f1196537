#include "core/refit/unfold.hpp"

#include "core/subdivide/refine.hpp"
#include "core/target/analytic_surfaces.hpp"
#include "tests/catch.hpp"
#include "tests/refit/hand_drawn_cages.hpp"

using namespace flowcage;
using namespace flowcage::test;

namespace {

/// A sphere's cage on the second level, as it comes out of the subdivision: nothing folds.
struct Sphere {
  std::unique_ptr<TargetSurface> target = sphere_surface(Vec3::Zero(), 0.5);
  FeatureMatch match;
  std::vector<Vec3> points;
  LevelSystem level;

  Sphere() : Sphere(box_cage(Vec3::Constant(-0.5), Vec3::Constant(0.5), false)) {}
  FitPass pass(std::vector<Vec3> control_points) const {
    return evaluate_pass(level, match, *target, std::move(control_points), {}, nullptr);
  }

 private:
  explicit Sphere(const Cage& cage) {
    SurfaceLevel topology = build_surface_level(cage);
    points = cage.points;
    for (int l = 0; l < 2; ++l) {
      SurfaceLevel child = build_child_level(topology);
      points = apply_stencils(refinement_stencils(topology), points);
      topology = std::move(child);
    }
    level = build_level_system(std::move(topology), {}, {}, match);
  }
};

}  // namespace

TEST_CASE("a vertex thrown over its neighbours is brought back, and little else moves", "[unfold]") {
  const Sphere sphere;
  REQUIRE(sphere.pass(sphere.points).folds() == 0);
  const SurfaceLevel& t = sphere.level.topology;
  for (const Index v : {0, 9, 40, 97}) {
    INFO("vertex " << v);
    // A regular limit point follows by 4/9: nearly twice the length of one of its edges.
    const auto& edge = t.edge_vertices[t.vertex_edges[v][0]];
    const Index other = edge[0] == v ? edge[1] : edge[0];
    const double way = 4 * (sphere.points[other] - sphere.points[v]).norm();
    std::vector<Vec3> thrown = sphere.points;
    thrown[v] += 4 * (sphere.points[other] - sphere.points[v]);
    const FitPass folded = sphere.pass(thrown);
    REQUIRE(folded.folds() > 0);

    const std::vector<Vec3> opened = unfolded_points(sphere.level, folded);
    CHECK(sphere.pass(opened).folds() == 0);
    double moved = 0;
    for (std::size_t i = 0; i < opened.size(); ++i) moved += (opened[i] - thrown[i]).squaredNorm();
    CHECK(std::sqrt(moved) < way);  // less than to put it back
    CHECK(moved > 0);
  }
}

TEST_CASE("what does not fold stays to the bit", "[unfold]") {
  const Sphere sphere;
  CHECK(unfolded_points(sphere.level, sphere.pass(sphere.points)) == sphere.points);
}
