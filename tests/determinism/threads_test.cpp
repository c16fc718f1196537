// The program run with 1, 2 and 8 threads: every output has the same bytes.
#include <algorithm>
#include <filesystem>

#include "occ_bridge/shapes.hpp"
#include "tests/catch.hpp"
#include "tests/cli/run_program.hpp"

using namespace flowcage;
namespace fs = std::filesystem;
using Strings = std::vector<std::string>;

namespace {

/// A cuboid's cage round the sphere of radius 0.5 m; its sides differ, so that no symmetry hides an order.
constexpr const char* cuboid = R"(v -430 -450 -420
v 450 -460 -450
v -440 450 -430
v 420 430 -450
v -450 -440 450
v 440 -450 460
v -450 460 440
v 450 440 430
g body
f 1 3 4 2
f 5 6 8 7
f 3 7 8 4
g back
f 1 5 7 3
f 2 4 8 6
f 1 2 6 5
)";

/// Relative names of all files below, sorted.
Strings files_below(const fs::path& folder) {
  Strings names;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file()) names.push_back(fs::relative(entry.path(), folder).generic_string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

/// Runs the command with 1, 2 and 8 threads, each into a folder of its own, and compares all that they wrote.
void check_same_bytes(const Strings& command, const Strings& outputs, std::size_t least_files) {
  const WorkFolder folder;
  write_cad(make_sphere(0.5), (folder.path() / "ball.step").string(), "mm");
  folder.put("cage.obj", cuboid);
  Strings first;
  for (const char* threads : {"1", "2", "8"}) {
    fs::create_directory(folder.path() / threads);
    Strings arguments = command;
    for (const std::string& name : outputs) {
      arguments.push_back("-o");
      arguments.push_back(std::string(threads) + "/" + name);
    }
    arguments.insert(arguments.end(), {"--threads", threads});
    const ProgramRun run = run_flowcage(arguments, {.folder = folder.path()});
    INFO(run.err);
    REQUIRE(run.exit_code == 0);
    const Strings names = files_below(folder.path() / threads);
    REQUIRE(names.size() >= least_files);
    if (first.empty()) first = names;
    REQUIRE(names == first);
    for (const std::string& name : names) {
      INFO(name << " with " << threads << " threads");
      CHECK((folder.text_of(std::string(threads) + "/" + name) == folder.text_of("1/" + name)));
    }
  }
}

}  // namespace

TEST_CASE("mesh: far field, wall spacing, OpenFOAM and VTU") {
  check_same_bytes({"mesh", "ball.step", "--cage", "cage.obj", "--levels", "4", "--tolerance", "1e-3",
                    "--first-height", "0.001", "--farfield", "sphere"},
                   {"case", "mesh.vtu"}, 10);
}

TEST_CASE("surface: fitted and sampled, OBJ, VTP and STL") {
  const Strings command{"surface", "ball.step", "--cage", "cage.obj", "--levels", "3", "--tolerance", "1e-3"};
  const Strings outputs{"fit.obj", "fit.vtp", "fit.stl"};
  check_same_bytes(command, outputs, outputs.size());
  Strings sampled = command;
  sampled.insert(sampled.end(), {"--sample", "2"});
  check_same_bytes(sampled, outputs, outputs.size());
}

TEST_CASE("subdivide: control points and limit points") {
  check_same_bytes({"subdivide", "cage.obj", "--levels", "5"}, {"control.obj"}, 1);
  check_same_bytes({"subdivide", "cage.obj", "--levels", "5", "--limit"}, {"limit.obj"}, 1);
}
