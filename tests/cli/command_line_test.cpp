// The contract of the command line, seen from outside: exit codes, messages, files.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <sstream>

#include "tests/catch.hpp"
#include "tests/cli/run_program.hpp"

using namespace flowcage;
using Strings = std::vector<std::string>;

namespace {

constexpr const char* cube_text = R"(v -1 -1 -1
v 1 -1 -1
v -1 1 -1
v 1 1 -1
v -1 -1 1
v 1 -1 1
v -1 1 1
v 1 1 1
f 1 3 4 2
f 5 6 8 7
f 1 2 6 5
g top
f 3 7 8 4
f 1 5 7 3
f 2 4 8 6
)";

/// One line first that says what and where, then the remedy; nothing on stdout.
void check_error(const ProgramRun& run, int exit_code, const std::string& first_line_part,
                 const std::string& remedy_part) {
  INFO(run.err);
  CHECK(run.exit_code == exit_code);
  CHECK(run.out.empty());
  const std::size_t message = run.err.rfind("flowcage: ");
  REQUIRE(message != std::string::npos);
  const std::size_t end = run.err.find('\n', message);
  REQUIRE(end != std::string::npos);
  CHECK_THAT(run.err.substr(message, end - message), contains_text(first_line_part));
  CHECK_THAT(run.err.substr(end + 1), contains_text(remedy_part));
}

/// Vertices of an OBJ text, in units of 1e-12, sorted: two runs may number edges differently.
std::vector<std::array<long long, 3>> sorted_points(const std::string& obj) {
  std::vector<std::array<long long, 3>> points;
  std::istringstream in(obj);
  for (std::string line; std::getline(in, line);) {
    double x = 0, y = 0, z = 0;
    if (std::sscanf(line.c_str(), "v %lf %lf %lf", &x, &y, &z) != 3) continue;
    points.push_back({std::llround(x * 1e12), std::llround(y * 1e12), std::llround(z * 1e12)});
  }
  std::sort(points.begin(), points.end());
  return points;
}

}  // namespace

TEST_CASE("help and version go to stdout") {
  const ProgramRun version = run_flowcage({"--version"});
  CHECK(version.exit_code == 0);
  CHECK(version.err.empty());
  for (const char* name : {"flowcage 0.", "OpenCASCADE 7.", "Eigen 3.", "CGNS 3."})
    CHECK_THAT(version.out, contains_text(name));
  const ProgramRun help = run_flowcage({"--help"});
  CHECK(help.exit_code == 0);
  CHECK(help.err.empty());
  for (const char* command : {"mesh", "surface", "subdivide", "inspect", "quality"}) {
    CHECK_THAT(help.out, contains_text(command));
    for (const Strings& words : {Strings{command, "--help"}, Strings{command, "-h"}}) {
      const ProgramRun run = run_flowcage(words);
      CHECK(run.exit_code == 0);
      CHECK(run.err.empty());
      CHECK_THAT(run.out, contains_text(std::string("Example:\n  flowcage ") + command));
    }
  }
}

