#include "core/mesh/manifold_check.hpp"

#include <limits>

#include "core/base/error.hpp"
#include "tests/catch.hpp"

using namespace flowcage;
using Kind = CageDefect::Kind;

namespace {

Cage cube() {
  Cage cage;
  for (int i = 0; i < 8; ++i) cage.points.emplace_back(i & 1, (i >> 1) & 1, (i >> 2) & 1);
  for (const auto& face : std::vector<std::vector<Index>>{
           {0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}) {
    cage.faces.push_row(face);
  }
  return cage;
}

Cage with_faces(int points, const std::vector<std::vector<Index>>& faces) {
  Cage cage;
  for (int i = 0; i < points; ++i) cage.points.emplace_back(i, i * i, 0.5 * i);
  for (const auto& face : faces) cage.faces.push_row(face);
  return cage;
}

void check(const Cage& cage, Kind kind, CageDefect::Element element, Index index, const std::string& text) {
  const auto defect = find_manifold_defect(cage);
  REQUIRE(defect);
  CHECK(defect->kind == kind);
  CHECK(defect->element == element);
  CHECK(defect->index == index);
  CHECK_THAT(defect->message, contains_text(text));
  CHECK_FALSE(defect->remedy.empty());
}

}  // namespace

TEST_CASE("manifold check: usable cages") {
  CHECK_FALSE(find_manifold_defect(cube()));
  CHECK_FALSE(find_manifold_defect(with_faces(3, {{0, 1, 2}})));
  CHECK_FALSE(find_manifold_defect(with_faces(4, {{0, 1, 2}, {0, 2, 3}})));
  // Two components, and a face with five vertices.
  CHECK_FALSE(find_manifold_defect(with_faces(8, {{0, 1, 2, 3, 4}, {5, 6, 7}})));
  // A fan that is closed round an interior vertex, given in no particular order.
  CHECK_FALSE(find_manifold_defect(with_faces(5, {{0, 1, 2}, {0, 3, 4}, {0, 2, 3}, {0, 4, 1}})));
  Cage tagged = cube();
  tagged.creases = {{0, 1, 2.5}, {1, 0, 0.0}};
  tagged.corners = {{7, 10.0}};
  tagged.face_patch = {0, 0, 1, 1, 0, 0};
  tagged.patch_names = {"a", "b"};
  CHECK_FALSE(find_manifold_defect(tagged));
}

TEST_CASE("manifold check: each defect is named with its place") {
  using Element = CageDefect::Element;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  check(Cage{}, Kind::empty, Element::cage, no_index, "no faces");

  Cage cage = cube();
  cage.points[3].y() = nan;
  check(cage, Kind::point_not_finite, Element::vertex, 3, "vertex 4");

  cage = cube();
  cage.face_patch = {0};
  check(cage, Kind::bad_patch, Element::cage, no_index, "6 faces but 1");
  cage.face_patch = {0, 0, 0, 1, 0, 0};
  cage.patch_names = {""};
  check(cage, Kind::bad_patch, Element::face, 3, "face 4");

  check(with_faces(3, {{0, 1, 2}, {0, 1}}), Kind::face_too_small, Element::face, 1, "face 2 has 2");
  check(with_faces(3, {{0, 1, 3}}), Kind::index_out_of_range, Element::face, 0, "names vertex 4");
  check(with_faces(3, {{0, 1, -1}}), Kind::index_out_of_range, Element::face, 0, "names vertex 0");
  check(with_faces(3, {{0, 1, std::numeric_limits<Index>::max()}}), Kind::index_out_of_range, Element::face,
        0, "names vertex 2147483648");
  check(with_faces(4, {{0, 1, 2}, {0, 2, 3, 2}}), Kind::face_repeats_vertex, Element::face, 1,
        "vertex 3 at (2, 4, 1) twice");
  check(with_faces(5, {{0, 1, 2}, {1, 0, 3}, {0, 1, 4}}), Kind::edge_overused, Element::face, 2,
        "edge 1-2 at (0.5, 0.5, 0.25)");
  check(with_faces(4, {{0, 1, 2}, {0, 1, 3}}), Kind::inconsistent_faces, Element::face, 1, "faces 1 and 2");
  check(with_faces(4, {{0, 1, 2}}), Kind::unused_vertex, Element::vertex, 3, "vertex 4 at (3, 9, 1.5)");

  // Two cones that touch in vertex 0; and two quads that touch in a corner.
  check(with_faces(7, {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {0, 4, 5}, {0, 5, 6}, {0, 6, 4}}), Kind::several_fans,
        Element::vertex, 0, "vertex 1 at (0, 0, 0)");
  check(with_faces(7, {{1, 2, 3, 0}, {4, 5, 3, 6}}), Kind::several_fans, Element::vertex, 3, "vertex 4");

  cage = cube();
  cage.points[6] = cage.points[1];
  check(cage, Kind::repeated_point, Element::vertex, 6, "vertex 7 at (1, 0, 0) repeats vertex 2");

  cage = cube();
  cage.creases = {{0, 1}, {0, 3}};
  check(cage, Kind::crease_is_no_edge, Element::crease, 1, "vertex 4 at (1, 1, 0)");
  cage.creases = {{0, 8}};
  check(cage, Kind::index_out_of_range, Element::crease, 0, "vertex 9");
  cage.creases = {{0, 1, -1.0}};
  check(cage, Kind::sharpness_not_positive, Element::crease, 0, "-1");
  cage.creases = {{0, 1, nan}};
  check(cage, Kind::sharpness_not_positive, Element::crease, 0, "nan");
  cage.creases = {};
  cage.corners = {{-1, 1.0}};
  check(cage, Kind::index_out_of_range, Element::corner, 0, "vertex 0");
  cage.corners = {{2, nan}};
  check(cage, Kind::sharpness_not_positive, Element::corner, 0, "vertex 3");
}

TEST_CASE("manifold check: the exception names the source") {
  Cage cage = with_faces(4, {{0, 1, 2}});
  cage.source = "wing.obj";
  CHECK_THROWS_WITH(require_manifold(cage), Catch::Matchers::StartsWith("wing.obj: vertex 4 at"));
  CHECK_NOTHROW(require_manifold(cube()));
}
