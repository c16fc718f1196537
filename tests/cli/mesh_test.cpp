// surface and mesh on a CAD file, seen from outside: a sphere of diameter 1 m with a cube as its cage.
#include <cmath>
#include <cstdio>
#include <set>
#include <sstream>

#include <fmt/format.h>

#include "core/export/read_mesh.hpp"
#include "core/optimise/untangle.hpp"
#include "occ_bridge/shapes.hpp"
#include "tests/catch.hpp"
#include "tests/cli/run_program.hpp"

using namespace flowcage;
using Strings = std::vector<std::string>;

namespace {

/// A cube's cage in millimetres, 0.9 m wide; `open` leaves out the face at y = -450.
std::string cube_cage(bool open = false) {
  std::ostringstream text;
  for (int i = 0; i < 8; ++i) {
    text << "v " << ((i & 1) != 0 ? 450 : -450) << ' ' << ((i & 2) != 0 ? 450 : -450) << ' '
         << ((i & 4) != 0 ? 450 : -450) << '\n';
  }
  text << "g ball\nf 1 3 4 2\nf 5 6 8 7\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";
  if (!open) text << "f 1 2 6 5\n";
  return text.str();
}

class Sphere : public WorkFolder {
 public:
  Sphere() {
    write_cad(make_sphere(0.5), (path() / "sphere.step").string(), "mm");
    put("cage.obj", cube_cage());
  }
  ProgramRun run(const char* command, const Strings& rest, RunSettings settings = {}) const {
    Strings arguments{command, "sphere.step", "--cage", "cage.obj"};
    arguments.insert(arguments.end(), rest.begin(), rest.end());
    settings.folder = path();
    return run_flowcage(arguments, settings);
  }
};

}  // namespace

TEST_CASE("surface: vertices on the sphere, in the output's unit") {
  const Sphere folder;
  const ProgramRun run = folder.run("surface", {"--levels", "2", "--unit", "mm", "-o", "fit.obj", "-o",
                                                "fit.vtp", "-o", "fit.stl", "--json", "fit.json"});
  INFO(run.err);
  REQUIRE(run.exit_code == 0);
  CHECK(run.out.empty());
  CHECK(folder.entries() == Strings{"cage.obj", "fit.json", "fit.obj", "fit.stl", "fit.vtp", "sphere.step"});
  CHECK_THAT(folder.text_of("fit.obj"), contains_text("g ball\n"));
  std::istringstream obj(folder.text_of("fit.obj"));
  int vertices = 0;
  for (std::string line; std::getline(obj, line);) {
    double x = 0, y = 0, z = 0;
    if (std::sscanf(line.c_str(), "v %lf %lf %lf", &x, &y, &z) != 3) continue;
    ++vertices;
    CHECK(std::hypot(x, y, z) == Approx(500).epsilon(1e-9));  // snapped
  }
  CHECK(vertices == 98);
  for (const char* key :
       {"\"max_deviation\"", "\"coverage_deviation\"", "\"control_vertices\": 98", "\"crease_edges\": 0",
        "\"genus\": 0", "\"gates\"", "\"unit\": \"mm\"", "\"peak_memory_bytes\""}) {
    CHECK_THAT(folder.text_of("fit.json"), contains_text(key));
  }
}

TEST_CASE("mesh: a family is nested to the last bit, each mesh valid, figures of all in summary and JSON") {
  const Sphere folder;
  const ProgramRun run = folder.run("mesh", {"--levels", "2", "--first-height", "0.0007", "--tolerance",
                                             "0.01", "--family", "3", "--json", "r.json", "-o", "ball.vtu"});
  INFO(run.err);
  REQUIRE(run.exit_code == 0);
  CHECK(folder.entries() ==
        Strings{"ball_1.vtu", "ball_2.vtu", "ball_3.vtu", "cage.obj", "r.json", "sphere.step"});
  std::set<std::array<double, 3>> finer;
  Offset cells = 0;
  for (const char* name : {"ball_3.vtu", "ball_2.vtu", "ball_1.vtu"}) {
    INFO(name);
    const HexMesh mesh = read_vtu(folder.path() / name);
    CHECK(hex_validity(mesh).inverted == 0);
    CHECK(hex_validity(mesh).uncertified == 0);
    std::set<std::array<double, 3>> points;
    for (const Vec3& p : mesh.points()) points.insert({p.x(), p.y(), p.z()});
    if (cells > 0) {
      CHECK(8 * mesh.cell_count() == cells);
      CHECK(std::includes(finer.begin(), finer.end(), points.begin(), points.end()));
    }
    CHECK_THAT(folder.text_of("r.json"), contains_text(fmt::format("\"cells\": {}", mesh.cell_count())));
    CHECK_THAT(run.err + run.out, contains_text(fmt::format("{} hexes", mesh.cell_count())));
    cells = mesh.cell_count();
    finer = std::move(points);
  }
  // The coarsest has the blocks' divisions at least: two levels.
  CHECK(folder.run("mesh", {"--levels", "1", "--family", "3", "-o", "b.vtu"}).exit_code == 2);
  CHECK(folder.run("mesh", {"--family", "2", "-o", "b.foam"}).exit_code == 2);
}

