// mesh --order, seen from outside.
#include <nlohmann/json.hpp>

#include "tests/catch.hpp"
#include "tests/cli/sphere_folder.hpp"

using namespace flowcage;
using flowcage::tests::SphereFolder;
using Json = nlohmann::json;
using Strings = std::vector<std::string>;

TEST_CASE(
    "mesh --order: wall nodes on the CAD, cells proved valid, the same bytes on any number of threads") {
  const SphereFolder folder;
  for (const char* order : {"2", "3", "4"}) {
    CAPTURE(order);
    for (const char* threads : {"1", "2"}) {
      const ProgramRun run =
          folder.run("mesh", {"--levels", "1", "--tolerance", "1e-2", "--unit", "mm", "--order", order,
                              "--threads", threads, "--json", "c.json", "-o", std::string(threads) + ".vtu",
                              "-o", std::string(threads) + ".msh", "-o", std::string(threads) + ".cgns"});
      INFO(run.err);
      REQUIRE(run.exit_code == 0);
    }
    CHECK(folder.text_of("1.vtu") == folder.text_of("2.vtu"));
    CHECK(folder.text_of("1.msh") == folder.text_of("2.msh"));
    const Json json = Json::parse(folder.text_of("c.json"));
    const Json& curved = json.at("curved");
    CHECK(curved.at("order") == std::stoi(order));
    CHECK(curved.at("max_wall_distance") < 1e-12);
    CHECK(curved.at("max_correction") > 1e-6);  // the nodes were moved to the CAD
    CHECK(curved.at("not_positive_cells") == 0);
    CHECK(curved.at("undecided_cells") == 0);
    int gates = 0;
    for (const Json& gate : json.at("gates")) {
      if (gate.at("name") == "curved_cells" || gate.at("name") == "curved_wall_nodes")
        gates += gate.at("holds") ? 1 : 0;
    }
    CHECK(gates == 2);
  }
}

TEST_CASE("mesh --order: what cannot be is refused before the work") {
  const SphereFolder folder;
  const auto refused = [&](const Strings& rest, const std::string& why) {
    const ProgramRun run = folder.run("mesh", rest);
    CHECK(run.exit_code == 2);
    CHECK_THAT(run.err, contains_text(why));
    CHECK(folder.entries() == Strings{"cage.obj", "sphere.step"});
  };
  refused({"--order", "2", "-o", "x.su2"}, "the format of x.su2 has linear cells");
  refused({"--order", "2", "-o", "x.vtu", "-o", "case/"}, "the format of case/ has linear cells");
  refused({"--order", "2", "--no-snap", "-o", "x.vtu"}, "--no-snap");
  refused({"--order", "5", "-o", "x.vtu"}, "out of range");
}
