// Options from a TOML file, seen from outside: the same run as by the command line, and messages with lines.
#include "tests/catch.hpp"
#include "tests/cli/run_program.hpp"

using namespace flowcage;
using Strings = std::vector<std::string>;

namespace {

constexpr const char* quad_text = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n";

/// A run in the folder, which must end with this code and say all of this on stderr.
void check_refused(const WorkFolder& folder, const Strings& arguments, int exit_code, const Strings& parts) {
  const ProgramRun run = run_flowcage(arguments, {.folder = folder.path()});
  INFO(run.err);
  CHECK(run.exit_code == exit_code);
  for (const std::string& part : parts) CHECK_THAT(run.err, contains_text(part));
}

}  // namespace

TEST_CASE("a configuration file gives the same run as the command line, which wins") {
  const WorkFolder folder;
  folder.put("quad.obj", quad_text);
  folder.put("case.toml", "levels = 2\nlimit = true  # of the vertices\n");
  const RunSettings here{.folder = folder.path()};
  const auto subdivide = [&](const Strings& more, const std::string& out) {
    Strings words{"subdivide", "quad.obj", "-o", out};
    words.insert(words.end(), more.begin(), more.end());
    const ProgramRun run = run_flowcage(words, here);
    INFO(run.err);
    REQUIRE(run.exit_code == 0);
    return folder.text_of(out);
  };
  const std::string two = subdivide({"--levels", "2", "--limit"}, "a.obj");
  CHECK(subdivide({"--config", "case.toml"}, "b.obj") == two);
  const std::string one = subdivide({"--levels", "1", "--limit"}, "c.obj");
  CHECK(one != two);
  CHECK(subdivide({"--config", "case.toml", "--levels", "1", "--save-config", "saved.toml"}, "d.obj") == one);
  // What was in force, not what the first file said.
  CHECK_THAT(folder.text_of("saved.toml"), contains_text("levels = 1\n"));
  CHECK(subdivide({"--config", "saved.toml"}, "e.obj") == one);
}

TEST_CASE("a saved configuration reads back as it was, whatever its texts are") {
  const WorkFolder folder;
  const RunSettings here{.folder = folder.path()};
  const Strings words{
      "mesh",      "none.step", "-o",         "case",        "--tolerance", "3e-05",         "--first-height",
      "0.1",       "--no-snap", "--symmetry", "y=-0.25",     "--include",   "a, \"b\"\\c",   "--include",
      "tab\there", "--cells",   "2000000000", "--cage-unit", "in",          "--save-config", "first.toml"};
  CHECK(run_flowcage(words, here).exit_code == 3);  // no such CAD, but the options are kept
  const std::string first = folder.text_of("first.toml");
  for (const char* line :
       {"tolerance = 3e-05\n", "first-height = 0.1\n", "snap = false\n", "symmetry = \"y=-0.25\"\n",
        "include = [\"a, \\\"b\\\"\\\\c\", \"tab\\u0009here\"]\n", "cells = 2000000000\n",
        "cage-unit = \"in\"\n", "unite = true\n"}) {
    CHECK_THAT(first, contains_text(line));
  }
  CHECK(
      run_flowcage(
          {"mesh", "none.step", "-o", "case", "--config", "first.toml", "--save-config", "again.toml"}, here)
          .exit_code == 3);
  CHECK(folder.text_of("again.toml") == first);
  // Opposites and lists: the command line replaces.
  CHECK(run_flowcage({"mesh", "none.step", "-o", "case", "--config", "first.toml", "--snap", "--include", "z",
                      "--save-config", "won.toml"},
                     here)
            .exit_code == 3);
  CHECK_THAT(folder.text_of("won.toml"), contains_text("snap = true\n"));
  CHECK_THAT(folder.text_of("won.toml"), contains_text("include = [\"z\"]\n"));
}

TEST_CASE("what is wrong in a configuration file is named with its line and the remedy") {
  const struct {
    const char* text;
    const char* place;
    const char* what;
    const char* remedy;
  } cases[] = {
      {"\ntolerence = 1e-4\n", "case.toml:2: ", "unknown option \"tolerence\"", "did you mean tolerance?"},
      {"limit = true\n", "case.toml:1: ", "unknown option \"limit\"", ""},  // of subdivide, not of mesh
      {"config = \"x.toml\"\n", "case.toml:1: ", "unknown option \"config\"", ""},
      {"\n\nlevels = \"two\"\n", "case.toml:3: ", "levels: the value has the wrong type", "without quotes"},
      {"snap = 1\n", "case.toml:1: ", "snap: the value has the wrong type", "true or false"},
      {"cage = 7\n", "case.toml:1: ", "cage: the value has the wrong type", "quotes"},
      {"levels = [1, 2]\n", "case.toml:1: ", "levels: the value has the wrong type", ""},
      {"[levels]\nx = 1\n", "case.toml:1: ", "levels: the value has the wrong type", ""},
      {"include = [\"a\",\n  3]\n", "case.toml:2: ", "include: the value has the wrong type", "list"},
      {"levels = 2.5\n", "case.toml:1: ", "is no whole number", "0 <= N <= 10"},
      {"levels = 11\n", "case.toml:1: ", "is out of range", "0 <= N <= 10"},
      {"tolerance = inf\n", "case.toml:1: ", "is no number", ""},
      {"tolerance = -1e-4\n", "case.toml:1: ", "is out of range", "0 < T <= 1"},
      {"unit = \"furlong\"\n", "case.toml:1: ", "is no such choice", "m|mm|in|ft"},
      {"levels = 1\nlevels = 2\n", "case.toml:2: ", "", "TOML"},
      {"levels = \n", "case.toml:1: ", "", "TOML"}};
  for (const auto& c : cases) {
    const WorkFolder folder;
    folder.put("case.toml", c.text);
    INFO(c.text);
    check_refused(folder, {"mesh", "none.step", "-o", "case", "--config", "case.toml"}, 3,
                  {c.place, c.what, c.remedy});
  }
  const WorkFolder folder;
  folder.put("case.toml", "levels = 11\n");
  // Wrong though the command line replaces it.
  check_refused(folder, {"mesh", "none.step", "-o", "case", "--config", "case.toml", "--levels", "1"}, 3,
                {"case.toml:1: "});
  check_refused(folder, {"mesh", "none.step", "-o", "case", "--config", "none.toml"}, 3, {"none.toml"});
  folder.put("right.toml", "levels = 1\n");
  check_refused(folder,
                {"mesh", "none.step", "-o", "case", "--config", "right.toml", "--save-config", "right.toml"},
                2, {"the same file as --config"});
  CHECK(folder.text_of("right.toml") == "levels = 1\n");
  check_refused(folder, {"mesh", "none.step", "-o", "case", "--save-config", "none/x.toml"}, 5,
                {"none/x.toml"});
}
