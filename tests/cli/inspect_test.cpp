// `flowcage inspect`, run as a user runs it.
#include <nlohmann/json.hpp>

#include "occ_bridge/shapes.hpp"
#include "tests/catch.hpp"
#include "tests/cli/run_program.hpp"

using namespace flowcage;

TEST_CASE("inspect prints a table and writes the same facts as JSON") {
  const WorkFolder folder;
  write_cad(make_cylinder(0.5, 2), (folder.path() / "can.step").string(), "in");
  const ProgramRun run =
      run_flowcage({"inspect", "can.step", "--json", "can.json"}, {.folder = folder.path()});
  CHECK(run.exit_code == 0);
  for (const char* line : {"format        STEP", "unit          in (1 is 0.0254 m)", "1 solid(s)",
                           "2 in 2 chain(s)", "diagonal 2.44949"}) {
    CAPTURE(line, run.out);
    CHECK(run.out.find(line) != std::string::npos);
  }
  const nlohmann::json report = nlohmann::json::parse(folder.text_of("can.json"));
  const nlohmann::json& cad = report["cad"];
  CHECK(cad["files"] == nlohmann::json::array({"can.step"}));
  CHECK(cad["unit"] == "in");
  CHECK(cad["faces"] == 3);
  CHECK(cad["edges"] == 3);
  CHECK(cad["sharp_edges"] == 2);
  CHECK(cad["free_edges"] == 0);
  CHECK(cad["bbox"][0][2].get<double>() == Approx(0).margin(1e-9));
  CHECK(cad["bbox"][1][2].get<double>() == Approx(2));
  CHECK(cad["diagonal"].get<double>() == Approx(std::sqrt(6.0)));
  CHECK(cad["warnings"].empty());
  CHECK(cad["closed"] == true);
}

TEST_CASE("inspect: the crease angle and the unit are options") {
  const WorkFolder folder;
  write_cad(make_box({1, 1, 1}), (folder.path() / "box.igs").string(), "mm");
  const ProgramRun run = run_flowcage({"inspect", "box.igs", "--crease-angle", "100", "--cad-unit", "m"},
                                      {.folder = folder.path()});
  CHECK(run.exit_code == 0);
  CHECK(run.out.find("0 in 0 chain(s)") != std::string::npos);
  CHECK(run.out.find("size          1000 x 1000 x 1000") != std::string::npos);
  CHECK(run.out.find("odd size") != std::string::npos);
}

TEST_CASE("inspect refuses what is no CAD with exit code 3 and a remedy") {
  const WorkFolder folder;
  folder.put("letter.step", "to my aunt\n");
  for (const char* name : {"letter.step", "missing.step", "."}) {
    const ProgramRun run = run_flowcage({"inspect", name, "--json", "out.json"}, {.folder = folder.path()});
    CAPTURE(name, run.err);
    CHECK(run.exit_code == 3);
    CHECK(run.out.empty());
    CHECK(run.err.find(std::string("flowcage: ") + name + ": ") != std::string::npos);
  }
  CHECK(folder.entries() == std::vector<std::string>{"letter.step"});
}