TEST_CASE("wrong usage: exit 2 and what was meant") {
  check_error(run_flowcage({}), 2, "no command", "--help");
  check_error(run_flowcage({"mehs"}), 2, "\"mehs\"", "did you mean mesh?");
  check_error(run_flowcage({"xyzzy"}), 2, "\"xyzzy\"", "flowcage --help");
  check_error(run_flowcage({"--verison"}), 2, "--verison", "did you mean --version?");
  check_error(run_flowcage({"subdivide", "c.obj", "--level", "2", "-o", "x.obj"}), 2,
              "unknown option --level", "did you mean --levels?");
  check_error(run_flowcage({"mesh", "a.step", "--farfeild=box", "-o", "x"}), 2, "unknown option --farfeild",
              "did you mean --farfield?");
  check_error(run_flowcage({"subdivide", "c.obj", "-z"}), 2, "unknown option -z", "subdivide --help");
  check_error(run_flowcage({"subdivide", "--levels", "2", "-o", "x.obj"}), 2, "CAGE", "--help");
  check_error(run_flowcage({"subdivide", "c.obj", "--levels", "2"}), 2, "--output is required", "--help");
  check_error(run_flowcage({"subdivide", "c.obj", "-o", "x.obj"}), 2, "--levels is missing", "--levels N");
  check_error(run_flowcage({"subdivide", "c.obj", "-o"}), 2, "the value is missing", "-o OUT");
  check_error(run_flowcage({"subdivide", "c.obj", "-o", "--levels", "2"}), 2, "-o: the value is missing",
              "-o OUT");
  for (const Strings& json : {Strings{"--json", "-o"}, Strings{"--json=", "-o"}}) {
    check_error(run_flowcage({"mesh", "a", json[0], json[1], "x"}), 2, "--json: the value is missing",
                "--json FILE");
  }
  check_error(run_flowcage({"mesh", "a", "--quiet=1", "-o", "x"}), 2, "--quiet: takes no value", "alone");
  check_error(run_flowcage({"mesh", "a", "--seed", "-1", "-o", "x"}), 2, "--seed: \"-1\"", "0 <= N");
  check_error(run_flowcage({"mesh", "a", "-o", ""}), 2, "-o: the name is empty", "name of a file");
  check_error(run_flowcage({"subdivide", "c.obj", "d.obj", "--levels", "2", "-o", "x.obj"}), 2, "received 2",
              "--help");
  for (const char* bad : {"-1", "11", "2.5", "two", "", "99999999999999999999", "nan"}) {
    check_error(run_flowcage({"subdivide", "c.obj", "--levels", bad, "-o", "x.obj"}), 2,
                std::string("--levels: \"") + bad, "0 <= N <= 10");
  }
  check_error(run_flowcage({"subdivide", "c.obj", "--levels", "1", "--levels", "2", "-o", "x.obj"}), 2,
              "--levels", "--help");
  check_error(run_flowcage({"mesh", "a", "--tolerance", "0", "-o", "x"}), 2, "--tolerance: \"0\"",
              "0 < T <= 1");
  check_error(run_flowcage({"mesh", "a", "--unit", "parsec", "-o", "x"}), 2, "\"parsec\"", "m|mm|in|ft");
  check_error(run_flowcage({"mesh", "a", "--unit", "m|mm", "-o", "x"}), 2, "\"m|mm\"", "m|mm|in|ft");
  check_error(run_flowcage({"mesh", "a", "--symmetry", "w", "-o", "x"}), 2, "\"w\"", "x|y|z[=VALUE]");
  check_error(run_flowcage({"mesh", "a", "--snap", "--no-snap", "-o", "x"}), 2, "exclude", "one of them");
}

TEST_CASE("outputs go to -o or to --out-dir") {
  check_error(run_flowcage({"mesh", "a.step"}), 2, "--output is required", "-o OUT");
  check_error(run_flowcage({"mesh", "a.step", "-o", "x", "--jobs", "2"}), 2, "--jobs belongs to --out-dir",
              "");
  check_error(run_flowcage({"mesh", "a.step", "-o", "x", "--format", "msh"}), 2, "--format belongs to", "");
}

TEST_CASE("y+ needs what it is made with, and excludes a first height") {
  check_error(run_flowcage({"mesh", "a.step", "--yplus", "1", "-o", "x"}), 2, "--reynolds and --length", "");
  check_error(run_flowcage({"mesh", "a.step", "--yplus", "1", "--reynolds", "1e6", "-o", "x"}), 2,
              "needs --length", "");
  check_error(run_flowcage({"mesh", "a.step", "--length", "1", "-o", "x"}), 2, "belong to --yplus", "");
  check_error(run_flowcage({"mesh", "a.step", "--yplus", "1", "--reynolds", "1e6", "--length", "1",
                            "--first-height", "1e-5", "-o", "x"}),
              2, "both ask", "leave one");
}

