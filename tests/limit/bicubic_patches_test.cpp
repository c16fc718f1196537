#include "core/limit/bicubic_patches.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/parallel.hpp"
#include "core/limit/limit_stencils.hpp"
#include "core/limit/spline_interpolation.hpp"
#include "core/subdivide/refine.hpp"
#include "tests/catch.hpp"
#include "tests/limit/half_cages.hpp"
#include "tests/refit/hand_drawn_cages.hpp"
#include "tests/subdivide/cage_zoo.hpp"

using namespace flowcage;

namespace {

struct Fine {
  SurfaceLevel level;
  std::vector<Vec3> points;
  double diagonal = 0;
};
Fine refined(const Cage& cage, int depth) {
  std::vector<SurfaceLevel> levels = build_levels(cage, depth);
  Fine fine{{}, refine_points(levels, cage.points), 0};
  fine.level = std::move(levels.back());
  Box3 box;
  for (const Vec3& p : fine.points) box.extend(p);
  fine.diagonal = box.diagonal().norm();
  return fine;
}
PatchSurface patches_of(const Fine& fine) {
  Progress silent;
  return make_bicubic_patches(fine.level, fine.points, {}, silent);
}

Vec3 at(const BSplineSurface& s, double u, double v) {
  const Vec2 end(s.knots_u.back(), s.knots_v.back());
  const BSplinePatch patch(std::make_shared<const BSplineSurface>(s), Eigen::AlignedBox2d(Vec2(0, 0), end));
  return patch.first({u, v}).position;
}
Vec3 on_side(const BSplineSurface& s, int side, double t) {
  const std::array<Vec2, 4> uv{Vec2(t, 0), Vec2(s.knots_u.back(), t), Vec2(t, s.knots_v.back()), Vec2(0, t)};
  return at(s, uv[side].x(), uv[side].y());
}

// The largest distance from a limit point of a vertex (by the masks, not by evaluation) to the nearest knot
// corner of the patches that counts whole quads: the patches must pass through all of them.
double worst_vertex_distance(const Fine& fine, const PatchSurface& surface) {
  std::vector<Vec3> corners;
  for (const BicubicPatch& patch : surface.patches) {
    const BSplineSurface& s = patch.surface;
    const BSplinePatch exact(std::make_shared<const BSplineSurface>(s),
                             Eigen::AlignedBox2d(Vec2(0, 0), Vec2(s.knots_u.back(), s.knots_v.back())));
    for (int i = 0; i <= s.knots_u.back(); ++i) {
      for (int j = 0; j <= s.knots_v.back(); ++j) {
        corners.push_back(exact.first({static_cast<double>(i), static_cast<double>(j)}).position);
      }
    }
  }
  double worst = 0;
  for (const Vec3& p : apply_stencils(limit_stencils(fine.level), fine.points)) {
    double nearest = std::numeric_limits<double>::max();
    for (const Vec3& q : corners) nearest = std::min(nearest, (p - q).norm());
    worst = std::max(worst, nearest);
  }
  return worst;
}

int euler_number(const PatchSurface& s) {
  return static_cast<int>(s.nodes.size()) - static_cast<int>(s.edges.size()) +
         static_cast<int>(s.patches.size());
}

// Both uses of every edge are one curve, from its first node to its last.
void check_edges(const PatchSurface& surface, double diagonal) {
  for (const PatchEdge& edge : surface.edges) {
    REQUIRE(edge.use_count >= 1);
    for (int k = 0; k < edge.use_count; ++k) {
      const PatchSide& use = edge.uses[k];
      const BSplineSurface& s = surface.patches[use.patch].surface;
      const double length = edge.uses[0].to - edge.uses[0].from;
      CHECK(use.to - use.from == length);
      for (int step = 0; step <= 12; ++step) {
        const double t = length * step / 12;
        const double first = edge.uses[0].side < 2 ? edge.uses[0].from + t : edge.uses[0].to - t;
        const double own = (use.side < 2) == (k == 0) ? use.from + t : use.to - t;
        const Vec3 p = on_side(surface.patches[edge.uses[0].patch].surface, edge.uses[0].side, first);
        CHECK((on_side(s, use.side, own) - p).norm() < 1e-13 * diagonal);
        if (step == 0) CHECK((surface.nodes[edge.nodes[0]] - p).norm() < 1e-13 * diagonal);
        if (step == 12) CHECK((surface.nodes[edge.nodes[1]] - p).norm() < 1e-13 * diagonal);
      }
    }
  }
}

}  // namespace

