#include "core/project/find_creases.hpp"

#include <algorithm>
#include <set>

#include "core/target/analytic_surfaces.hpp"
#include "tests/catch.hpp"
#include "tests/refit/hand_drawn_cages.hpp"
#include "tests/refit/patch_target.hpp"

using namespace flowcage;
using namespace flowcage::test;

namespace {

std::set<std::pair<Index, Index>> crease_set(const Cage& cage) {
  std::set<std::pair<Index, Index>> edges;
  for (const Cage::Crease& c : cage.creases) edges.insert(std::minmax(c.a, c.b));
  return edges;
}

Cage stripped(Cage cage) {
  cage.creases.clear();
  cage.corners.clear();
  return cage;
}

/// Whether the creases of a hand-drawn cage are found again without its tags.
bool found_again(const Cage& drawn, const TargetSurface& target) {
  return crease_set(find_creases(stripped(drawn), target).cage) == crease_set(drawn);
}

/// Of 20 seeds, how many times they are found again with every vertex moved by up to `noise`.
int found_with_noise(const Cage& drawn, const TargetSurface& target, double noise) {
  int count = 0;
  for (unsigned seed = 1; seed <= 20; ++seed) count += found_again(with_noise(drawn, noise, seed), target);
  return count;
}

}  // namespace

TEST_CASE("creases of hand-drawn cages are found again, with noise in the vertices", "[creases]") {
  const Box3 box(Vec3(0, 0, 0), Vec3(1, 2, 3));
  const auto box_target = box_surface(box);
  const Cage drawn_box = box_cage(box.min(), box.max(), true);
  const auto cylinder = cylinder_surface({});
  const Cage drawn_cylinder = cylinder_cage(1, 1);
  CHECK(found_again(drawn_box, *box_target));
  CHECK(found_again(drawn_cylinder, *cylinder));
  for (const double noise : {0.01, 0.03}) {
    CHECK(found_with_noise(drawn_box, *box_target, noise * box_target->diagonal()) == 20);
    CHECK(found_with_noise(drawn_cylinder, *cylinder, noise * cylinder->diagonal()) == 20);
  }
  for (const double half_base : {0.0, 0.0025, 0.0005}) {
    INFO("base " << 2 * half_base << " of the chord");
    WingCageShape wing;
    wing.half_base = half_base;
    const auto target = wing_target(wing, TipShape::flat);
    const Cage drawn = wing_cage(wing);
    CHECK(found_again(drawn, *target));
    CHECK(found_with_noise(drawn, *target, 0.01) == 20);
    // 5 % of the tip's chord; its section is 3.6 % thick on either side of the chord line.
    CHECK(found_with_noise(drawn, *target, 0.03) >= (half_base > 0 ? 12 : 19));
  }
}

TEST_CASE("a vertex where a crease ends or turns becomes a corner", "[creases]") {
  // A rounded tip ends the trailing edge: one chain, one corner there; at the open root three sharp edges
  // meet.
  WingCageShape wing;
  const auto target = wing_target(wing, TipShape::rounded);
  Cage cage = wing_cage(wing);
  for (Index v = 24; v < 26; ++v) cage.points[v].y() += 0.03;
  const FoundCreases found = find_creases(stripped(cage), *target);
  CHECK(crease_set(found.cage) == std::set<std::pair<Index, Index>>{{0, 6}, {6, 12}, {12, 18}});
  CHECK(found.corners == std::vector<Index>{18});
  REQUIRE(found.cage.corners.size() == 1);
  CHECK(found.cage.corners[0] == Cage::Corner{18, infinitely_sharp});
  // Three creases make a corner by themselves.
  const Box3 box(Vec3::Zero(), Vec3::Ones());
  CHECK(find_creases(box_cage(box.min(), box.max(), false), *box_surface(box)).corners.empty());
}

TEST_CASE("a boundary that turns gets corners where the cage has more than one face", "[creases]") {
  // A square sheet, its corners cut into two faces each by a cage turned by 45 degrees inside.
  const auto target = sheet_surface(Vec3::Zero(), Vec3::UnitX(), Vec3::UnitY());
  Cage cage = empty_cage();
  cage.points = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0.5, 0.5, 0}};
  for (Index i = 0; i < 4; ++i) add_face(cage, {4, i, (i + 1) % 4});
  const FoundCreases found = find_creases(cage, *target);
  CHECK(found.crease_edges == 0);
  CHECK(found.corners == std::vector<Index>{0, 1, 2, 3});
}

TEST_CASE("a cage coarser than the CAD: two edges share a crease, the detail is left out", "[creases]") {
  WingCageShape wing;
  wing.half_base = 0.0005;
  const auto target = wing_target(wing, TipShape::flat);
  const Cage sharp = wing_cage({});  // one line along the trailing edge, where the CAD has two
  const FoundCreases found = find_creases(stripped(sharp), *target);
  CHECK(crease_set(found.cage) == crease_set(sharp));
  REQUIRE(found.warnings.size() == 2);
  CHECK_THAT(found.warnings[0], contains_text("no edges of the cage follow 1 sharp edge of the CAD (from ("));
  CHECK_THAT(found.warnings[1], contains_text("1 sharp edge of the CAD is left out, shorter than"));
}

TEST_CASE("sharp edges that no edges of the cage follow are named, none is forced on them", "[creases]") {
  // A cylinder inside of a cube's cage: no edge runs along its rims.
  const auto cylinder = cylinder_surface({});
  const FoundCreases found = find_creases(box_cage(Vec3(-1, -1, -0.6), Vec3(1, 1, 1.6), false), *cylinder);
  CHECK(found.crease_edges == 0);
  CHECK(found.sharp_chains == 2);
  CHECK(found.followed == 0);
  REQUIRE(found.warnings.size() == 1);
  CHECK_THAT(found.warnings[0], contains_text("follow 2 sharp edges of the CAD (from ("));
  const FoundCreases smooth =
      find_creases(box_cage(Vec3::Constant(-1), Vec3::Ones(), false), *sphere_surface(Vec3::Zero(), 1));
  CHECK(smooth.crease_edges == 0);
  CHECK(smooth.warnings.empty());
}
