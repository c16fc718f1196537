#include "occ_bridge/shapes.hpp"

#include <BRepBndLib.hxx>
#include <BRepCheck_Analyzer.hxx>
#include <BRepGProp.hxx>
#include <Bnd_Box.hxx>
#include <GProp_GProps.hxx>
#include <TopExp_Explorer.hxx>
#include <numbers>

#include "occ_bridge/cad_model.hpp"
#include "occ_bridge/internal/shape_rep.hpp"
#include "tests/catch.hpp"

using namespace flowcage;

namespace {

double volume(const Shape& shape) {
  GProp_GProps properties;
  BRepGProp::VolumeProperties(shape.rep().shape, properties, 1e-10);
  return properties.Mass();
}

int count(const Shape& shape, TopAbs_ShapeEnum kind) {
  int n = 0;
  for (TopExp_Explorer e(shape.rep().shape, kind); e.More(); e.Next()) ++n;
  return n;
}

}  // namespace

TEST_CASE("solids have their analytic volumes") {
  const double pi = std::numbers::pi;
  CHECK(volume(make_sphere(0.5)) == Approx(pi / 6).epsilon(1e-9));
  CHECK(volume(make_torus(1, 0.25)) == Approx(2 * pi * pi * 0.0625).epsilon(1e-9));
  CHECK(volume(make_cylinder(0.5, 2)) == Approx(pi / 2).epsilon(1e-9));
  const double a = 1, r = 0.2, inner = a - 2 * r;
  CHECK(volume(make_rounded_box(Vec3(1, 1, 1), r)) == Approx(inner * inner * inner + 6 * inner * inner * r +
                                                             3 * pi * r * r * inner + 4 * pi * r * r * r / 3)
                                                          .epsilon(1e-9));
  CHECK(volume(make_difference(make_box(Vec3(1, 1, 1)), make_box(Vec3(0.5, 0.5, 2)))) ==
        Approx(0.75).epsilon(1e-12));
}

TEST_CASE("a closed wing is a valid solid with the prismatoid's volume") {
  HalfWing wing;
  wing.closed_root = true;
  for (const double half_base : {0.0, 0.00126}) {
    for (const WingTip tip : {WingTip::flat, WingTip::rounded}) {
      wing.airfoil = naca_symmetric(0.12, half_base);
      wing.tip = tip;
      const Shape shape = make_half_wing(wing);
      CHECK(BRepCheck_Analyzer(shape.rep().shape).IsValid());
      CHECK(count(shape, TopAbs_FACE) == 4 + (half_base > 0 ? (tip == WingTip::flat ? 1 : 2) : 0));
      if (tip == WingTip::flat) {
        // Area of NACA 0012 per chord^2 is 2 * 0.6 * integral of the thickness polynomial, + the opened
        // wedge.
        const double area =
            10 * 0.12 * (0.2969 / 1.5 - 0.126 / 2 - 0.3516 / 3 + 0.2843 / 4 - 0.1036 / 5) + half_base;
        const double c0 = wing.root_chord, c1 = wing.tip_chord;
        CHECK(volume(shape) ==
              Approx(area * wing.semi_span * (c0 * c0 + c0 * c1 + c1 * c1) / 3).epsilon(2e-5));
      }
    }
  }
}

TEST_CASE("the M6 half wing has the published size and is open at its root only") {
  const Shape wing = make_onera_m6();
  CHECK(BRepCheck_Analyzer(wing.rep().shape).IsValid());
  CHECK(count(wing, TopAbs_FACE) == 3);
  Bnd_Box box;
  BRepBndLib::AddOptimal(wing.rep().shape, box, false, false);
  double x0, y0, z0, x1, y1, z1;
  box.Get(x0, y0, z0, x1, y1, z1);
  const double tip_chord = 0.8059 * 0.562;
  CHECK(x1 == Approx(1.1963 * std::tan(std::numbers::pi / 6) + tip_chord).margin(1e-6));
  CHECK(y0 == Approx(0).margin(2e-7));  // the edges' tolerance
  CHECK(y1 > 1.1963 + 0.048 * tip_chord);
  CHECK(y1 < 1.1963 + 0.050 * tip_chord);
  CHECK(z1 - z0 == Approx(2 * 0.0489296 * 0.8059).epsilon(0.01));
}

TEST_CASE("CAD files are written in each unit and format, and refused otherwise") {
  CHECK_THROWS_WITH(write_cad(make_sphere(1), "sphere.obj"), Catch::Contains("unknown CAD format"));
  CHECK_THROWS_WITH(write_cad(make_sphere(1), "sphere.step", "yd"), Catch::Contains("unknown unit"));
  CHECK_THROWS_WITH(write_cad(make_sphere(1), "no/such/folder/sphere.step"), Catch::Contains("cannot write"));
}

TEST_CASE("bounds are those of the surface, not of its triangles") {
  Progress silent;
  const auto bounds_are = [&](const Shape& shape, const Vec3& low, const Vec3& high) {
    const Box3 bounds = cad_model_of(shape, {}, silent).bounds();
    CHECK((bounds.min() - low).norm() < 1e-7 * (high - low).norm());
    CHECK((bounds.max() - high).norm() < 1e-7 * (high - low).norm());
  };
  bounds_are(make_sphere(2), {-2, -2, -2}, {2, 2, 2});
  bounds_are(make_cylinder(1, 3), {-1, -1, 0}, {1, 1, 3});
  bounds_are(make_torus(2, 0.6), {-2.6, -2.6, -0.6}, {2.6, 2.6, 0.6});
  bounds_are(make_box({2, 1, 1.5}), {-1, -0.5, -0.75}, {1, 0.5, 0.75});
}