TEST_CASE("convert: from each format to each other, whole or not at all") {
  const WorkFolder folder;
  const RunSettings in{.folder = folder.path()};
  const std::string one_hex =
      "NDIME= 3\nNELEM= 1\n12 0 1 2 3 4 5 6 7\nNPOIN= 8\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n"
      "0 0 1\n1 0 1\n1 1 1\n0 1 1\nNMARK= 1\nMARKER_TAG= sym\nMARKER_ELEMS= 1\n9 0 1 2 3\n";
  folder.put("a.su2", one_hex);
  CHECK(run_flowcage({"convert", "a.su2", "-o", "b.msh", "-o", "b.vtu"}, in).exit_code == 0);
  CHECK(run_flowcage({"convert", "b.msh", "-o", "c/"}, in).exit_code == 0);
  CHECK(run_flowcage({"convert", "c", "-o", "d.su2", "-o", "e.cgns"}, in).exit_code == 0);
  CHECK(
      run_flowcage({"convert", "e.cgns", "-o", "f.cgns", "-o", "f.p3d", "-o", "g.VTM", "--unstructured"}, in)
          .exit_code == 0);
  CHECK(folder.text_of("f.p3d").substr(0, 8) == "1\n2 2 2\n");
  CHECK_THAT(folder.text_of("f.nmf"), contains_text("# patch sym\nSYMMETRY "));
  for (const char* mesh : {"a.su2", "b.msh", "b.vtu", "c", "d.su2", "e.cgns", "f.cgns", "g.VTM"}) {
    const ProgramRun run = run_flowcage({"quality", mesh}, in);
    CHECK(run.exit_code == 0);
    CHECK_THAT(run.out, contains_text("cells     1\n"));
    CHECK_THAT(run.out, contains_text("sym                              symmetry           1 faces"));
    CHECK_THAT(run.out, contains_text("unassigned                       wall               5 faces"));
  }
  folder.put("LOUD.MSH", folder.text_of("b.msh"));
  CHECK(run_flowcage({"convert", "LOUD.MSH", "-o", "LOUD.SU2"}, in).exit_code == 0);
  check_error(run_flowcage({"convert", "b.msh", "-o", "g.vtm", "-o", "g_vtm"}, in), 2,
              "the folder of -o g.vtm g_vtm: the same file", "");
  const Strings before = folder.entries();
  folder.put("a.su2", one_hex.substr(0, 80));
  check_error(run_flowcage({"convert", "a.su2", "-o", "e.msh"}, in), 3, "a.su2:10: the file ends",
              "write it again");
  check_error(run_flowcage({"convert", "a.su2", "-o", "a.su2"}, in), 2, "the same file as the input", "");
  check_error(run_flowcage({"convert", "b.msh", "-o", "g.xyz", "-o", "g.p3d"}, in), 2, "g.nmf: the same file",
              "");
  check_error(run_flowcage({"inspect", "a.su2", "--report", "a.su2"}, in), 2, "the same file as the input",
              "");
  CHECK(folder.entries() == before);
}

TEST_CASE("subdivide: control mesh, limit points, nothing on stdout") {
  const WorkFolder folder;
  folder.put("cube.obj", cube_text);
  const RunSettings in{.folder = folder.path()};
  const ProgramRun run =
      run_flowcage({"subdivide", "cube.obj", "--levels", "1", "-o", "one.obj", "-o", "copy.obj"}, in);
  INFO(run.err);
  REQUIRE(run.exit_code == 0);
  CHECK(run.out.empty());
  // Child vertices keep their parent's number: vertex 1 is the cube's first corner, (F + 2 E) / 3 with P n-3
  // = 0.
  double x = 0, y = 0, z = 0;
  REQUIRE(std::sscanf(folder.text_of("one.obj").c_str(), "v %lf %lf %lf", &x, &y, &z) == 3);
  for (double c : {x, y, z}) CHECK(c == Approx(-5.0 / 9).epsilon(1e-15));
  CHECK(folder.text_of("one.obj") == folder.text_of("copy.obj"));
  CHECK_THAT(folder.text_of("one.obj"), contains_text("g top\nf "));

  // Levels 1 and 1 more are level 2; the limit point of a vertex does not depend on the level.
  REQUIRE(run_flowcage({"subdivide", "one.obj", "--levels", "1", "-o", "two.obj"}, in).exit_code == 0);
  REQUIRE(run_flowcage({"subdivide", "cube.obj", "--levels", "2", "-o", "two_at_once.obj"}, in).exit_code ==
          0);
  CHECK(sorted_points(folder.text_of("two.obj")).size() == 98);
  CHECK(sorted_points(folder.text_of("two.obj")) == sorted_points(folder.text_of("two_at_once.obj")));
  for (const char* levels : {"0", "2"}) {
    REQUIRE(run_flowcage(
                {"subdivide", "cube.obj", "--levels", levels, "--limit", "--quiet", "-o", "limit.obj"}, in)
                .exit_code == 0);
    REQUIRE(std::sscanf(folder.text_of("limit.obj").c_str(), "v %lf %lf %lf", &x, &y, &z) == 3);
    // n = 3: (9 P + 4 sum E + sum F) / 24 with the neighbours and the opposite corners of the three faces.
    for (double c : {x, y, z}) CHECK(c == Approx(-0.5).epsilon(1e-14));
  }
  CHECK(run_flowcage({"subdivide", "cube.obj", "--levels", "1", "--quiet", "-o", "one.obj"}, in).err.empty());
}

