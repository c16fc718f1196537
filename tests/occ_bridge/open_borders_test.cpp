// Open borders of shapes whose openings are known.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "occ_bridge/cad_model.hpp"
#include "tests/catch.hpp"
#include "tests/occ_bridge/labelled_cad.hpp"

using namespace flowcage;

namespace {

using Polygons = std::vector<std::vector<Vec3>>;

std::vector<OpenBorder> borders_of(const Shape& shape) {
  Progress silent;
  return cad_model_of(shape, {}, silent).summary().borders;
}

/// Sides of a box from 0 to `size`, without the lid.
Polygons crate(const Vec3& size) {
  const double a = size.x(), b = size.y(), c = size.z();
  return {{{0, 0, 0}, {0, b, 0}, {a, b, 0}, {a, 0, 0}},
          {{0, 0, 0}, {a, 0, 0}, {a, 0, c}, {0, 0, c}},
          {{0, b, 0}, {0, b, c}, {a, b, c}, {a, b, 0}},
          {{0, 0, 0}, {0, 0, c}, {0, b, c}, {0, b, 0}},
          {{a, 0, 0}, {a, b, 0}, {a, b, c}, {a, 0, c}}};
}

}  // namespace

TEST_CASE("a closed body has no open border") {
  CHECK(borders_of(make_box({1, 2, 3})).empty());
}

TEST_CASE("a half wing is cut by its symmetry plane") {
  const std::vector<OpenBorder> borders = borders_of(make_onera_m6());
  REQUIRE(borders.size() == 1);
  CHECK(borders[0].kind == BorderKind::plane);
  CHECK(borders[0].axis == 1);
  CHECK(borders[0].value == Approx(0).margin(1e-9));
  CHECK(borders[0].closed);
  CHECK(borders[0].length > 2 * 0.8059);
  CHECK(borders[0].length < 2.1 * 0.8059);
}

TEST_CASE("a crate without its lid is open in the lid's plane") {
  const std::vector<OpenBorder> borders = borders_of(make_faces(crate({1, 2, 3})));
  REQUIRE(borders.size() == 1);
  CHECK(borders[0].kind == BorderKind::plane);
  CHECK(borders[0].axis == 2);
  CHECK(borders[0].value == Approx(3));
  CHECK(borders[0].length == Approx(6));
  CHECK(borders[0].chains.size() == 4);
  CHECK((borders[0].place - Vec3(0.5, 1, 3)).norm() < 1e-9);
}

TEST_CASE("a half hull is open at its waterline and at its symmetry plane") {
  Polygons sides = crate({4, 1, 1});
  sides.erase(sides.begin() + 1);  // y = 0; z = 1 is open already
  std::vector<OpenBorder> borders = borders_of(make_faces(sides));
  REQUIRE(borders.size() == 2);
  std::ranges::sort(borders, {}, &OpenBorder::axis);
  CHECK(borders[0].kind == BorderKind::plane);
  CHECK(borders[0].axis == 1);
  CHECK(borders[0].value == Approx(0).margin(1e-9));
  CHECK(borders[0].length == Approx(6));  // keel and both stems
  CHECK(borders[1].kind == BorderKind::plane);
  CHECK(borders[1].axis == 2);
  CHECK(borders[1].value == Approx(1));
  CHECK(borders[1].length == Approx(6));
  CHECK(borders[0].loop == borders[1].loop);
}

TEST_CASE("a slit between two faces is a gap of its width") {
  const double slit = 0.004;
  Polygons sides = crate({1, 2, 3});
  sides.push_back({{0, 0, 3}, {1, 0, 3}, {1, 1, 3}, {0, 1, 3}});
  sides.push_back({{0, 1 + slit, 3}, {1, 1 + slit, 3}, {1, 2, 3}, {0, 2, 3}});
  // The long walls get a vertex where the slit is, so that both lids share their edges.
  sides[3] = {{0, 0, 0}, {0, 0, 3}, {0, 1, 3}, {0, 1 + slit, 3}, {0, 2, 3}, {0, 2, 0}};
  sides[4] = {{1, 0, 0}, {1, 2, 0}, {1, 2, 3}, {1, 1 + slit, 3}, {1, 1, 3}, {1, 0, 3}};
  const std::vector<OpenBorder> borders = borders_of(make_faces(sides));
  const auto gaps = std::ranges::count(borders, BorderKind::gap, &OpenBorder::kind);
  CHECK(gaps >= 1);
  double length = 0;
  for (const OpenBorder& border : borders) {
    if (border.kind != BorderKind::gap) continue;
    CHECK(border.width == Approx(slit));
    CHECK((border.place - Vec3(0.5, 1 + slit / 2, 3)).norm() < slit);
    length += border.length;
  }
  CHECK(length >= Approx(2));
}

TEST_CASE("an opening that parts of the body are beyond is a hole") {
  // A crate on a plate that is larger than its lid: the lid's loop has the plate above it.
  Polygons sides = crate({1, 1, 1});
  sides.push_back({{3, 0, 0}, {4, 0, 0}, {4, 1, 2}, {3, 1, 2}});
  std::vector<OpenBorder> borders = borders_of(make_faces(sides));
  const auto hole = std::ranges::find(borders, BorderKind::hole, &OpenBorder::kind);
  REQUIRE(hole != borders.end());
  CHECK(hole->axis == 2);
  CHECK(hole->value == Approx(1));
  CHECK(hole->length == Approx(4));
}

TEST_CASE("the rim of an open sheet") {
  // A twisted quad has no plane; a flat one fills the plane inside of its rim.
  const std::vector<OpenBorder> flat = borders_of(make_faces({{{0, 0, 0}, {2, 0, 1}, {2, 1, 1}, {0, 1, 0}}}));
  REQUIRE(flat.size() == 1);
  CHECK(flat[0].kind == BorderKind::sheet);
  CHECK(flat[0].closed);
  CHECK(flat[0].length == Approx(2 + 2 * std::sqrt(5.0)));
}

TEST_CASE("a tiny hole is a gap, whatever its shape") {
  const double r = 0.002;
  Polygons sides = crate({1, 1, 1});
  sides.push_back(
      {{0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0.5 + r, 1, 1}, {0.5, 1 - r, 1}, {0.5 - r, 1, 1}, {0, 1, 1}});
  sides[2] = {{0, 1, 0}, {0, 1, 1}, {0.5 - r, 1, 1}, {0.5 + r, 1, 1}, {1, 1, 1}, {1, 1, 0}};
  const std::vector<OpenBorder> borders = borders_of(make_faces(sides));
  REQUIRE(borders.size() == 1);
  CHECK(borders[0].kind == BorderKind::gap);
  CHECK(borders[0].width == Approx(std::hypot(2 * r, r)).epsilon(0.01));
}
