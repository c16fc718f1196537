// Bodies that pass through each other, as many systems export them: the target is their outer skin.
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <BRepPrimAPI_MakeSphere.hxx>
#include <TopExp.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <algorithm>
#include <cmath>
#include <functional>
#include <gp_Ax2.hxx>
#include <numbers>
#include <random>

#include "occ_bridge/cad_model.hpp"
#include "occ_bridge/internal/prepared_model.hpp"
#include "occ_bridge/internal/shape_rep.hpp"
#include "occ_bridge/internal/unite.hpp"
#include "tests/catch.hpp"

using namespace flowcage;

namespace {

Shape cylinder(const gp_Pnt& base, const gp_Dir& axis, double radius, double height) {
  return wrap(BRepPrimAPI_MakeCylinder(gp_Ax2(base, axis), radius, height).Shape());
}

CadModel model_of(const Shape& shape, const CadReadSettings& settings = {}) {
  Progress silent;
  return cad_model_of(shape, settings, silent);
}

/// A wing whose root is inside of a fuselage.
Shape wing(bool closed_root) {
  HalfWing half;
  half.airfoil = naca_symmetric(0.12, 0);
  half.closed_root = closed_root;
  return make_half_wing(half);
}
Shape fuselage() {
  return cylinder(gp_Pnt(-1, 0, 0), gp_Dir(1, 0, 0), 0.3, 4);
}

std::vector<Vec3> points_around(const Box3& box, int count) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> unit(-0.8, 0.8);
  std::vector<Vec3> points;
  for (int i = 0; i < count; ++i) {
    const double x = unit(random), y = unit(random), z = unit(random);
    points.push_back(box.center() + Vec3(x, y, z).cwiseProduct(box.sizes()));
  }
  return points;
}

std::vector<SurfacePoint> feet_of(const CadModel& model, const std::vector<Vec3>& points) {
  std::vector<SurfacePoint> feet(points.size());
  model.closest_points(points, {}, feet);
  return feet;
}

/// Lengths of the chains whose points all satisfy `on`, summed; their number in `count`.
double length_where(const CadModel& model, const std::function<bool(const Vec3&)>& on, int& count) {
  double length = 0;
  count = 0;
  for (const FeatureChain& chain : model.features().chains) {
    if (!std::ranges::all_of(chain.polyline, on)) continue;
    length += chain.length;
    ++count;
  }
  return length;
}

struct Pair {
  std::string name;
  Shape a, b;
};

std::vector<Pair> pairs() {
  return {{"sphere in a box's face", make_sphere(1), translated(make_box({3, 3, 2}), {0, 0, 1.6})},
          {"sphere on a cylinder", make_sphere(1), translated(make_cylinder(0.6, 4), {0, 0, -2})},
          {"two cylinders across", cylinder(gp_Pnt(-2, 0, 0), gp_Dir(1, 0, 0), 1, 4),
           cylinder(gp_Pnt(0, 0, -2), gp_Dir(0, 0, 1), 0.7, 4)},
          {"wing through a fuselage", fuselage(), wing(true)},
          {"boxes that share a part of a face", make_box({1, 1, 1}),
           translated(make_box({1, 0.5, 0.4}), {1, 0.1, 0.05})}};
}

}  // namespace

TEST_CASE("projections to bodies that overlap are those to their union") {
  for (const Pair& pair : pairs()) {
    CAPTURE(pair.name);
    const CadModel whole = model_of(make_union(pair.a, pair.b));
    const CadModel parts = model_of(make_compound(pair.a, pair.b));
    REQUIRE(parts.summary().overlaps.size() == 1);
    CHECK(parts.summary().overlaps[0].united);
    CHECK(parts.summary().overlaps[0].hidden_pieces > 0);
    CHECK(parts.summary().solids == 1);
    CHECK(parts.summary().closed());
    CHECK(parts.summary().warnings.empty());
    const std::vector<Vec3> points = points_around(whole.bounds(), 2000);
    const std::vector<SurfacePoint> expected = feet_of(whole, points), found = feet_of(parts, points);
    double worst = 0;
    int compared = 0, turned = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      REQUIRE(found[i].status != FootStatus::failed);
      worst = std::max(worst, std::abs(expected[i].distance - found[i].distance));
      if ((expected[i].position - found[i].position).norm() > 1e-6 * whole.diagonal()) continue;
      if (found[i].status != FootStatus::interior || expected[i].status != FootStatus::interior) continue;
      ++compared;
      turned += expected[i].normal.dot(found[i].normal) > 0.999 ? 0 : 1;
    }
    CHECK(worst < 1e-9 * whole.diagonal());
    CHECK(compared > 500);
    CHECK(turned == 0);
  }
}