TEST_CASE("Cubic interpolation gives a cubic back, and a spline with double knots") {
  const CubicInterpolation cubic({0, 0, 0, 0, 0.125, 0.125, 0.25, 0.5, 1, 2, 3, 3, 3, 3});
  const auto polynomial = [](double x) { return Vec3(x * x * x - 2 * x, 5 - x * x, 1); };
  // Beyond the double knot another slope of slopes: C1.
  const auto kinked = [&](double x) {
    const double over = std::max(0.0, x - 0.125);
    return Vec3(polynomial(x) + over * over * Vec3(1, 2, 3));
  };
  std::vector<Vec3> values;
  for (const double x : cubic.sites()) values.push_back(kinked(x));
  cubic.solve(values.data(), 1);
  BSplineSurface surface{3, 1, cubic.knots(), {0, 0, 1, 1}, {}, {}};
  for (const Vec3& p : values) surface.poles.insert(surface.poles.end(), {p, p});
  for (const double x : {0.0, 0.01, 0.1, 0.125, 0.2, 0.7, 1.5, 2.9, 3.0}) {
    CHECK((at(surface, x, 0.5) - kinked(x)).norm() < 1e-13);
  }
}

TEST_CASE("Patches of regular surfaces are the limit surface to rounding") {
  for (const Cage& cage :
       {zoo::torus(7, 5), zoo::grid(3, 4), test::box_cage(Vec3(0, 0, 0), Vec3(1, 2, 3), true)}) {
    const Fine fine = refined(cage, 2);
    const PatchSurface surface = patches_of(fine);
    CHECK(surface.max_deviation < 1e-14 * fine.diagonal);
    CHECK(surface.max_angle_degrees < 1e-10);
    CHECK(worst_vertex_distance(fine, surface) < 1e-14 * fine.diagonal);
    check_edges(surface, fine.diagonal);
    for (const BicubicPatch& patch : surface.patches) {  // knots are whole numbers
      CHECK(patch.surface.count_u() == static_cast<int>(patch.surface.knots_u.back()) + 3);
    }
  }
}

TEST_CASE("Patches near extraordinary vertices, darts and creases: close, smooth, watertight") {
  struct Case {
    std::string name;
    Cage cage;
    int euler;
    std::size_t patches;
  };
  Cage dart = zoo::grid(4, 4);
  for (Vec3& p : dart.points) p.z() = 0.1 * std::sin(3 * p.x()) * p.y();
  const auto vertex = [](Index i, Index j) { return i + 5 * j; };
  dart.creases = {{vertex(2, 0), vertex(2, 1), infinitely_sharp},
                  {vertex(2, 1), vertex(2, 2), infinitely_sharp}};
  std::vector<Case> cases{
      {"sphere", zoo::cube(), 2, 6},
      {"cylinder", test::cylinder_cage(1, 3), 2, 12},
      {"wing", test::wing_cage({}), 1, 8},
      {"valence 5", zoo::fan(5, true), 1, 5},
      {"valence 6", zoo::double_pyramid(6), 2, 18},
      {"genus 1",
       zoo::voxels({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {0, 1, 0}, {2, 1, 0}, {0, 2, 0}, {1, 2, 0}, {2, 2, 0}}),
       0, 24},
      {"dart", dart, 1, 4}};
  test::WingCageShape blunt;
  blunt.half_base = 0.001;
  cases.push_back({"blunt wing", test::wing_cage(blunt), 1, 10});
  for (const Case& c : cases) {
    INFO(c.name);
    const Fine fine = refined(c.cage, 2);
    const PatchSurface surface = patches_of(fine);
    CHECK(surface.patches.size() == c.patches);
    CHECK(euler_number(surface) == c.euler);
    CHECK(surface.max_deviation < 2e-7 * fine.diagonal);  // the aim is held at fewer samples
    CHECK(surface.max_angle_degrees < 0.1);
    CHECK(worst_vertex_distance(fine, surface) < 1e-13 * fine.diagonal);
    check_edges(surface, fine.diagonal);
  }
}

