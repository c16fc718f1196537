// The rules of docs/architecture.md that a machine can hold.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <sstream>

#include "tests/catch.hpp"

namespace fs = std::filesystem;

namespace {

struct SourceFile {
  std::string path;  // from the root, with '/'
  std::vector<std::string> lines;
};

std::vector<SourceFile> sources(const std::vector<std::string>& folders) {
  const fs::path root = FLOWCAGE_SOURCE_DIR;
  std::vector<SourceFile> files;
  for (const std::string& folder : folders) {
    for (const auto& entry : fs::recursive_directory_iterator(root / folder)) {
      if (entry.path().extension() != ".hpp" && entry.path().extension() != ".cpp") continue;
      SourceFile file{fs::relative(entry.path(), root).generic_string(), {}};
      std::ifstream in(entry.path());
      for (std::string line; std::getline(in, line);) file.lines.push_back(line);
      files.push_back(std::move(file));
    }
  }
  std::sort(files.begin(), files.end(), [](const auto& a, const auto& b) { return a.path < b.path; });
  REQUIRE(files.size() > 5);
  return files;
}

const std::vector<std::string> all_folders{"core", "occ_bridge", "cli", "examples", "tests"};

/// What a line includes; empty if nothing.
std::string included(const std::string& line) {
  static const std::regex pattern(R"(^\s*#\s*include\s*[<"]([^>"]+)[>"])");
  std::smatch match;
  return std::regex_search(line, match, pattern) ? match[1].str() : std::string();
}

bool is_occ_header(const std::string& name) {
  // OpenCASCADE's headers: Package_Class.hxx, all in one folder, some without an underscore.
  return name.ends_with(".hxx") || name.ends_with(".lxx") || name.starts_with("opencascade/");
}

/// The broken lines, for a readable failure.
template <typename Broken>
std::string violations(const std::vector<std::string>& folders, const Broken& broken) {
  std::ostringstream text;
  for (const SourceFile& file : sources(folders)) {
    for (std::size_t i = 0; i < file.lines.size(); ++i) {
      const std::string why = broken(file.path, file.lines[i]);
      if (!why.empty()) text << file.path << ':' << i + 1 << ": " << why << '\n';
    }
  }
  return text.str();
}

}  // namespace

TEST_CASE("OpenCASCADE is included in occ_bridge alone, and in none of its public headers") {
  CHECK(violations(all_folders, [](const std::string& path, const std::string& line) -> std::string {
          if (!is_occ_header(included(line))) return {};
          const bool in_bridge = path.starts_with("occ_bridge/") || path.starts_with("tests/occ_bridge/") ||
                                 path.starts_with("tests/bench/");
          const bool public_header = fs::path(path).parent_path() == "occ_bridge" && path.ends_with(".hpp");
          return in_bridge && !public_header ? "" : "includes " + included(line);
        }) == "");
  // Nor through a header of occ_bridge/internal.
  CHECK(violations(all_folders, [](const std::string& path, const std::string& line) -> std::string {
          if (!included(line).starts_with("occ_bridge/internal/")) return {};
          const bool in_bridge = path.starts_with("occ_bridge/") || path.starts_with("tests/occ_bridge/") ||
                                 path.starts_with("tests/bench/");
          const bool public_header = fs::path(path).parent_path() == "occ_bridge" && path.ends_with(".hpp");
          return in_bridge && !public_header ? "" : "includes " + included(line);
        }) == "");
}

TEST_CASE("a folder of core includes only itself and earlier ones") {
  const std::vector<std::string> order{"base",    "mesh",     "target", "cage",   "subdivide",
                                       "limit",   "project",  "refit",  "blocks", "volume",
                                       "quality", "optimise", "grade",  "curve",  "export"};
  const auto rank = [&](const std::string& path) -> std::ptrdiff_t {
    const std::string inside = path.substr(std::string("core/").size());
    const std::size_t slash = inside.find('/');
    if (slash == std::string::npos) return static_cast<std::ptrdiff_t>(order.size());  // options, pipeline
    const auto found = std::find(order.begin(), order.end(), inside.substr(0, slash));
    return found == order.end() ? -1 : found - order.begin();
  };
  CHECK(violations({"core"}, [&](const std::string& path, const std::string& line) -> std::string {
          if (rank(path) < 0) return "a folder that the order does not name";
          const std::string name = included(line);
          if (name.starts_with("occ_bridge/") || name.starts_with("cli/") || name.starts_with("tests/")) {
            return "core includes " + name;
          }
          if (!name.starts_with("core/")) return {};
          return rank(name) <= rank(path) ? "" : "includes the later " + name;
        }) == "");
}

TEST_CASE("project headers are included by their path from the root") {
  CHECK(violations(all_folders, [](const std::string&, const std::string& line) -> std::string {
          static const std::regex quotes(R"(^\s*#\s*include\s*"([^"]+)\")");
          std::smatch match;
          if (!std::regex_search(line, match, quotes)) return {};
          return fs::exists(fs::path(FLOWCAGE_SOURCE_DIR) / match[1].str())
                     ? ""
                     : "no such file: " + match[1].str();
        }) == "");
}

TEST_CASE("core does not print, and nothing uses OpenMP") {
  CHECK(
      violations({"core"}, [](const std::string&, const std::string& line) -> std::string {
        static const std::regex printing(
            R"(std::(cout|cerr|clog)\b|(^|[^\w.])(std::)?(f?printf|puts|putchar|fputs)\s*\(|fmt::print\s*\(|#\s*include\s*<(iostream|print)>)");
        return std::regex_search(line, printing) ? "prints: " + line : "";
      }) == "");
  CHECK(violations(all_folders, [](const std::string&, const std::string& line) -> std::string {
          static const std::regex openmp(R"(^\s*#\s*pragma\s+omp)");
          return std::regex_search(line, openmp) ? "OpenMP" : "";
        }) == "");
}

TEST_CASE("files stay readable: at most 700 lines") {
  for (const SourceFile& file : sources(all_folders)) {
    INFO(file.path);
    CHECK(file.lines.size() <= 700);
  }
}