TEST_CASE("subdivide: the same bytes on any number of threads") {
  const WorkFolder folder;
  folder.put("cube.obj", std::string(cube_text) + "t crease 2/1/0 0 1 2.5\nl 5 6 8\nt corner 1/1/0 3 1.5\n");
  const RunSettings in{.folder = folder.path()};
  for (const char* threads : {"1", "2", "7"}) {
    REQUIRE(run_flowcage({"subdivide", "cube.obj", "--levels", "5", "--limit", "--threads", threads, "-o",
                          std::string(threads) + ".obj"},
                         in)
                .exit_code == 0);
  }
  CHECK(folder.text_of("1.obj").size() > 100000);
  CHECK(folder.text_of("1.obj") == folder.text_of("2.obj"));
  CHECK(folder.text_of("1.obj") == folder.text_of("7.obj"));
}

TEST_CASE("unusable cages: exit 3 with file and line, nothing written") {
  const WorkFolder folder;
  folder.put("text.obj", "this is no cage\n");
  folder.put("empty.obj", "");
  folder.put("step.obj", "ISO-10303-21;\nHEADER;\n");
  folder.put("binary.obj", std::string("v 0 0 0\n\0\1\2", 11));
  folder.put("three.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 0 -1 0\nf 1 2 3\nf 2 1 4\nf 1 2 5\n");
  const auto check = [&](const std::string& cage, const std::string& what) {
    const ProgramRun run =
        run_flowcage({"subdivide", cage, "--levels", "1", "-o", "x.obj"}, {.folder = folder.path()});
    check_error(run, 3, what, "");
    CHECK(folder.entries() == Strings{"binary.obj", "empty.obj", "step.obj", "text.obj", "three.obj"});
  };
  check("missing.obj", "missing.obj: cannot read: No such file");
  check("./text.obj", "./text.obj:1: unknown statement \"this\"");
  check("empty.obj", "empty.obj: the file is empty");
  check("step.obj", "step.obj:1: this is a STEP file");
  check("binary.obj", "binary.obj:2: binary data");
  check("three.obj", "three.obj:8: edge 1-2 at (0.5, 0, 0) belongs to more than two faces");
  check(".", ".: cannot read: Is a directory");
}

TEST_CASE("places that cannot be written: exit 5, an older output stays") {
  const WorkFolder folder;
  folder.put("cube.obj", cube_text);
  folder.put("file", "x");
  std::filesystem::create_directory(folder.path() / "folder.obj");
  const auto subdivide = [&](const std::string& out, const std::string& levels = "1") {
    return run_flowcage({"subdivide", "cube.obj", "--levels", levels, "-o", out}, {.folder = folder.path()});
  };
  check_error(subdivide("file/x.obj"), 5, "file/x.obj: cannot write: Not a directory",
              "choose another folder");
  check_error(subdivide("missing/x.obj"), 5, "missing/x.obj: cannot write: No such file",
              "create the folder");
  check_error(subdivide("folder.obj"), 5, "folder.obj: cannot write: Is a directory", "name of a file");
  if (std::filesystem::exists("/dev/full")) {
    check_error(subdivide("/dev/full"), 5, "/dev/full: cannot write: No space left", "free space");
    CHECK(std::filesystem::is_character_file("/dev/full"));
    const ProgramRun help = run_flowcage({"--help"}, {.stdout_file = "/dev/full"});
    check_error(help, 5, "standard output: cannot write: No space left", "");
  }
  // One of two outputs fails: neither is there.
  check_error(run_flowcage({"subdivide", "cube.obj", "--levels", "1", "-o", "new.obj", "-o", "file/x.obj"},
                           {.folder = folder.path()}),
              5, "file/x.obj", "");
  CHECK(folder.entries() == Strings{"cube.obj", "file", "folder.obj"});
  // The cage itself may be the output's name; a refused run leaves it alone.
  check_error(subdivide("cube.obj", "10 "), 2, "--levels", "");
  CHECK(folder.text_of("cube.obj") == cube_text);
  REQUIRE(subdivide("cube.obj").exit_code == 0);
  CHECK(folder.text_of("cube.obj") != cube_text);
}