TEST_CASE("no projection lands inside of the other body") {
  const CadModel model =
      model_of(make_compound(make_sphere(1), translated(make_cylinder(0.6, 4), {0, 0, -2})));
  for (const SurfacePoint& foot : feet_of(model, points_around(model.bounds(), 3000))) {
    const Vec3& p = foot.position;
    const double in_sphere = 1 - p.norm();
    const double in_cylinder = std::min(0.6 - p.head<2>().norm(), 2 - std::abs(p.z()));
    CHECK(std::max(in_sphere, in_cylinder) < 1e-9);
  }
}

TEST_CASE("the curves in which bodies meet are feature chains of the right length") {
  int count = 0;
  SECTION("sphere and plane: a circle") {
    const CadModel model =
        model_of(make_compound(make_sphere(1), translated(make_box({3, 3, 2}), {0, 0, 1.6})));
    const auto on = [](const Vec3& p) {
      return std::abs(p.z() - 0.6) < 1e-7 && std::abs(p.norm() - 1) < 1e-7;
    };
    CHECK(length_where(model, on, count) == Approx(2 * std::numbers::pi * 0.8).epsilon(1e-9));
    CHECK(count == 1);
    CHECK(model.summary().intersection_chains == 1);
  }
  SECTION("sphere and cylinder on one axis: two circles") {
    const CadModel model =
        model_of(make_compound(make_sphere(1), translated(make_cylinder(0.6, 4), {0, 0, -2})));
    const auto on = [](const Vec3& p) {
      return std::abs(p.head<2>().norm() - 0.6) < 1e-7 && std::abs(p.norm() - 1) < 1e-7;
    };
    CHECK(length_where(model, on, count) == Approx(4 * std::numbers::pi * 0.6).epsilon(1e-9));
    CHECK(count == 2);
    CHECK(model.summary().intersection_chains == 2);
  }
  SECTION("equal cylinders across: two ellipses that cross twice") {
    const CadModel model = model_of(make_compound(cylinder(gp_Pnt(-2, 0, 0), gp_Dir(1, 0, 0), 1, 4),
                                                  cylinder(gp_Pnt(0, 0, -2), gp_Dir(0, 0, 1), 1, 4)));
    const auto on = [](const Vec3& p) {
      return std::abs(std::hypot(p.y(), p.z()) - 1) < 1e-5 && std::abs(p.head<2>().norm() - 1) < 1e-5;
    };
    // Ellipses (sin t, cos t, +-sin t). The normals' angle has the cosine cos^2 t: where it is below the
    // crease angle the bodies meet smoothly, and there is no feature.
    const double crease = CadReadSettings().crease_angle_degrees * std::numbers::pi / 180;
    const double start = std::acos(std::sqrt(std::cos(crease)));
    const double quarter = std::comp_ellint_2(std::sqrt(0.5)) - std::ellint_2(std::sqrt(0.5), start);
    CHECK(length_where(model, on, count) == Approx(8 * std::sqrt(2.0) * quarter).epsilon(1e-5));
    CHECK(count == 4);
    CHECK(model.summary().intersection_chains == 4);
  }
}

TEST_CASE("an open wing whose root is inside of the fuselage leaves no gap") {
  const CadModel model = model_of(make_compound(wing(false), fuselage()));
  REQUIRE(model.summary().overlaps.size() == 1);
  CHECK(model.summary().overlaps[0].united);
  CHECK(model.summary().closed());
  CHECK(model.summary().solids == 1);
  CHECK(model.summary().boundary_chains == 0);
  CHECK(model.summary().intersection_chains > 0);
}