TEST_CASE("surface: B-spline patches as STEP, read again as CAD") {
  const Sphere folder;
  const ProgramRun run = folder.run("surface", {"--levels", "2", "--unit", "in", "--sample", "1", "-o",
                                                "fit.STP", "-o", "fit.obj", "--json", "fit.json"});
  INFO(run.err);
  REQUIRE(run.exit_code == 0);
  CHECK_THAT(run.err, contains_text("--sample does not apply to STEP"));
  CHECK_THAT(run.err, contains_text("6 B-spline patches"));
  CHECK_THAT(folder.text_of("fit.json"), contains_text("\"max_angle\""));
  CHECK_THAT(folder.text_of("fit.STP"), contains_text("FILE_NAME('fit.STP'"));
  const ProgramRun inspect = run_flowcage({"inspect", "fit.STP"}, {.folder = folder.path()});
  INFO(inspect.out);
  CHECK(inspect.exit_code == 0);
  CHECK_THAT(inspect.out, contains_text("1 solid(s), 1 shell(s), 0 of them open"));
  CHECK_THAT(inspect.out, contains_text("in (1 is 0.0254 m)"));
  CHECK_THAT(inspect.out, contains_text("ball"));
  CHECK_THAT(inspect.out, contains_text("sharp edges   0"));
  // A place that cannot be written is refused before the work, and a missed gate leaves nothing.
  CHECK(folder.run("surface", {"--levels", "1", "-o", "no/fit.step"}).exit_code == 5);
  CHECK(folder.run("surface", {"--levels", "0", "-o", "bad.step"}).exit_code == 4);
  CHECK(folder.entries() == Strings{"cage.obj", "fit.STP", "fit.json", "fit.obj", "sphere.step"});
}

TEST_CASE("mesh: the same bytes on any number of threads, a case that quality reads") {
  const Sphere folder;
  for (const char* threads : {"1", "3"}) {
    const ProgramRun run =
        folder.run("mesh", {"--levels", "2", "--tolerance", "1e-3", "--threads", threads, "-o",
                            std::string(threads) + ".vtu", "-o", std::string("case") + threads});
    INFO(run.err);
    REQUIRE(run.exit_code == 0);
    CHECK(run.out.empty());
  }
  CHECK(folder.text_of("1.vtu").size() > 10000);
  CHECK(folder.text_of("1.vtu") == folder.text_of("3.vtu"));
  for (const char* name : {"points", "faces", "owner", "neighbour", "boundary"}) {
    const std::string inside = std::string("/constant/polyMesh/") + name;
    CHECK_FALSE(folder.text_of("case1" + inside).empty());
    CHECK(folder.text_of("case1" + inside) == folder.text_of("case3" + inside));
  }
  for (const char* mesh : {"case1", "1.vtu"}) {
    const ProgramRun quality = run_flowcage({"quality", mesh}, {.folder = folder.path()});
    CHECK(quality.exit_code == 0);
    CHECK_THAT(quality.out, contains_text("cells     1920\n"));  // 6 faces, 2 levels, 5 layers: 6 * 8^2 * 5
    CHECK_THAT(quality.out, contains_text("inverted  0\n"));
    CHECK_THAT(quality.out, contains_text("Mesh OK"));
    CHECK_THAT(quality.out, contains_text("ball"));
  }
}

TEST_CASE("a missed gate: exit 4 with the place, nothing at OUT without --force") {
  const Sphere folder;
  const auto check_missed = [](const ProgramRun& run) {
    INFO(run.err);
    CHECK(run.exit_code == 4);
    CHECK_THAT(run.err, contains_text("flowcage: gate max_deviation is missed: "));
    CHECK_THAT(run.err, contains_text("the limit is 1e-09"));
    CHECK_THAT(run.err, contains_text(" near ("));
    CHECK_THAT(run.err, contains_text("--force"));
  };
  for (const char* command : {"surface", "mesh"}) {
    const bool mesh = std::string(command) == "mesh";
    const Strings options{"--levels", "1", "--tolerance", "1e-9", "-o", mesh ? "x.vtu" : "x.obj"};
    check_missed(folder.run(command, options));
    CHECK(folder.entries() == Strings{"cage.obj", "sphere.step"});
    Strings forced = options;
    forced.push_back("--force");
    check_missed(folder.run(command, forced));
    CHECK(folder.entries().size() == 3);
    std::filesystem::remove(folder.path() / options.back());
  }
}

TEST_CASE("--symmetry must agree with the cage") {
  const Sphere folder;
  const ProgramRun closed = folder.run("mesh", {"--symmetry", "y", "-o", "case"});
  CHECK(closed.exit_code == 3);
  CHECK_THAT(closed.err, contains_text("cage.obj: the cage is closed"));
  folder.put("cage.obj", cube_cage(true));
  const ProgramRun other = folder.run("mesh", {"--symmetry", "y=0.1", "-o", "case"});
  CHECK(other.exit_code == 3);
  CHECK_THAT(other.err, contains_text("cage.obj: the cage is open in the plane"));
  CHECK(folder.entries() == Strings{"cage.obj", "sphere.step"});
}