TEST_CASE("interrupted: exit 130, no partial file, an older output stays") {
  for (const int signal : {SIGINT, SIGTERM}) {
    const WorkFolder folder;
    folder.put("cube.obj", cube_text);
    folder.put("x.obj", "older");
    const ProgramRun run = run_flowcage({"subdivide", "cube.obj", "--levels", "10", "-o", "x.obj"},
                                        {.folder = folder.path(), .signal = signal, .signal_delay = 0.5});
    check_error(run, 130, "interrupted", "nothing was written");
    CHECK(run.seconds < 10);
    CHECK(folder.entries() == Strings{"cube.obj", "x.obj"});
    CHECK(folder.text_of("x.obj") == "older");
  }
}

TEST_CASE("more than the machine holds is refused or reported, never a crash") {
  const WorkFolder folder;
  folder.put("cube.obj", cube_text);
  REQUIRE(
      run_flowcage({"subdivide", "cube.obj", "--levels", "4", "-o", "fine.obj"}, {.folder = folder.path()})
          .exit_code == 0);
  check_error(
      run_flowcage({"subdivide", "fine.obj", "--levels", "10", "-o", "x.obj"}, {.folder = folder.path()}), 2,
      "10 levels of fine.obj make", "fewer levels");
}

TEST_CASE("inspect and quality: unusable input") {
  const WorkFolder folder;
  folder.put("text.step", "this is no STEP file\n");
  folder.put("cube.obj", cube_text);
  folder.put("text.vtu", "this is no mesh\n");
  std::filesystem::create_directory(folder.path() / "case");
  const RunSettings in{.folder = folder.path()};
  for (const char* cad : {"missing.step", "text.step", "cube.obj", "case", "/dev/null"}) {
    check_error(run_flowcage({"inspect", cad, "--json", "x.json"}, in), 3, cad, "");
  }
  for (const char* mesh : {"missing.vtu", "missing", "text.vtu", "case", "cube.obj"}) {
    check_error(run_flowcage({"quality", mesh, "--json", "x.json"}, in), 3, mesh, "");
  }
  CHECK(folder.entries() == Strings{"case", "cube.obj", "text.step", "text.vtu"});
}

TEST_CASE("surface and mesh: wrong usage and unusable input, before any long work") {
  const WorkFolder folder;
  folder.put("text.step", "this is no STEP file\n");
  folder.put("cube.obj", cube_text);
  folder.put("bad.obj", "v 0 0 0\nv 1 0 0\nf 1 2 2\n");
  const RunSettings in{.folder = folder.path()};
  const auto run = [&](const char* command, const Strings& rest) {
    Strings arguments{command, "text.step"};
    arguments.insert(arguments.end(), rest.begin(), rest.end());
    return run_flowcage(arguments, in);
  };
  for (const char* command : {"surface", "mesh"}) {
    const std::string out = std::string(command) == "mesh" ? "x.vtu" : "x.obj";
    const Strings alone =
        std::string(command) == "mesh" ? Strings{"--blocks", "shell", "-o", out} : Strings{"-o", out};
    check_error(run(command, alone), 2, "--cage is missing", "--cage FILE");
    check_error(run(command, {"--cage", "missing.obj", "-o", out}), 3, "missing.obj: cannot read", "");
    check_error(run(command, {"--cage", "bad.obj", "-o", out}), 3, "bad.obj:3: face 1 has vertex 2", "");
    check_error(run(command, {"--cage", "cube.obj", "-o", out}), 3, "text.step", "");
    check_error(run(command, {"--cage", "cube.obj", "-o", "x.txt"}), 2, "x.txt: unknown", "");
  }
  check_error(run("surface", {"--cage", "cube.obj", "-o", "x.step"}), 3, "text.step", "");
  CHECK(folder.entries() == Strings{"bad.obj", "cube.obj", "text.step"});
}
