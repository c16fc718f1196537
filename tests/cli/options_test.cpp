#include "core/options.hpp"

#include <cstdlib>
#include <fstream>
#include <iterator>
#include <set>

#include "core/base/error.hpp"
#include "core/base/suggestion.hpp"
#include "tests/catch.hpp"

using namespace flowcage;

namespace {

const OptionSpec& named(const std::string& name) {
  for (const OptionSpec& row : option_table()) {
    if (row.name == name) return row;
  }
  throw std::runtime_error("no option " + name);
}

}  // namespace

TEST_CASE("option table: each row sets what it shows") {
  std::set<std::string> names;
  for (const OptionSpec& row : option_table()) {
    INFO(row.name);
    CHECK(names.insert(row.name).second);
    CHECK(row.commands != 0);
    CHECK_FALSE(row.help.empty());
    CHECK_FALSE(row.group.empty());
    Options options;
    const std::string value = row.is_flag()            ? (row.show(options) == "true" ? "false" : "true")
                              : row.name == "symmetry" ? "y=-0.25"
                              : row.name.find("unit") != std::string::npos ? "ft"
                              : row.name == "farfield"                     ? "sphere"
                              : row.name == "blocks"                       ? "shell"
                              : row.name == "flow"                         ? "external"
                              : row.name == "tolerance"                    ? "0.5"
                              : row.name == "direction"                    ? "0.5,-1,0"
                              : row.name == "order"                        ? "3"
                                                                           : "7";
    row.set(options, value);
    CHECK(row.show(options) == value);
  }
  Options options;
  CHECK_THROWS_AS(named("tolerance").set(options, "1e-4 "), Error);
  CHECK_THROWS_AS(named("tolerance").set(options, "inf"), Error);
  CHECK_THROWS_AS(named("symmetry").set(options, "x="), Error);
  CHECK_THROWS_AS(named("symmetry").set(options, "x=nan"), Error);
  CHECK_THROWS_AS(named("direction").set(options, "1,0"), Error);
  CHECK_THROWS_AS(named("direction").set(options, "0,0,0"), Error);
  CHECK_THROWS_AS(named("direction").set(options, "1,0,0,0"), Error);
  CHECK_THROWS_AS(named("order").set(options, "5"), Error);
  CHECK_THROWS_AS(named("cage-unit").set(options, ""), Error);
}

TEST_CASE("units") {
  CHECK(metres_per_unit("in") == 0.0254);
  CHECK(metres_per_unit("ft") == 0.3048);
  CHECK_THROWS_AS(metres_per_unit("furlong"), Error);
}

TEST_CASE("docs/options.md is what the table says") {
  // After a change of the table: FLOWCAGE_UPDATE_DOCS=1 test_options
  if (std::getenv("FLOWCAGE_UPDATE_DOCS") != nullptr)
    std::ofstream(FLOWCAGE_OPTIONS_DOCUMENT) << options_markdown();
  std::ifstream file(FLOWCAGE_OPTIONS_DOCUMENT);
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  CHECK(text == options_markdown());
}

TEST_CASE("suggestions") {
  const std::vector<std::string> names{"--levels", "--limit",     "--tolerance",
                                       "--cells",  "--cage-unit", "--cad-unit"};
  CHECK(suggestion("--level", names) == "--levels");
  CHECK(suggestion("--lveels", names) == "--levels");
  CHECK(suggestion("--tol", names) == "--tolerance");
  CHECK(suggestion("--cageunit", names) == "--cage-unit");
  CHECK(suggestion("--colour", names).empty());
  CHECK(suggestion(std::string(10000, 'x'), names).empty());
}
