#include "core/cage/lint_cage.hpp"

#include <algorithm>

#include "core/base/error.hpp"
#include "core/cage/face_crossings.hpp"
#include "core/cage/orient_faces.hpp"
#include "core/cage/read_cage.hpp"
#include "core/mesh/manifold_check.hpp"
#include "core/mesh/surface_level.hpp"
#include "tests/catch.hpp"
#include "tests/refit/hand_drawn_cages.hpp"

using namespace flowcage;
using namespace flowcage::test;

namespace {

std::vector<std::string> rules(const LintReport& report) {
  std::vector<std::string> names;
  for (const LintFinding& finding : report) names.push_back(finding.rule);
  return names;
}
using Rules = std::vector<std::string>;

/// A sheet of nx by ny quads in z = 0; vertex i + (nx + 1) j.
Cage sheet(Index nx, Index ny) {
  Cage cage = empty_cage();
  for (Index j = 0; j <= ny; ++j) {
    for (Index i = 0; i <= nx; ++i) cage.points.emplace_back(i, j, 0);
  }
  for (Index j = 0; j < ny; ++j) {
    for (Index i = 0; i < nx; ++i) {
      const Index v = i + (nx + 1) * j;
      add_face(cage, {v, v + 1, v + nx + 2, v + nx + 1});
    }
  }
  return cage;
}

/// A disc of one face with n corners, z up.
void add_disc(Cage& cage, Index n) {
  std::vector<Index> face;
  for (Index i = 0; i < n; ++i) {
    const double a = 2 * std::numbers::pi * i / n;
    face.push_back(static_cast<Index>(cage.points.size()));
    cage.points.emplace_back(std::cos(a), std::sin(a), 0);
  }
  cage.faces.push_row(face);
  cage.face_patch.push_back(0);
}

constexpr const char* cube_text =
    "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nv 0 0 1\nv 1 0 1\nv 0 1 1\nv 1 1 1\n"
    "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\n";

}  // namespace

TEST_CASE("hand-drawn cages pass the linter", "[lint]") {
  CHECK(rules(lint_cage_shape(box_cage(Vec3::Zero(), Vec3::Ones(), true))).empty());
  CHECK(rules(lint_cage_shape(torus_cage(1, 0.4, 4, 4))).empty());
  CHECK(rules(lint_cage_shape(cylinder_cage(1, 1))).empty());
  CHECK(split_crease_sectors(cylinder_cage(1, 1), true).findings.empty());
  CHECK(split_crease_sectors(box_cage(Vec3::Zero(), Vec3::Ones(), true), true).findings.empty());
  for (const double half_base : {0.0, 0.0005}) {
    WingCageShape wing;
    wing.half_base = half_base;
    CHECK(rules(lint_cage_shape(wing_cage(wing))).empty());
    CHECK(split_crease_sectors(wing_cage(wing), true).findings.empty());
  }
}

TEST_CASE("edge lengths that jump along a line are named with the worst place", "[lint]") {
  Cage cage = sheet(4, 2);
  for (Vec3& p : cage.points) p.x() = p.x() < 2 ? 0.05 * p.x() : p.x() - 1.9;  // 0 .05 .1 1.1 2.1
  const LintReport report = lint_cage_shape(cage);
  REQUIRE(rules(report) == Rules{"edge_lengths"});
  CHECK(report[0].severity == LintFinding::Severity::warning);
  CHECK(report[0].places.size() == 3);  // the column at x = .1: the inner vertex and the two of the boundary
  CHECK(report[0].places[0].x() == Approx(0.1));
  CHECK_THAT(report[0].message, contains_text("by 20, at"));
  // Across a crease nothing goes on.
  add_crease(cage, 2, 7);
  add_crease(cage, 7, 12);
  CHECK(rules(lint_cage_shape(cage)).empty());
}

