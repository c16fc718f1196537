// Automatic blocks of bodies built in code: topology, features, validity and deviation are known.
#include <map>

#include "core/auto_blocks.hpp"
#include "core/base/error.hpp"
#include "core/base/parallel.hpp"
#include "tests/blocks/ambient_bodies.hpp"
#include "tests/catch.hpp"

using namespace flowcage;
using namespace flowcage::test;

namespace {

PlacedBlocks blocks_of(const AmbientTestBody& body, AmbientSettings settings = {}) {
  Progress silent;
  settings.internal = body.internal;
  return place_blocks(make_ambient_blocks(body.cad, settings, silent), body.cad, silent);
}

std::map<std::string, int> quads_by_patch(const HexComplex& complex) {
  std::map<std::string, int> count;
  for (const Index p : complex.quad_patch) {
    if (p != no_index) ++count[complex.patches[p].name];
  }
  return count;
}

void check_body(const std::string& name) {
  CAPTURE(name);
  const AmbientTestBody body = make_ambient_body(name);
  const PlacedBlocks placed = blocks_of(body);
  const AmbientBlocks& blocks = placed.blocks;
  for (const AmbientFinding& f : blocks.report.findings) FAIL_CHECK(f.check << ": " << f.what);
  const Topology topology = topology_of(build_surface_level(blocks.cage));
  CHECK(topology.genus == body.genus);
  CHECK(topology.components == body.parts);
  CHECK(blocks.report.chains_matched == blocks.report.chains);
  CHECK(placed.unmatched_chains.empty());
  CHECK(placed.untangle.after.inverted == 0);

  // The cage is the complex's wall.
  REQUIRE(blocks.vertex_corner.size() == blocks.cage.points.size());
  REQUIRE(blocks.face_quad.size() == static_cast<std::size_t>(blocks.cage.faces.size()));
  for (std::size_t v = 0; v < blocks.cage.points.size(); ++v) {
    CHECK(blocks.complex.points[blocks.vertex_corner[v]] == blocks.cage.points[v]);
  }
  for (Index f = 0; f < blocks.cage.faces.size(); ++f) {
    std::array<Index, 4> quad = blocks.complex.quads[blocks.face_quad[f]], face{};
    for (int n = 0; n < 4; ++n) face[n] = blocks.vertex_corner[blocks.cage.faces[f][n]];
    std::sort(quad.begin(), quad.end());
    std::sort(face.begin(), face.end());
    CHECK(quad == face);
  }

  Progress silent;
  FitSettings fit_settings;
  fit_settings.levels = 2;
  const SurfaceFit fit = fit_surface(blocks.cage, body.cad, fit_settings, silent);
  CHECK(fit.levels.back().report.folds == 0);
  CHECK(fit.max_deviation < 1e-3);
  CHECK(fit.coverage_deviation < 1e-3);
}

}  // namespace

TEST_CASE("closed bodies round which the fluid flows") {
  for (const char* name : {"sphere", "torus", "box", "cylinder", "bracket", "two_bodies"}) check_body(name);
}

TEST_CASE("half models: wings and a fused wing-body, open in the symmetry plane") {
  for (const char* name : {"wing_sharp", "wing_blunt", "wing_body_fused"}) check_body(name);
}

TEST_CASE("internal flow: pipes and a channel with a block in it") {
  for (const char* name : {"elbow", "tee", "channel"}) check_body(name);
}

TEST_CASE("patches: far field, symmetry plane, wall; the symmetry plane is flat") {
  const PlacedBlocks placed = blocks_of(make_ambient_body("wing_blunt"));
  const HexComplex& complex = placed.blocks.complex;
  const std::map<std::string, int> count = quads_by_patch(complex);
  REQUIRE(count.size() == 3);
  CHECK(count.at("wall") == placed.blocks.cage.faces.size());
  CHECK(count.at("farfield") > 0);
  for (std::size_t q = 0; q < complex.quads.size(); ++q) {
    if (complex.quad_patch[q] == no_index ||
        complex.patches[complex.quad_patch[q]].type != PatchType::symmetry)
      continue;
    for (const Index v : complex.quads[q]) CHECK(std::abs(complex.points[v].y()) < 1e-9);
  }
  CHECK(count.at("symmetry") > 0);
}

TEST_CASE("a cage size is obeyed: half the size makes more quads") {
  AmbientSettings fine;
  const AmbientTestBody body = make_ambient_body("sphere");
  Progress silent;
  const AmbientBlocks coarse = make_ambient_blocks(body.cad, fine, silent);
  fine.cage_size = coarse.report.size[0] / 2;
  const AmbientBlocks finer = make_ambient_blocks(body.cad, fine, silent);
  CHECK(finer.cage.faces.size() > 3 * coarse.cage.faces.size());
  CHECK(finer.report.findings.empty());
}

TEST_CASE("a body smaller than a cell is refused, and a lost hole is found") {
  AmbientSettings coarse;
  coarse.max_blocks = 100;
  Progress silent;
  const AmbientTestBody body = make_ambient_body("bracket");
  try {
    make_ambient_blocks(body.cad, coarse, silent);
    FAIL("no error");
  } catch (const Error& error) {
    CHECK(error.kind() == ErrorKind::gate);
    CHECK_THAT(std::string(error.what()), contains_text("the limit is 100"));
  }
}

TEST_CASE("the same blocks on any number of threads") {
  const AmbientTestBody body = make_ambient_body("bracket");
  const int before = thread_count();
  set_thread_count(1);
  const PlacedBlocks one = blocks_of(body);
  set_thread_count(3);
  const PlacedBlocks three = blocks_of(body);
  set_thread_count(before);
  CHECK(one.blocks.complex.hexes == three.blocks.complex.hexes);
  REQUIRE(one.blocks.complex.points.size() == three.blocks.complex.points.size());
  bool same = true;
  for (std::size_t v = 0; v < one.blocks.complex.points.size(); ++v) {
    same = same && one.blocks.complex.points[v] == three.blocks.complex.points[v];
  }
  CHECK(same);
}
