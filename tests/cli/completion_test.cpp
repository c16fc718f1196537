// The shells' completion and the manual page, as the shells and mandoc take them.
#include "cli/command_table.hpp"
#include "tests/catch.hpp"
#include "tests/cli/run_program.hpp"
#include "tests/export/peers.hpp"

using namespace flowcage;
using flowcage::tests::have_program;
using flowcage::tests::PeerRun;
using flowcage::tests::run;

namespace {

std::string generated(const std::vector<std::string>& arguments) {
  const ProgramRun made = run_flowcage(arguments);
  CHECK(made.exit_code == 0);
  CHECK(made.err.empty());
  return made.out;
}

}  // namespace

TEST_CASE("bash offers commands, options and choices") {
  if (!have_program("bash")) return;
  const WorkFolder folder;
  folder.put("flowcage.bash", generated({"completion", "bash"}));
  folder.put("wing.step", "");
  const auto offers = [&](const std::string& words) {
    const PeerRun said =
        run("cd '" + folder.path().string() + "' && bash -c 'source flowcage.bash; COMP_WORDS=(" + words +
            "); COMP_CWORD=$((${#COMP_WORDS[@]} - 1)); _flowcage; echo \"${COMPREPLY[*]}\"'");
    CHECK(said.exit_code == 0);
    return said.output;
  };
  CHECK(offers("flowcage insp") == "inspect\n");
  CHECK(offers("flowcage mesh --first") == "--first-height\n");
  CHECK(offers("flowcage mesh --no-s") == "--no-snap\n");
  CHECK(offers("flowcage mesh a.step --farfield b") == "box bullet\n");
  CHECK(offers("flowcage mesh a.step --farfield \"\"") == "box sphere bullet\n");
  CHECK(offers("flowcage mesh wi") == "wing.step\n");
  CHECK(offers("flowcage mesh a.step -o wi") == "wing.step\n");
  CHECK(offers("flowcage quality --first") == "\n");
  CHECK(offers("flowcage completion z") == "zsh\n");
  CHECK(offers("flowcage mesh --levels w") == "\n");
}

TEST_CASE("fish offers commands, options and choices") {
  if (!have_program("fish")) return;
  const WorkFolder folder;
  folder.put("flowcage.fish", generated({"completion", "fish"}));
  const auto offers = [&](const std::string& line) {
    const PeerRun said = run("cd '" + folder.path().string() +
                             "' && HOME=. fish -c 'source flowcage.fish; complete -C \"" + line + "\"'");
    CHECK(said.exit_code == 0);
    return said.output;
  };
  CHECK_THAT(offers("flowcage insp"), contains_text("inspect\twhat is in a CAD file"));
  CHECK_THAT(offers("flowcage mesh --first"), contains_text("--first-height"));
  CHECK_THAT(offers("flowcage mesh a.step --farfield bul"), contains_text("bullet"));
  CHECK_THAT(offers("flowcage completion z"), contains_text("zsh"));
  CHECK(offers("flowcage quality --first").empty());
}

TEST_CASE("zsh takes its completion and offers the same") {
  if (!have_program("zsh")) return;
  const WorkFolder folder;
  folder.put("_flowcage", generated({"completion", "zsh"}));
  // What _arguments and _describe are given: the completion system itself wants a terminal.
  folder.put("try.zsh",
             "compdef() { registered=\"$1 $2\"; }\nsource ./_flowcage\nprint -r -- \"$registered\"\n"
             "_arguments() { print -rl -- \"$@\"; }\n_describe() { print -rl -- \"${commands[@]}\"; }\n"
             "words=(flowcage ''); CURRENT=2; _flowcage\nwords=(flowcage mesh ''); CURRENT=3; _flowcage\n");
  const PeerRun said = run("cd '" + folder.path().string() + "' && zsh -f try.zsh");
  CAPTURE(said.output);
  CHECK(said.exit_code == 0);
  for (const char* line : {"_flowcage flowcage\n", "\ninspect:what is in a CAD file", "\n*--output[",
                           ":box|sphere|bullet:(box sphere bullet)\n", "\n--no-snap[", "\n*:CAD:_files\n"}) {
    CHECK_THAT(said.output, contains_text(line));
  }
}

TEST_CASE("every option of a command is in each completion") {
  for (const char* shell : {"bash", "zsh", "fish"}) {
    const std::string script = generated({"completion", shell});
    for (const OptionSpec& row : option_table()) {
      const std::string name = std::string(shell) == "fish" ? "-l " + row.name : "--" + row.name;
      CHECK_THAT(script, contains_text(name));
    }
    for (const CommandSpec& spec : command_table()) CHECK_THAT(script, contains_text(spec.name));
  }
  const ProgramRun other = run_flowcage({"completion", "bahs"});
  CHECK(other.exit_code == 2);
  CHECK_THAT(other.err, contains_text("did you mean bash?"));
}

TEST_CASE("the manual page: every command and option, and mandoc finds no fault") {
  const std::string page = generated({"man"});
  for (const CommandSpec& spec : command_table()) CHECK_THAT(page, contains_text("flowcage " + spec.name));
  if (!have_program("mandoc")) return;
  const WorkFolder folder;
  folder.put("flowcage.1", page);
  const std::string file = (folder.path() / "flowcage.1").string();
  const PeerRun lint = run("mandoc -T lint -W warning '" + file + "'");
  CAPTURE(lint.output);
  CHECK(lint.exit_code == 0);
  CHECK(lint.output.empty());
  const PeerRun text = run("mandoc -T ascii -O width=300 '" + file + "' | col -b");
  for (const OptionSpec& row : option_table()) CHECK_THAT(text.output, contains_text("--" + row.name));
  for (const char* words : {"EXIT STATUS", "flowcage mesh wing.step --cage wing_cage.obj", "[0 < T <= 1;"}) {
    CHECK_THAT(text.output, contains_text(words));
  }
}
