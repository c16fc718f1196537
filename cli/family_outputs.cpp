#include "cli/family_outputs.hpp"

#include <fmt/format.h>

#include <filesystem>

#include "cli/output_names.hpp"
#include "core/base/error.hpp"
#include "core/export/file_text.hpp"

namespace flowcage {
namespace fs = std::filesystem;
namespace {

std::string member_name(const std::string& output, int member) {
  fs::path path(output);
  if (!path.has_filename()) path = path.parent_path();  // a folder with / at its end
  const std::string suffix = fmt::format("_{}", member);
  if (lower_extension(output) == ".foam") {
    if (!path.has_parent_path()) {
      throw Error(ErrorKind::usage,
                  fmt::format("-o: {}: each mesh of a --family needs a case folder of its own", output),
                  "name the .foam file in a folder, CASE/" + output);
    }
    return (fs::path(path.parent_path().string() + suffix) / path.filename()).string();
  }
  const std::string name = path.stem().string() + suffix + path.extension().string();
  return (path.parent_path() / name).string();
}

}  // namespace

std::vector<std::vector<std::string>> family_outputs(const Options& options) {
  if (options.family == 1) return {options.outputs};
  std::vector<std::vector<std::string>> out(options.family);
  for (int member = 0; member < options.family; ++member) {
    for (const std::string& name : options.outputs) out[member].push_back(member_name(name, member + 1));
  }
  return out;
}

}  // namespace flowcage
