// `flowcage cage`, run as a user runs it.
#include <nlohmann/json.hpp>

#include "occ_bridge/shapes.hpp"
#include "tests/catch.hpp"
#include "tests/cli/run_program.hpp"

using namespace flowcage;

TEST_CASE("cage proposes a cage and blocks; the cage serves surface as it is") {
  const WorkFolder folder;
  write_cad(make_cylinder(0.5, 1), (folder.path() / "can.step").string(), "mm");
  const RunSettings in{.folder = folder.path()};
  const ProgramRun run =
      run_flowcage({"cage", "can.step", "-o", "cage.obj", "-o", "blocks.vtu", "--json", "cage.json"}, in);
  INFO(run.err);
  REQUIRE(run.exit_code == 0);
  CHECK_THAT(run.err, contains_text("2 of 2 chains"));
  const nlohmann::json report = nlohmann::json::parse(folder.text_of("cage.json"));
  CHECK(report["blocks"]["inverted_blocks"] == 0);
  CHECK(report["blocks"]["chains_matched"] == 2);
  CHECK(report["blocks"]["findings"].empty());
  CHECK(report["cage"]["genus"] == 0);
  // In the CAD's unit, which is what --cage is read in.
  const ProgramRun surface = run_flowcage(
      {"surface", "can.step", "--cage", "cage.obj", "--levels", "2", "-o", "fit.obj", "--json", "fit.json"},
      in);
  INFO(surface.err);
  CHECK(surface.exit_code == 0);
  const nlohmann::json fit = nlohmann::json::parse(folder.text_of("fit.json"));
  CHECK(fit["surface"]["max_deviation"].get<double>() < 1e-5);
  CHECK(fit["surface"]["unmatched_feature_chains"] == 0);
  const ProgramRun quality = run_flowcage({"quality", "blocks.vtu", "--json", "q.json"}, in);
  CHECK(quality.exit_code == 0);
  CHECK(nlohmann::json::parse(folder.text_of("q.json"))["volume"]["inverted_cells"] == 0);
}

TEST_CASE("cage: the same bytes on any number of threads") {
  const WorkFolder folder;
  write_cad(make_torus(1, 0.4), (folder.path() / "ring.step").string(), "m");
  const RunSettings in{.folder = folder.path()};
  CHECK(
      run_flowcage({"cage", "ring.step", "-o", "one.obj", "-o", "one.vtu", "--threads", "1"}, in).exit_code ==
      0);
  CHECK(
      run_flowcage({"cage", "ring.step", "-o", "two.obj", "-o", "two.vtu", "--threads", "2"}, in).exit_code ==
      0);
  CHECK(folder.text_of("one.obj") == folder.text_of("two.obj"));
  CHECK(folder.text_of("one.vtu") == folder.text_of("two.vtu"));
}

TEST_CASE("cage: internal flow keeps the inside") {
  const WorkFolder folder;
  write_cad(make_cylinder(0.3, 3), (folder.path() / "pipe.step").string(), "m");
  const RunSettings in{.folder = folder.path()};
  const ProgramRun run = run_flowcage({"cage", "pipe.step", "--flow", "internal", "-o", "pipe.vtu"}, in);
  INFO(run.err);
  CHECK(run.exit_code == 0);
  const ProgramRun quality = run_flowcage({"quality", "pipe.vtu", "--json", "q.json"}, in);
  REQUIRE(quality.exit_code == 0);
  const double volume =
      nlohmann::json::parse(folder.text_of("q.json"))["volume"]["total_volume"].get<double>();
  CHECK(volume > 0.6 * 0.848);  // pi 0.3^2 3, less what coarse blocks cut off
  CHECK(volume < 0.848);
}

TEST_CASE("cage: wrong outputs and sizes are refused before any work") {
  const WorkFolder folder;
  const RunSettings in{.folder = folder.path()};
  const ProgramRun format = run_flowcage({"cage", "a.step", "-o", "x.stl"}, in);
  CHECK(format.exit_code == 2);
  CHECK_THAT(format.err, contains_text("x.stl: unknown format of a cage or blocks"));
  const ProgramRun size = run_flowcage({"cage", "a.step", "--cage-size", "0", "-o", "x.obj"}, in);
  CHECK(size.exit_code == 2);
  CHECK_THAT(size.err, contains_text("cage-size"));
}