TEST_CASE("Patches of half models meet their mirror image smoothly, in the plane to the last bits") {
  // A box whose open side lies in the plane y = 0; and half a double pyramid cut through its two apexes, so
  // that irregular vertices lie in the plane.
  Cage box = test::box_cage(Vec3(-1, 0, -1), Vec3(1, 0.6, 1), false);
  Csr<Index> faces;
  for (Index f = 0; f < box.faces.size(); ++f) {
    if (std::any_of(box.faces[f].begin(), box.faces[f].end(), [](Index v) { return (v & 2) != 0; })) {
      faces.push_row(box.faces[f]);
    }
  }
  box.faces = faces;
  box.face_patch.assign(static_cast<std::size_t>(faces.size()), 0);
  Cage pyramid = zoo::make_cage(
      {Vec3(0, 0, 1), Vec3(0, 0, -1), Vec3(1, 0, 0), Vec3(0.5, 1, 0), Vec3(-0.5, 1, 0), Vec3(-1, 0, 0)},
      {{0, 2, 3}, {0, 3, 4}, {0, 4, 5}, {1, 3, 2}, {1, 4, 3}, {1, 5, 4}});
  struct Case {
    Cage cage;
    std::size_t patches;
  };
  for (const Case& c : {Case{box, 5}, Case{pyramid, 10}}) {
    const HalfCage half{"half", c.cage, {{1, 0.0}}};
    Fine fine{half_level(half), c.cage.points, 2};
    for (int depth = 0; depth < 2; ++depth) {
      fine.points = apply_stencils(refinement_stencils(fine.level), fine.points);
      fine.level = build_child_level(fine.level);
    }
    const PatchSurface surface = patches_of(fine);
    CHECK(surface.patches.size() == c.patches);
    CHECK(surface.max_angle_degrees < 0.1);
    CHECK(surface.max_deviation < 2e-7 * fine.diagonal);
    check_edges(surface, fine.diagonal);
    int open = 0;
    for (const PatchEdge& edge : surface.edges) {
      if (edge.use_count == 2) continue;
      ++open;
      const PatchSide& use = edge.uses[0];
      const BSplineSurface& s = surface.patches[use.patch].surface;
      const Vec2 end(s.knots_u.back(), s.knots_v.back());
      const BSplinePatch patch(std::make_shared<const BSplineSurface>(s),
                               Eigen::AlignedBox2d(Vec2(0, 0), end));
      for (int step = 0; step <= 400; ++step) {
        const double t = use.from + (use.to - use.from) * step / 400;
        const std::array<Vec2, 4> uv{Vec2(t, 0), Vec2(end.x(), t), Vec2(t, end.y()), Vec2(0, t)};
        const PatchPoint p = patch.first(uv[use.side]);
        CHECK(std::abs(p.position.y()) < 1e-15);
        CHECK(std::abs(p.du.cross(p.dv).normalized().y()) < 0.05 / 57.3);
      }
    }
    CHECK(open >= 4);
  }
}

TEST_CASE("Patches: n-gons and semi-sharp creases are refined first") {
  Cage cage = zoo::prism(5);
  cage.creases = {{0, 1, 1.5}};
  const Fine coarse = refined(cage, 0);
  const PatchSurface surface = patches_of(coarse);
  CHECK(euler_number(surface) == 2);
  CHECK(surface.max_angle_degrees < 0.1);
  // The same surface as that of the finer level, whose sharpness has decayed.
  const PatchSurface other = patches_of(refined(cage, 2));
  REQUIRE(other.patches.size() == surface.patches.size());
  for (std::size_t p = 0; p < surface.patches.size(); ++p) {
    const auto& a = surface.patches[p].surface.poles;
    const auto& b = other.patches[p].surface.poles;
    REQUIRE(a.size() == b.size());
    for (std::size_t k = 0; k < a.size(); ++k) CHECK((a[k] - b[k]).norm() < 1e-8);
  }
}

TEST_CASE("Patches: the same bits for any number of threads") {
  const Fine fine = refined(zoo::double_pyramid(6), 2);
  set_thread_count(1);
  const PatchSurface one = patches_of(fine);
  set_thread_count(5);
  const PatchSurface five = patches_of(fine);
  set_thread_count(0);
  for (std::size_t p = 0; p < one.patches.size(); ++p) {
    CHECK(one.patches[p].surface.poles == five.patches[p].surface.poles);
  }
  CHECK(one.max_deviation == five.max_deviation);
}