TEST_CASE("the union is the same in every run") {
  const Shape shape = make_compound(wing(true), fuselage());
  const CadModel first = model_of(shape), second = model_of(shape);
  CHECK(first.tessellation().triangles == second.tessellation().triangles);
  CHECK(first.tessellation().points == second.tessellation().points);
  REQUIRE(first.features().chains.size() == second.features().chains.size());
  for (std::size_t c = 0; c < first.features().chains.size(); ++c) {
    CHECK(first.features().chains[c].length == second.features().chains[c].length);
  }
}

TEST_CASE("faces in which two bodies touch are inside: the skin has neither") {
  const CadModel model =
      model_of(make_compound(make_box({1, 1, 1}), translated(make_box({1, 1, 1}), {1, 0, 0})));
  const std::vector<SurfacePoint> feet = feet_of(model, {Vec3(0.5, 0, 0.1)});  // on the contact face
  CHECK(feet[0].distance == Approx(0.4));
  CHECK(model.summary().faces == 10);
  CHECK(model.summary().closed());
  CHECK(model.summary().sharp_edges == 16);  // what remains of the contact's rim is smooth
  REQUIRE(model.summary().overlaps.size() == 1);
  CHECK(model.summary().overlaps[0].bodies == std::vector<Index>{1, 2});
}

TEST_CASE("a body inside of another is not seen, bodies that are near do not meet") {
  const CadModel nested = model_of(make_compound(make_sphere(1), make_box({0.5, 0.5, 0.5})));
  CHECK(nested.summary().faces == 1);
  CHECK(nested.summary().overlaps[0].hidden_pieces == 6);
  const CadModel near =
      model_of(make_compound(make_box({1, 1, 1}), translated(make_box({1, 1, 1}), {1.0005, 0, 0})));
  CHECK(near.summary().faces == 12);
  CHECK(near.summary().solids == 2);
  CHECK(near.summary().overlaps.empty());
}

TEST_CASE("bodies stay as they are on request, and with a warning where there is no time") {
  const Shape overlapping = make_compound(make_sphere(1), make_box({3, 0.5, 0.5}));
  CadReadSettings settings;
  settings.unite = false;
  const CadModel apart = model_of(overlapping, settings);
  CHECK(apart.summary().faces == 7);
  CHECK(apart.summary().overlaps.empty());
  settings.unite = true;
  settings.time_limit_seconds = 0;
  const CadModel late = model_of(overlapping, settings);
  CHECK(late.summary().faces == 7);
  REQUIRE(late.summary().overlaps.size() == 1);
  CHECK_FALSE(late.summary().overlaps[0].united);
  REQUIRE(late.summary().warnings.size() == 1);
  CHECK_THAT(late.summary().warnings[0],
             contains_text("bodies 1, 2 overlap or touch and could not be united"));
}

TEST_CASE("pieces keep the labels of their face and the number of their body") {
  const Shape shape = make_compound(make_sphere(1), make_box({3, 0.5, 0.5}));
  occ::FaceLabels labels;
  occ::FileContent content;
  content.file = content.format = std::string("code");
  content.shape_unit = 1;
  content.shape = shape.rep().shape;
  TopTools_IndexedMapOfShape faces;
  TopExp::MapShapes(content.shape, TopAbs_FACE, faces);
  for (int i = 1; i <= faces.Extent(); ++i)
    labels.number(faces(i), {.name = "face " + std::to_string(i), .layer = "layer " + std::to_string(i)});
  Progress silent;
  const occ::PreparedModel before = occ::prepare_model({content}, labels, {}, silent);
  const occ::PreparedModel after = occ::united(before, {}, silent);
  REQUIRE(after.labels.size() == after.bodies.size());
  // The sphere, and of the box two ends and twice four sides.
  REQUIRE(after.labels.size() == 11);
  CHECK(after.labels[0].name == "face 1");
  CHECK(after.bodies[0] == 0);
  for (std::size_t f = 1; f < after.labels.size(); ++f) {
    CHECK(after.labels[f].name != "face 1");
    CHECK(after.labels[f].layer == "layer " + std::to_string(after.labels[f].number));
    CHECK(after.bodies[f] == 1);
  }
  for (int i = 2; i <= 7; ++i) {
    const auto named = std::ranges::count(after.labels, i, &CadFace::number);
    CHECK((named == 1 || named == 2));
  }
}