TEST_CASE("a seam that was not merged is named", "[lint]") {
  Cage cage = sheet(2, 1);
  for (Vec3& p : sheet(2, 1).points) cage.points.emplace_back(p.x(), p.y() + 1.0005, p.z());
  add_face(cage, {6, 7, 10, 9});
  add_face(cage, {7, 8, 11, 10});
  const LintReport report = lint_cage_shape(cage);
  REQUIRE(rules(report) == Rules{"close_vertices"});
  CHECK(report[0].places.size() == 3);
}

TEST_CASE("faces without area, folded ones, and many corners are named", "[lint]") {
  Cage flat = sheet(3, 1);
  flat.points[2].y() = 1;  // the second face's lower side rises to its upper one: half of it has no area left
  flat.points[1].y() = 1 - 1e-6;
  flat.points[6].y() = 1 + 1e-6;
  CHECK(rules(lint_cage_shape(flat)) == Rules{"flat_face"});
  Cage dart = sheet(1, 1);
  dart.points[3] = Vec3(0.3, 0.3, 0);  // an arrowhead
  const LintReport folded = lint_cage_shape(dart);
  REQUIRE(rules(folded) == Rules{"folded_face"});
  CHECK_THAT(folded[0].message, contains_text("face 1 at "));
  Cage disc = empty_cage();
  add_disc(disc, 12);
  CHECK(rules(lint_cage_shape(disc)) == Rules{"face_corners"});
  Cage fan = empty_cage();
  for (Index i = 0; i < 12; ++i) {
    fan.points.emplace_back(std::cos(2 * std::numbers::pi * i / 12), std::sin(2 * std::numbers::pi * i / 12),
                            0);
  }
  fan.points.emplace_back(0, 0, 0);
  for (Index i = 0; i < 12; ++i) add_face(fan, {12, i, (i + 1) % 12});
  CHECK(rules(lint_cage_shape(fan)) == Rules{"valence"});
}

TEST_CASE("a face alone between two crease edges gets a ring of quads", "[lint]") {
  // A box whose upper rim is a crease without corners: each of its vertices has one face inside the rim.
  Cage cage = box_cage(Vec3::Zero(), Vec3::Ones(), false);
  for (const auto& [a, b] : {std::pair<Index, Index>{4, 5}, {5, 7}, {7, 6}, {6, 4}}) add_crease(cage, a, b);
  const SplitSectors left = split_crease_sectors(cage, false);
  REQUIRE(rules(left.findings) == Rules{"crease_sector"});
  CHECK(left.findings[0].severity == LintFinding::Severity::warning);
  CHECK(left.cage.faces == cage.faces);
  const SplitSectors split = split_crease_sectors(cage, true);
  REQUIRE(rules(split.findings) == Rules{"crease_sector"});
  CHECK(split.findings[0].severity == LintFinding::Severity::mended);
  CHECK(split.findings[0].places.size() == 4);
  CHECK(split.cage.faces.size() == 10);
  CHECK(split.cage.points.size() == 12);
  CHECK(split.cage.face_patch.size() == 10);
  CHECK_FALSE(find_manifold_defect(split.cage));
  CHECK(topology_of(build_surface_level(split.cage)).genus == 0);
  for (std::size_t v = 8; v < 12; ++v) CHECK(split.cage.points[v].z() == 1.0);
  // Done once, nothing is left to do.
  CHECK(split_crease_sectors(split.cage, true).findings.empty());
  // A corner is no smooth crease vertex.
  for (const Index v : {4, 5, 6, 7}) cage.corners.push_back({v, infinitely_sharp});
  CHECK(split_crease_sectors(cage, true).findings.empty());
}

TEST_CASE("faces that run against their neighbours are reversed on reading", "[lint]") {
  const std::string turned = std::string(cube_text) + "f 3 4 8 7\nf 1 5 7 3\nf 2 4 8 6\n";  // face 4 is
  CHECK_THROWS_AS(parse_cage(turned, "c.obj"), Error);
  const MendedCage mended = parse_mended_cage(turned, "c.obj");
  CHECK_FALSE(find_manifold_defect(mended.cage));
  REQUIRE(rules(mended.mended) == Rules{"face_direction"});
  CHECK_THAT(mended.mended[0].message, contains_text("c.obj:12: 1 face ran against"));
  CHECK((mended.mended[0].places.at(0) - Vec3(0.5, 1, 0.5)).norm() < 1e-15);
  const MendedCage right =
      parse_mended_cage(std::string(cube_text) + "f 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n", "c.obj");
  CHECK(right.mended.empty());
  CHECK(right.cage.points == mended.cage.points);
}

