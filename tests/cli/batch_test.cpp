// mesh --out-dir, seen from outside.
#include <signal.h>

#include <chrono>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <thread>

#include "tests/catch.hpp"
#include "tests/cli/sphere_folder.hpp"

using namespace flowcage;
using flowcage::tests::SphereFolder;
using Json = nlohmann::json;
using Strings = std::vector<std::string>;
namespace fs = std::filesystem;

namespace {

/// Spheres a, b and c, and `broken.step`, which is no CAD.
class ManySpheres : public SphereFolder {
 public:
  ManySpheres() {
    for (const char* name : {"a.step", "b.step", "c.step"}) fs::copy(path() / "sphere.step", path() / name);
    put("broken.step", "ISO-10303-21;\nnothing");
  }
  ProgramRun batch(const Strings& inputs, const Strings& rest = {}, RunSettings settings = {},
                   const char* level = "1") const {
    Strings arguments{"mesh"};
    arguments.insert(arguments.end(), inputs.begin(), inputs.end());
    for (const char* word :
         {"--cage", "cage.obj", "--levels", level, "--tolerance", "1e-2", "--out-dir", "out"})
      arguments.emplace_back(word);
    arguments.insert(arguments.end(), rest.begin(), rest.end());
    settings.folder = path();
    return run_flowcage(arguments, settings);
  }
};

/// The lines by input; each must be JSON.
std::map<std::string, Json> lines_of(const ProgramRun& run) {
  std::map<std::string, Json> lines;
  std::istringstream in(run.out);
  for (std::string line; std::getline(in, line);) {
    const Json json = Json::parse(line);
    CHECK(lines.emplace(json.at("input"), json).second);
  }
  return lines;
}

std::map<std::string, std::string> status_of(const ProgramRun& run) {
  std::map<std::string, std::string> status;
  for (const auto& [input, json] : lines_of(run)) status[input] = json.at("status");
  return status;
}

/// Entries of the output folder but the records.
Strings outputs_in(const fs::path& folder) {
  Strings names;
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    if (!name.ends_with(".flowcage.json")) names.push_back(name);
  }
  std::sort(names.begin(), names.end());
  return names;
}

/// The children of a process, by the system's list.
std::vector<pid_t> children_of(pid_t parent) {
  std::vector<pid_t> children;
  for (const auto& entry : fs::directory_iterator("/proc")) {
    std::ifstream stat(entry.path() / "stat");
    std::string text;
    if (!std::getline(stat, text)) continue;
    std::istringstream words(text.substr(text.rfind(')') + 1));
    char state = 0;
    pid_t of = 0;
    if (words >> state >> of && of == parent && state != 'Z')
      children.push_back(std::stoi(entry.path().filename()));
  }
  return children;
}

