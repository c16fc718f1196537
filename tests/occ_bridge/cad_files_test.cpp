// Files of many CAD systems, where their folder is there: what each holds was counted by other programs or
// follows from what it shows; see the table in docs/cad.md.
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <map>

#include "occ_bridge/cad_model.hpp"
#include "tests/catch.hpp"

using namespace flowcage;

namespace {

struct Expected {
  int faces;       ///< as read, before any split
  int free_edges;  ///< -1: not closed by any tolerance
  double unit;
};

const std::map<std::string, Expected> files{
    {"ansys_poultry.stp", {48, 0, 1}},
    {"as1_tu_203.stp", {160, 0, 1e-3}},
    {"b777_onshape.step", {51, -1, 1}},
    {"b777_vsp.stp", {-1, -1, 0.3048}},
    {"bearing.iges", {213, -1, 1e-3}},
    {"d150_wing.igs", {8, 0, 1e-3}},
    {"dtmb5415_bow.iges", {1, -1, 1}},
    {"elmer_cyl_channel.iges", {10, 0, 1e-3}},
    {"esp_closebody.stp", {5, -1, 1}},
    {"esp_iges2.igs", {43, 0, 1e-3}},
    {"esp_wingsew1.stp", {6, 0, 0.3048}},
    {"f16_vsp.stp", {-1, 0, 0.3048}},
    {"fusee.stp", {249, 0, 1}},
    {"gmsh_sewfaces.step", {22, -1, 1e-3}},
    {"iea15_cfd.igs", {3, -1, 1}},
    {"iea15_cfd.stp", {3, -1, 1e-3}},
    {"iea15_nacelle.step", {10, 0, 1}},
    {"kcs.iges", {55, -1, 1}},
    {"kurbelwelle.stp", {58, 0, 1e-3}},
    {"linkrods.step", {-1, 0, 1e-3}},
    {"mambo_m1.step", {42, 0, 1e-3}},
    {"nist_1.stp", {113, 0, 1e-3}},
    {"nist_11.stp", {10, 0, 1e-3}},
    {"onera_m6_su2.iges", {7, 0, 1}},
    {"pump_carter.stp", {119, 0, 1e-3}},
    {"pygem_pipe.step", {6, 0, 1e-3}},
    {"pygem_pipe_deformed.step", {6, -1, 1e-3}},
    {"series60.iges", {1, -1, 1}},
    {"solid56.step", {48, 0, 1e-3}},
    {"sphere_rhino.igs", {1, 0, 1e-3}},
    {"sunglasses_lens.igs", {9, -1, 0.0254}},
    {"t106_blade.step", {8, 0, 1}},
    {"tigl_simplewing.brep", {8, 0, 1}},
    {"twocars.igs", {56, 0, 1e-3}},
    {"vsp_wing_thick_te2.stp", {-1, -1, 0.3048}},
    {"wigley.step", {1, -1, 1}},
    {"wing_fuselage_gmsh.step", {16, 0, 1}},
};

const std::filesystem::path folder = FLOWCAGE_REAL_CAD_DIR;

bool absent() {
  if (std::filesystem::is_directory(folder)) return false;
  std::puts("skipped: no folder of real CAD files");
  return true;
}

}  // namespace

TEST_CASE("every file is read: unit, faces, closed or not; chains are continuous curves") {
  if (absent()) return;
  for (const auto& [name, expected] : files) {
    const std::string file = (folder / name).string();
    if (!std::filesystem::exists(file)) continue;
    CAPTURE(name);
    Progress silent;
    const auto start = std::chrono::steady_clock::now();
    const CadModel model = read_cad({&file, 1}, {}, silent);
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    const CadSummary& found = model.summary();
    CHECK(seconds.count() < 30);  // 4 s on a free core
    CHECK(found.files[0].unit_in_metres == Approx(expected.unit));
    if (expected.faces > 0) CHECK(found.files[0].faces == expected.faces);
    CHECK(found.closed() == (expected.free_edges == 0));
    if (found.closed()) CHECK(found.solids > 0);
    CHECK(found.triangles > 0);
    const FeatureGraph& graph = model.features();
    for (Index c = 0; c < static_cast<Index>(graph.chains.size()); ++c) {
      const FeatureChain& chain = graph.chains[c];
      REQUIRE(chain.length > 0);
      REQUIRE(chain.polyline.size() == chain.polyline_s.size());
      const double tolerance = 2e-4 * found.diagonal;  // of the files' own edges and vertices
      if (chain.start != no_index) {
        CHECK((graph.corners[chain.start] - chain.polyline.front()).norm() < tolerance);
        CHECK((graph.corners[chain.end] - chain.polyline.back()).norm() < tolerance);
      }
      double chords = 0;
      for (std::size_t i = 0; i + 1 < chain.polyline.size(); ++i) {
        chords += (chain.polyline[i + 1] - chain.polyline[i]).norm();
        CHECK(chain.polyline_s[i + 1] >= chain.polyline_s[i]);
      }
      CHECK(chords == Approx(chain.length).epsilon(0.01).margin(tolerance));
      for (int k = 0; k < 5; ++k) {
        const CurvePoint p = model.chain_point(c, chain.length * (0.1 + 0.2 * k));
        const CurvePoint foot = model.closest_on_chain(c, p.position);
        CHECK(foot.distance < 1e-9 * found.diagonal);
        CHECK(p.tangent.norm() == Approx(1));
      }
    }
  }
}

TEST_CASE("wire frames are refused") {
  if (absent()) return;
  for (const char* name : {"ge6.igs", "c172_wing.igs"}) {
    const std::string file = (folder / name).string();
    Progress silent;
    try {
      read_cad({&file, 1}, {}, silent);
      FAIL("read");
    } catch (const Error& error) {
      CHECK(error.kind() == ErrorKind::input);
      CHECK(std::string(error.what()).find(file + ": no surface in it") == 0);
    }
  }
}

TEST_CASE("both exports of one blade are the same blade, up to the unit that one of them misstates") {
  if (absent()) return;
  const std::string metres = (folder / "iea15_cfd.igs").string(),
                    millimetres = (folder / "iea15_cfd.stp").string();
  Progress silent;
  const CadModel right = read_cad({&metres, 1}, {}, silent);
  CadReadSettings settings;
  settings.cad_unit = std::string("m");  // a plain literal trips -Wrestrict of GCC 12
  const CadModel overruled = read_cad({&millimetres, 1}, settings, silent);
  CHECK(overruled.diagonal() == Approx(right.diagonal()).epsilon(1e-4));
  CHECK(overruled.summary().sharp_edges == right.summary().sharp_edges);
}
