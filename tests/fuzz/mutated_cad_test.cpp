// Damaged STEP and IGES files through the real program: it ends in order, in time, with a code of the
// contract. FLOWCAGE_MUTATED_FILES: how many (500).
#include <array>
#include <cstdlib>
#include <map>

#include "occ_bridge/shapes.hpp"
#include "tests/catch.hpp"
#include "tests/cli/run_program.hpp"
#include "tests/fuzz/mutate_cad.hpp"
#include "tests/occ_bridge/labelled_cad.hpp"

using namespace flowcage;

TEST_CASE("damaged CAD files never crash or hang the program") {
  const WorkFolder folder;
  const auto at = [&](const char* name) { return (folder.path() / name).string(); };
  HalfWing wing;
  wing.airfoil = naca_symmetric(0.12, 0.002);
  // Planes and cylinders, splines, and an assembly with names, colours and layers.
  write_cad(make_difference(make_box({1, 1, 1}), make_cylinder(0.3, 1)), at("block.step"), "mm");
  write_cad(make_difference(make_box({1, 1, 1}), make_cylinder(0.3, 1)), at("block.igs"), "in");
  write_cad(make_half_wing(wing), at("wing.step"), "m");
  write_cad(make_half_wing(wing), at("wing.igs"), "mm");
  write_tagged({{.shape = make_box({1, 1, 1}), .tag = {.name = "hull", .color = "#336699", .layer = "wet"}},
                {.shape = make_torus(1, 0.2),
                 .tag = {.name = "ring"},
                 .places = {{0, 0, 0}, {0, 0, 3}},
                 .instances = {{.name = "lower"}, {.name = "upper", .color = "#ff0000"}}}},
               at("rings.step"));
  constexpr std::array names{"block.step", "block.igs", "wing.step", "wing.igs", "rings.step"};
  const char* wanted = std::getenv("FLOWCAGE_MUTATED_FILES");
  const std::uint32_t count =
      wanted == nullptr ? 500 : static_cast<std::uint32_t>(std::strtoul(wanted, nullptr, 10));
  std::map<int, int> codes;
  for (std::uint32_t seed = 0; seed < count; ++seed) {
    const std::string name = names[seed / 5 % names.size()];
    const std::string damaged = "damaged" + name.substr(name.find('.'));
    folder.put(damaged, mutated_cad(folder.text_of(name), seed));
    const ProgramRun run = run_flowcage({"inspect", damaged, "--threads", "1"}, {.folder = folder.path()});
    CAPTURE(name, seed, run.err, run.seconds);
    ++codes[run.exit_code];
    CHECK((run.exit_code == 0 || run.exit_code == 2 || run.exit_code == 3 || run.exit_code == 4));
    CHECK(run.seconds < 60);
    if (run.exit_code != 0) CHECK(run.err.find(damaged) != std::string::npos);
  }
  // Mutations that spare nothing, or change nothing, would test little.
  CHECK(codes[0] > static_cast<int>(count) / 20);
  CHECK(codes[3] > static_cast<int>(count) / 20);
}