/// The first grandchild of this process, once there is one.
pid_t wait_for_grandchild() {
  for (int i = 0; i < 1000; ++i) {
    for (const pid_t child : children_of(::getpid())) {
      const auto grandchildren = children_of(child);
      if (!grandchildren.empty()) return grandchildren.front();
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return 0;
}

}  // namespace

TEST_CASE("a batch: one line of JSON a file, failures in the exit code, the rest done") {
  const ManySpheres folder;
  const ProgramRun run =
      folder.batch({"a.step", "broken.step", "b.step"}, {"--jobs", "2", "--format", "vtu"});
  INFO(run.err);
  CHECK(run.exit_code == 3);
  const auto lines = lines_of(run);
  REQUIRE(lines.size() == 3);
  for (const char* name : {"a.step", "b.step"}) {
    const Json& line = lines.at(name);
    CHECK(line.at("status") == "done");
    CHECK(line.at("exit_code") == 0);
    CHECK(line.at("cells") > 100);
    CHECK(line.at("max_deviation") < 1e-2);
    CHECK(line.at("seconds") > 0);
  }
  CHECK(lines.at("broken.step").at("status") == "failed");
  CHECK(lines.at("broken.step").at("exit_code") == 3);
  CHECK_THAT(lines.at("broken.step").at("message").get<std::string>(), contains_text("broken.step"));
  CHECK(outputs_in(folder.path() / "out") == Strings{"a.vtu", "b.vtu"});
  // As a run by itself makes it, whatever the number of jobs.
  const ProgramRun alone = folder.run("mesh", {"--levels", "1", "--tolerance", "1e-2", "-o", "alone.vtu"});
  CHECK(alone.exit_code == 0);
  CHECK(folder.text_of("alone.vtu") == folder.text_of("out/a.vtu"));
}

TEST_CASE("a batch resumes: what is done stays, what changed is done again") {
  const ManySpheres folder;
  const Strings all{"a.step", "b.step"};
  using Status = std::map<std::string, std::string>;
  CHECK(status_of(folder.batch(all)) == Status{{"a.step", "done"}, {"b.step", "done"}});
  const ProgramRun again = folder.batch(all);
  CHECK(again.exit_code == 0);
  CHECK(status_of(again) == Status{{"a.step", "skipped"}, {"b.step", "skipped"}});
  fs::remove(folder.path() / "out/a.vtu");  // an output that is gone,
  CHECK(status_of(folder.batch(all)) == Status{{"a.step", "done"}, {"b.step", "skipped"}});
  folder.put("b.step", folder.text_of("b.step") + "\n");  // an input that changed,
  CHECK(status_of(folder.batch(all)) == Status{{"a.step", "skipped"}, {"b.step", "done"}});
  CHECK(status_of(folder.batch(all, {"--growth", "1.3"})) == Status{{"a.step", "done"}, {"b.step", "done"}});
  folder.put("cage.obj", folder.text_of("cage.obj") + "\n");  // another input of both
  CHECK(status_of(folder.batch(all, {"--growth", "1.3", "--jobs", "2"})) ==
        Status{{"a.step", "done"}, {"b.step", "done"}});
}

TEST_CASE("a child that crashes is one failed line, and leaves nothing") {
  const ManySpheres folder;
  std::thread killer([] {
    const pid_t child = wait_for_grandchild();
    if (child > 0) ::kill(child, SIGKILL);
  });
  const ProgramRun run = folder.batch({"a.step", "b.step"});
  killer.join();
  CHECK(run.exit_code == 70);
  const auto lines = lines_of(run);
  REQUIRE(lines.size() == 2);
  CHECK(lines.at("a.step").at("status") == "failed");
  CHECK(lines.at("a.step").at("signal") == SIGKILL);
  CHECK(lines.at("b.step").at("status") == "done");
  CHECK(outputs_in(folder.path() / "out") == Strings{"b.vtu"});
}

TEST_CASE("Ctrl-C ends a batch and its children") {
  const ManySpheres folder;
  // Level 5 takes much longer than the signal's delay.
  RunSettings settings;
  settings.signal = SIGINT;
  settings.signal_delay = 1;
  const ProgramRun run = folder.batch({"a.step", "b.step", "c.step"}, {"--jobs", "2"}, settings, "5");
  CHECK(run.exit_code == 130);
  CHECK(run.out.empty());
  CHECK(run.seconds < 8);
  CHECK(outputs_in(folder.path() / "out").empty());
  CHECK(children_of(::getpid()).empty());
}

TEST_CASE("what a batch cannot do is refused before it starts") {
  const ManySpheres folder;
  const auto refused = [&](const Strings& inputs, const Strings& rest, const std::string& why) {
    const ProgramRun run = folder.batch(inputs, rest);
    CHECK(run.exit_code == 2);
    CHECK(run.out.empty());
    CHECK_THAT(run.err, contains_text(why));
    CHECK_FALSE(fs::exists(folder.path() / "out"));
  };
  fs::create_directory(folder.path() / "more");
  fs::copy(folder.path() / "a.step", folder.path() / "more/a.step");
  fs::copy(folder.path() / "a.step", folder.path() / "...step");
  refused({"a.step", "more/a.step"}, {}, "the same output");
  refused({"...step"}, {"--format", "foam"}, "would leave out");
  refused({"a.step"}, {"--format", "../x"}, "is no ending");
  refused({"a.step"}, {"--format", "txt"}, "unknown mesh format");
  refused({"a.step"}, {"-o", "x.vtu"}, "-o and --out-dir exclude each other");
  refused({"a.step"}, {"--json", "x.json"}, "--json and --out-dir exclude each other");
}
