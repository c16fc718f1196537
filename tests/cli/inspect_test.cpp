// `flowcage inspect`, run as a user runs it.
#include <nlohmann/json.hpp>

#include "occ_bridge/shapes.hpp"
#include "tests/catch.hpp"
#include "tests/cli/run_program.hpp"
#include "tests/occ_bridge/labelled_cad.hpp"

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

TEST_CASE("inspect: bodies that overlap, united or left") {
  const WorkFolder folder;
  write_cad(make_compound(make_sphere(1), make_box({3, 0.5, 0.5})), (folder.path() / "two.step").string(),
            "m");
  const ProgramRun run =
      run_flowcage({"inspect", "two.step", "--json", "out.json"}, {.folder = folder.path()});
  CHECK(run.exit_code == 0);
  CHECK(run.out.find("bodies 1, 2 of those read: united, 5 face(s) cut") != std::string::npos);
  CHECK(run.out.find("of them 8 chain(s) where bodies meet") != std::string::npos);
  const nlohmann::json cad = nlohmann::json::parse(folder.text_of("out.json"))["cad"];
  CHECK(cad["solids"] == 1);
  REQUIRE(cad["overlaps"].size() == 1);
  CHECK(cad["overlaps"][0]["bodies"] == std::vector<int>{1, 2});
  CHECK(cad["overlaps"][0]["united"] == true);
  const ProgramRun apart = run_flowcage({"inspect", "two.step", "--no-unite"}, {.folder = folder.path()});
  CHECK(apart.exit_code == 0);
  CHECK(apart.out.find("2 solid(s)") != std::string::npos);
  CHECK(apart.out.find("united") == std::string::npos);
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

TEST_CASE("inspect shows what faces can be chosen by, and --include and --exclude choose") {
  const WorkFolder folder;
  write_tagged({{.shape = make_box({1, 1, 1}), .tag = {.name = "hull", .color = "#336699", .layer = "wet"}},
                {.shape = make_cylinder(0.1, 3), .tag = {.name = "mast", .layer = "dry"}}},
               (folder.path() / "boat.step").string());
  const ProgramRun all =
      run_flowcage({"inspect", "boat.step", "--json", "all.json"}, {.folder = folder.path()});
  REQUIRE(all.exit_code == 0);
  for (const char* line : {"hull  6 faces", "mast  2 faces", "wet  6 faces", "#336699  6 faces"}) {
    CAPTURE(line, all.out);
    CHECK(all.out.find(line) != std::string::npos);
  }
  const nlohmann::json cad = nlohmann::json::parse(folder.text_of("all.json"))["cad"];
  CHECK(cad["parts"]["hull"] == 6);
  CHECK(cad["face_list"].size() == 8);  // the foot of the mast lies hidden in the hull
  CHECK(cad["face_list"][0]["number"] == 1);
  CHECK(cad["face_list"][0]["layer"] == "wet");

  const ProgramRun mast = run_flowcage(
      {"inspect", "boat.step", "--exclude", "layer:wet", "--json", "mast.json"}, {.folder = folder.path()});
  CHECK(mast.exit_code == 0);
  CHECK(mast.out.find("6 left out") != std::string::npos);
  const nlohmann::json rest = nlohmann::json::parse(folder.text_of("mast.json"))["cad"];
  CHECK(rest["faces"] == 3);
  CHECK(rest["face_list"][0]["number"] == 7);
  CHECK(rest["bbox"][1][2].get<double>() == Approx(3));

  const ProgramRun two = run_flowcage({"inspect", "boat.step", "--include", "face:1", "--include", "face:2"},
                                      {.folder = folder.path()});
  CHECK(two.exit_code == 0);
  CHECK(two.out.find("7 left out") != std::string::npos);

  const ProgramRun wrong =
      run_flowcage({"inspect", "boat.step", "--include", "hul"}, {.folder = folder.path()});
  CHECK(wrong.exit_code == 2);
  CHECK(wrong.err.find("--include \"hul\": it matches no face") != std::string::npos);
  CHECK(wrong.err.find("did you mean \"hull\"?") != std::string::npos);
  CHECK(wrong.err.find("part:mast (3 faces)") != std::string::npos);
  CHECK(run_flowcage({"inspect", "boat.step", "--include", ""}, {.folder = folder.path()}).exit_code == 2);
}

TEST_CASE("inspect says what an open border is") {
  const WorkFolder folder;
  write_cad(make_onera_m6(), (folder.path() / "wing.step").string(), "mm");
  const ProgramRun run =
      run_flowcage({"inspect", "wing.step", "--json", "wing.json"}, {.folder = folder.path()});
  REQUIRE(run.exit_code == 0);
  CHECK(run.out.find("symmetry plane, waterline or open end in y = ") != std::string::npos);
  const nlohmann::json borders = nlohmann::json::parse(folder.text_of("wing.json"))["cad"]["open_borders"];
  REQUIRE(borders.size() == 1);
  CHECK(borders[0]["kind"] == "plane");
  CHECK(borders[0]["axis"] == "y");
  CHECK(borders[0]["value"].get<double>() == Approx(0).margin(1e-9));
}