TEST_CASE("a cage in the wrong unit: exit 3") {
  const Sphere folder;
  const ProgramRun run = folder.run("mesh", {"--cage-unit", "m", "-o", "case"});
  INFO(run.err);
  CHECK(run.exit_code == 3);
  CHECK_THAT(run.err, contains_text("flowcage: cage.obj: the cage's size"));
  CHECK_THAT(run.err, contains_text("--cage-unit"));
  CHECK(folder.entries() == Strings{"cage.obj", "sphere.step"});
}

TEST_CASE("mesh: interrupted while it fits, nothing is left") {
  const Sphere folder;
  const ProgramRun run =
      folder.run("mesh", {"--levels", "6", "-o", "case", "-o", "x.vtu", "--json", "x.json"},
                 {.signal = SIGINT, .signal_delay = 2});
  INFO(run.err);
  CHECK(run.exit_code == 130);
  CHECK_THAT(run.err, contains_text("flowcage: interrupted"));
  CHECK(folder.entries() == Strings{"cage.obj", "sphere.step"});
}

TEST_CASE("a report that cannot be written: exit 5 and no mesh either") {
  const Sphere folder;
  folder.put("file", "x");
  Strings places{"file/x.json", "missing/x.json", "."};
  if (std::filesystem::exists("/dev/full")) places.push_back("/dev/full");
  for (const char* command : {"surface", "mesh"}) {
    const std::string out = std::string(command) == "mesh" ? "x.vtu" : "x.obj";
    for (const std::string& json : places) {
      const ProgramRun run =
          folder.run(command, {"--levels", "1", "--tolerance", "1e-2", "-o", out, "--json", json});
      INFO(run.err);
      CHECK(run.exit_code == 5);
      CHECK_THAT(run.err, contains_text("flowcage: " + json + ": cannot write"));
      CHECK(folder.entries() == Strings{"cage.obj", "file", "sphere.step"});
    }
  }
}

TEST_CASE("an output that is an input or another output: exit 2, nothing is replaced") {
  const Sphere folder;
  const auto check = [&](const char* command, const Strings& rest) {
    const ProgramRun run = folder.run(command, rest);
    INFO(run.err);
    CHECK(run.exit_code == 2);
    CHECK_THAT(run.err, contains_text(": the same file as "));
    CHECK(folder.text_of("cage.obj") == cube_cage());
    CHECK(folder.entries() == Strings{"cage.obj", "sphere.step"});
  };
  check("surface", {"-o", "./cage.obj"});
  check("surface", {"-o", "x.obj", "--json", "x.obj"});
  check("mesh", {"-o", "x.vtu", "--json", "sphere.step"});
  check("mesh", {"-o", "x.vtu", "-o", "./x.vtu"});
}

TEST_CASE("more than the machine holds, or than numbers can tell apart, is refused before the fit") {
  const Sphere folder;
  const auto check = [&](const char* command, const Strings& rest, int exit_code, const char* what) {
    const ProgramRun run = folder.run(command, rest);
    INFO(run.err);
    CHECK(run.exit_code == exit_code);
    CHECK_THAT(run.err, contains_text(what));
    CHECK(run.seconds < 20);
    CHECK(folder.entries() == Strings{"cage.obj", "sphere.step"});
  };
  check("mesh", {"--levels", "10", "-o", "case"}, 2, "more than this machine holds");
  check("mesh", {"--cells", "2000000000", "-o", "case"}, 2, "more than this machine holds");
  check("surface", {"--levels", "5", "--sample", "8", "-o", "x.obj"}, 2, "more than this machine holds");
  check("mesh", {"--first-height", "1e-300", "-o", "case"}, 2, "--first-height: 1e-300 m is too small");
  std::string typo = cube_cage();
  typo.replace(0, typo.find('\n'), "v 1e300 -450 -450");
  folder.put("cage.obj", typo);
  for (const char* command : {"mesh", "surface"}) {
    check(command, {"-o", std::string(command) == "mesh" ? "x.vtu" : "x.obj"}, 3, "cage.obj: vertex 1 at ");
  }
}

TEST_CASE("--cells: the level nearest to it, though the tolerance is met before") {
  const Sphere folder;
  const ProgramRun run =
      folder.run("mesh", {"--cells", "40000", "--tolerance", "1e-2", "-o", "x.vtu", "--quiet"});
  INFO(run.err);
  REQUIRE(run.exit_code == 0);
  const ProgramRun quality = run_flowcage({"quality", "x.vtu"}, {.folder = folder.path()});
  int cells = 0;
  REQUIRE(std::sscanf(quality.out.c_str(), "cells %d", &cells) == 1);
  CHECK(cells > 40000 / 3);
  CHECK(cells < 40000 * 3);
}
