// mesh --case: OpenFOAM's solvers start on what it writes.
#include <cmath>
#include <filesystem>
#include <fstream>

#include "core/export/write_foam_case.hpp"
#include "core/export/write_polymesh.hpp"
#include "tests/catch.hpp"
#include "tests/cli/sphere_folder.hpp"
#include "tests/export/peers.hpp"
#include "tests/export/sample_meshes.hpp"

using namespace flowcage;
using namespace flowcage::tests;
using Strings = std::vector<std::string>;
namespace fs = std::filesystem;

namespace {

std::string solved(const std::string& command, const fs::path& case_folder) {
  const PeerRun said =
      run("WM_PROJECT_DIR=/usr/share/openfoam " + command + " -case '" + case_folder.string() + "'");
  CAPTURE(said.output);
  CHECK(said.exit_code == 0);
  CHECK(said.output.find("FOAM FATAL") == std::string::npos);
  CHECK(said.output.find("\nEnd\n") != std::string::npos);
  return said.output;
}

/// The number behind the last `words` of a log.
double last_number(const std::string& log, const std::string& words) {
  const auto at = log.rfind(words);
  REQUIRE(at != std::string::npos);
  return std::stod(log.substr(at + words.size()));
}

void set_iterations(const fs::path& case_folder, int count) {
  const fs::path file = case_folder / "system/controlDict";
  std::string text = read_text(file);
  const auto at = text.find("endTime 1000;");
  REQUIRE(at != std::string::npos);
  std::ofstream(file) << text.replace(at, 13, "endTime " + std::to_string(count) + ";");
}

/// The case of a mesh made in code.
void write_case(const fs::path& folder, const HexView& mesh, const FoamFlow& flow) {
  write_openfoam_case(folder, mesh, build_hex_adjacency(mesh));
  write_foam_case(folder, foam_case_files(mesh, flow));
}

}  // namespace

TEST_CASE("potentialFoam and simpleFoam run on the case of a sphere in a free stream") {
  const SphereFolder folder;
  const ProgramRun made = folder.run(
      "mesh", {"--levels", "3", "--tolerance", "1e-3", "--farfield-size", "8", "--first-height", "0.02",
               "--case", "--speed", "2", "--direction", "0,0,3", "--viscosity", "1e-4", "-o", "case"});
  INFO(made.err);
  REQUIRE(made.exit_code == 0);
  CHECK_THAT(folder.text_of("case/0/U"), contains_text("uniform (0 0 2)"));
  CHECK_THAT(folder.text_of("case/0/U"), contains_text("ball { type noSlip; }"));
  CHECK_THAT(folder.text_of("case/0/U"), contains_text("farfield { type freestreamVelocity;"));
  CHECK_THAT(folder.text_of("case/constant/transportProperties"),
             contains_text("nu [0 2 -1 0 0 0 0] 0.0001;"));
  CHECK_THAT(folder.text_of("case/0/nut"), contains_text("ball { type nutkWallFunction;"));  // y+ about 20
  CHECK_THAT(folder.text_of("case/system/controlDict"), contains_text("application simpleFoam"));
  if (!have_program("potentialFoam")) return;
  const fs::path case_folder = folder.path() / "case";
  const std::string potential = solved("potentialFoam -writephi", case_folder);
  CHECK(last_number(potential, "Continuity error = ") < 1e-5);
  CHECK(last_number(potential, "Initial residual = ") < 1e-6);
  if (have_python_module("numpy")) {
    // Round a sphere the stream is 1.5 times as fast at the equator; the first cell's middle is .01 away.
    const PeerRun rebuilt =
        run("/usr/bin/python3 " FLOWCAGE_TEST_SOURCES "/../examples/velocity_from_phi.py '" +
            case_folder.string() + "'");
    CAPTURE(rebuilt.output);
    REQUIRE(rebuilt.exit_code == 0);
    CHECK(last_number(rebuilt.output, " to ") == Approx(2 * 1.5).epsilon(0.03));
  }
  set_iterations(case_folder, 10);
  const std::string simple = solved("simpleFoam", case_folder);
  CHECK(simple.find("kOmegaSST") != std::string::npos);
  CHECK(simple.find("\nTime = 10\n") != std::string::npos);
  CHECK(last_number(simple, "Solving for Uz, Initial residual = ") < 0.5);
  CHECK(std::isfinite(last_number(simple, "Solving for k, Initial residual = ")));
}

TEST_CASE("a duct: inlet, outlet, walls and symmetry plane, resolved walls") {
  // i-max is the inlet, j-max the outlet, i-min the wall, k-min the symmetry plane; far field made a wall.
  HexMesh box = box_mesh({8, 8, 4});
  std::vector<BoundaryPatch> patches = box.patches();
  for (BoundaryPatch& patch : patches) {
    if (patch.type == PatchType::farfield) patch.type = PatchType::wall;
  }
  std::vector<HexPoints> cells(static_cast<std::size_t>(box.cell_count()));
  box.read_cells(0, cells);
  const HexMesh mesh({box.points().begin(), box.points().end()}, cells, patches);
  const ScratchFolder folder;
  FoamFlow flow;
  flow.speed = 3;
  flow.viscosity = 0.01;
  flow.internal = true;
  flow.yplus = 1;
  write_case(folder.path(), mesh, flow);
  const std::string velocity = read_text(folder.path() / "0/U");
  CHECK_THAT(velocity, contains_text("inlet { type surfaceNormalFixedValue; refValue uniform -3; }"));
  CHECK_THAT(velocity, contains_text("symmetry_plane { type symmetryPlane; }"));
  CHECK_THAT(read_text(folder.path() / "0/p"), contains_text("outlet { type fixedValue; value uniform 0; }"));
  CHECK_THAT(read_text(folder.path() / "0/nut"), contains_text("wall { type nutLowReWallFunction;"));
  // k = 1.5 (.05 U)^2
  CHECK_THAT(read_text(folder.path() / "0/k"), contains_text("internalField uniform 0.03375"));
  if (!have_program("simpleFoam")) return;
  const std::string potential = solved("potentialFoam -writephi", folder.path());
  CHECK(last_number(potential, "Continuity error = ") < 1e-5);
  set_iterations(folder.path(), 5);
  solved("simpleFoam", folder.path());
}

