// Creases of hand-drawn cages found again on CAD read by the kernel: the bodies of the fit's table, the
// example's M6, a box with a hole through it, and wings with noise in the cage.
#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "core/cage/read_cage.hpp"
#include "core/mesh/surface_level.hpp"
#include "core/project/find_creases.hpp"
#include "core/refit/cage_topology.hpp"
#include "occ_bridge/cad_model.hpp"
#include "occ_bridge/shapes.hpp"
#include "tests/catch.hpp"
#include "tests/refit/fit_bodies.hpp"
#include "tests/refit/hand_drawn_cages.hpp"

using namespace flowcage;
using namespace flowcage::test;

namespace {

std::set<std::pair<Index, Index>> crease_set(const Cage& cage) {
  std::set<std::pair<Index, Index>> edges;
  for (const Cage::Crease& c : cage.creases) edges.insert(std::minmax(c.a, c.b));
  return edges;
}

FoundCreases found_again(Cage cage, const TargetSurface& target) {
  cage.creases.clear();
  cage.corners.clear();
  return find_creases(cage, target);
}

/// A slab [-1, 1]^2 x [0, 1] with a round hole of radius 0.4 along z: rings of eight outside and inside.
Cage holed_slab_cage() {
  Cage cage = empty_cage();
  for (const double z : {0.0, 1.0}) {
    for (int k = 0; k < 8; ++k) {
      const double c = std::cos(std::numbers::pi / 4 * k), s = std::sin(std::numbers::pi / 4 * k);
      const double outward = 1 / std::max(std::abs(c), std::abs(s));
      cage.points.emplace_back(outward * c, outward * s, z);
    }
    for (int k = 0; k < 8; ++k) {
      cage.points.emplace_back(0.43 * std::cos(std::numbers::pi / 4 * k),
                               0.43 * std::sin(std::numbers::pi / 4 * k), z);
    }
  }
  const auto outer = [](Index z, Index k) { return 16 * z + k % 8; };
  const auto inner = [](Index z, Index k) { return 16 * z + 8 + k % 8; };
  for (Index k = 0; k < 8; ++k) {
    add_face(cage, {outer(0, k), outer(0, k + 1), outer(1, k + 1), outer(1, k)});
    add_face(cage, {inner(0, k + 1), inner(0, k), inner(1, k), inner(1, k + 1)});
    add_face(cage, {outer(1, k), outer(1, k + 1), inner(1, k + 1), inner(1, k)});
    add_face(cage, {outer(0, k + 1), outer(0, k), inner(0, k), inner(0, k + 1)});
    for (const Index z : {0, 1}) {
      add_crease(cage, outer(z, k), outer(z, k + 1));
      add_crease(cage, inner(z, k), inner(z, k + 1));
    }
    if (k % 2 == 1) add_crease(cage, outer(0, k), outer(1, k));
  }
  return cage;
}

}  // namespace

TEST_CASE("creases of the fit's bodies are found again", "[creases][cad]") {
  for (const std::string& name : fit_body_names()) {
    INFO(name);
    const FitBody body = make_fit_body(name);
    CHECK(crease_set(found_again(body.cage, body.cad).cage) == crease_set(body.cage));
  }
}

TEST_CASE("ONERA M6: the trailing edge, with a corner at the rounded tip", "[creases][cad]") {
  Progress silent;
  const CadModel model = cad_model_of(make_onera_m6(), {}, silent);
  const Cage cage = scale_cage(read_cage(FLOWCAGE_SOURCE_DIR "/examples/02_onera_m6/cage.obj"), 1e-3);
  const FoundCreases found = found_again(cage, model);
  CHECK(crease_set(found.cage) == crease_set(cage));
  CHECK(found.cage.corners == cage.corners);
  CHECK(found.warnings.empty());
}

TEST_CASE("a slab with a hole: genus 1, rims and edges found with noise", "[creases][cad]") {
  Progress silent;
  const Shape slab = translated(make_box(Vec3(2, 2, 1)), Vec3(0, 0, 0.5));
  const CadModel model =
      cad_model_of(make_difference(slab, translated(make_cylinder(0.4, 3), Vec3(0, 0, -1))), {}, silent);
  CHECK(target_topology(model).value().genus == 1);
  const Cage cage = holed_slab_cage();
  CHECK(topology_of(build_surface_level(cage)).genus == 1);
  int again = 0;
  for (unsigned seed = 0; seed < 20; ++seed) {
    const Cage drawn = with_noise(cage, 0.03 * model.diagonal() * (seed > 0 ? 1 : 0), seed);
    again += crease_set(found_again(drawn, model).cage) == crease_set(cage);
  }
  CHECK(again == 20);
}
