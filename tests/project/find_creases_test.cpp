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
    CHECK(found_with_noise(drawn, *target, 0.03) == 20);
  }
}
#include <iostream>
TEST_CASE("debug", "[.debug]") {
  for (const double half_base : {0.0, 0.0025}) {
    WingCageShape wing;
    wing.half_base = half_base;
    const auto target = wing_target(wing, TipShape::flat);
    const Cage drawn = wing_cage(wing);
    for (double noise : {0.01, 0.03})
    for (unsigned seed = 1; seed <= 20; ++seed) {
      const auto found = find_creases(stripped(with_noise(drawn, noise, seed)), *target);
      const auto a = crease_set(found.cage), b = crease_set(drawn);
      if (a == b) continue;
      std::cout << half_base << " " << noise << " seed " << seed << " missing";
      for (auto e : b) if (!a.count(e)) std::cout << " " << e.first << "-" << e.second;
      std::cout << " extra";
      for (auto e : a) if (!b.count(e)) std::cout << " " << e.first << "-" << e.second;
      std::cout << "\n";
      for (auto& w : found.warnings) std::cout << "   " << w << "\n";
    }
  }
}