TEST_CASE("a surface with one side only is refused with its line", "[lint]") {
  // A Moebius strip of five quads.
  std::string text;
  for (int i = 0; i < 5; ++i) {
    const double a = 2 * std::numbers::pi * i / 5;
    for (const int side : {-1, 1}) {
      const double r = 1 + 0.3 * side * std::cos(a / 2);
      text += "v " + std::to_string(r * std::cos(a)) + " " + std::to_string(r * std::sin(a)) + " " +
              std::to_string(0.3 * side * std::sin(a / 2)) + "\n";
    }
  }
  text += "f 1 3 4 2\nf 3 5 6 4\nf 5 7 8 6\nf 7 9 10 8\nf 9 2 1 10\n";
  try {
    parse_mended_cage(text, "m.obj");
    FAIL("accepted");
  } catch (const Error& error) {
    CHECK_THAT(std::string(error.what()), contains_text("m.obj:"));
    CHECK_THAT(std::string(error.what()), contains_text("in the same direction"));
  }
}

TEST_CASE("of each part the fewer faces are reversed", "[lint]") {
  Csr<Index> faces;
  faces.push_row(std::vector<Index>{0, 1, 2});
  faces.push_row(std::vector<Index>{1, 2, 3});
  faces.push_row(std::vector<Index>{3, 2, 4});
  CHECK(faces_to_reverse(faces) == std::vector<Index>{0});
  faces.push_row(std::vector<Index>{10, 11, 12});
  faces.push_row(std::vector<Index>{11, 12, 13});  // as many: the part's first face stays
  CHECK(faces_to_reverse(faces) == std::vector<Index>{0, 4});
  faces.push_row(std::vector<Index>{11, 12, 14});  // a third face at the edge
  CHECK_FALSE(faces_to_reverse(faces));
}

TEST_CASE("faces that pass through each other are named with a place", "[lint]") {
  CHECK(find_face_crossings(box_cage(Vec3::Zero(), Vec3::Ones(), true)).empty());
  CHECK(find_face_crossings(torus_cage(1, 0.4, 4, 4)).empty());
  // A torus whose tube is wider than its ring: opposite sides of the hole cross.
  CHECK_FALSE(find_face_crossings(torus_cage(0.3, 0.4, 4, 4)).empty());
  // A sheet and one square that stands in the middle of face 4 of nine, or only on it.
  for (const double low : {-0.25, 0.0}) {
    Cage cage = sheet(3, 3);
    const Index v = static_cast<Index>(cage.points.size());
    cage.points.insert(cage.points.end(), {{1.4, 1.5, low}, {1.6, 1.5, low}, {1.6, 1.5, 1}, {1.4, 1.5, 1}});
    add_face(cage, {v, v + 1, v + 2, v + 3});
    const std::vector<FaceCrossing> crossings = find_face_crossings(cage);
    if (low == 0) {
      CHECK(crossings.empty());
      continue;
    }
    REQUIRE(crossings.size() == 1);
    CHECK(crossings[0].a == 4);
    CHECK(crossings[0].b == 9);
    CHECK(std::abs(crossings[0].place.z()) < 1e-12);
    const LintReport report = lint_face_crossings(cage);
    REQUIRE(rules(report) == Rules{"self_crossing"});
    CHECK(report[0].message.find("faces 5 and 10") != std::string::npos);
  }
  // Two copies of a square that were not merged touch all along: close_vertices, not this.
  Cage slit = sheet(1, 1);
  slit.points.insert(slit.points.end(), {{1, 0, 0}, {2, 0, 0}, {1, 1, 0}, {2, 1, 0}});
  add_face(slit, {4, 5, 7, 6});
  CHECK(find_face_crossings(slit).empty());
}