TEST_CASE("a pipe of CAD: its inlet and outlet are known before the work and in the case") {
  const WorkFolder folder;
  write_cad(make_cylinder(0.5, 2), (folder.path() / "pipe.step").string(), "m");
  const Strings pipe{"mesh",   "pipe.step", "--flow", "internal",    "--levels", "1",  "--tolerance", "1e-2",
                     "--case", "--speed",   "2",      "--viscosity", "0.01",     "-o", "case"};
  const auto with = [&](const Strings& more) {
    Strings arguments = pipe;
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_flowcage(arguments, {.folder = folder.path()});
  };
  const ProgramRun closed = with({});
  CHECK(closed.exit_code == 3);
  CHECK_THAT(closed.err, contains_text("neither inlet nor outlet"));
  CHECK(folder.entries() == Strings{"pipe.step"});
  const ProgramRun made = with({"--inlet", "face:3", "--outlet", "face:2"});
  INFO(made.err);
  REQUIRE(made.exit_code == 0);
  CHECK_THAT(folder.text_of("case/0/U"),
             contains_text("inlet { type surfaceNormalFixedValue; refValue uniform -2; }"));
  CHECK_THAT(folder.text_of("case/0/p"), contains_text("outlet { type fixedValue; value uniform 0; }"));
  if (!have_program("potentialFoam")) return;
  const std::string potential = solved("potentialFoam -writephi", folder.path() / "case");
  CHECK(last_number(potential, "Initial residual = ") < 1e-6);
  set_iterations(folder.path() / "case", 5);
  solved("simpleFoam", folder.path() / "case");
}

TEST_CASE("--case: flows that cannot be are refused before the work") {
  const SphereFolder folder;
  const auto refused = [&](const Strings& rest, int code, const std::string& why) {
    const ProgramRun run = folder.run("mesh", rest);
    INFO(run.err);
    CHECK(run.exit_code == code);
    CHECK_THAT(run.err, contains_text(why));
    CHECK_FALSE(fs::exists(folder.path() / "out"));
  };
  refused({"--case", "-o", "out.vtu"}, 2, "--case needs an OpenFOAM output");
  refused({"--case", "--unit", "mm", "-o", "out"}, 2, "metres");
  refused({"--speed", "3", "-o", "out"}, 2, "--speed belongs to --case");
  refused({"--case", "--direction", "0,0,0", "-o", "out"}, 2, "has no direction");
  refused({"--case", "--viscosity", "1", "--reynolds", "9", "--length", "1", "-o", "out"}, 2, "how viscous");

  const auto patches_without = [](PatchType gone, PatchType becomes) {
    HexMesh box = box_mesh({2, 2, 2});
    std::vector<BoundaryPatch> patches = box.patches();
    for (BoundaryPatch& patch : patches) {
      if (patch.type == gone || patch.type == PatchType::farfield) patch.type = becomes;
    }
    std::vector<HexPoints> cells(8);
    box.read_cells(0, cells);
    return HexMesh({box.points().begin(), box.points().end()}, cells, patches);
  };
  CHECK_THROWS_WITH(foam_case_files(patches_without(PatchType::outlet, PatchType::wall), {}),
                    contains_text("no way out"));
  CHECK_THROWS_WITH(foam_case_files(patches_without(PatchType::inlet, PatchType::wall), {}),
                    contains_text("no inlet"));
  FoamFlow across;
  across.direction = Vec3(0, 0, 1);  // the box's symmetry plane is k-min
  CHECK_THROWS_WITH(foam_case_files(box_mesh({2, 2, 2}), across),
                    contains_text("through the symmetry plane"));
}

TEST_CASE("a case's folder that leads elsewhere is refused") {
  const ScratchFolder folder, elsewhere;
  const fs::path case_folder = folder.path() / "case";
  fs::create_directory(case_folder);
  fs::create_directory_symlink(elsewhere.path(), case_folder / "0");
  const HexMesh mesh = box_mesh({2, 2, 2});
  const auto files = foam_case_files(mesh, {});
  try {
    write_foam_case(case_folder, files);
    FAIL("was written");
  } catch (const Error& e) {
    CHECK(e.kind() == ErrorKind::output);
    CHECK_THAT(e.what(), contains_text("leads out of the case"));
  }
  CHECK(fs::is_empty(elsewhere.path()));
  const SphereFolder sphere;
  fs::create_directory(sphere.path() / "case");
  fs::create_directory_symlink(elsewhere.path(), sphere.path() / "case/system");
  const ProgramRun refused = sphere.run("mesh", {"--levels", "1", "--case", "-o", "case"});
  CHECK(refused.exit_code == 5);
  CHECK_THAT(refused.err, contains_text("case/system: leads out of the case"));
  CHECK_FALSE(fs::exists(sphere.path() / "case/constant"));
  CHECK(fs::is_empty(elsewhere.path()));
  // Every file stays inside by its name, whatever the patches are called.
  for (const FoamCaseFile& file : files) {
    CHECK(file.path.is_relative());
    CHECK(file.path.lexically_normal().begin()->string() != "..");
  }
}
