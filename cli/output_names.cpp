#include "cli/output_names.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <utility>
#include <vector>

#include "cli/family_outputs.hpp"
#include "core/base/error.hpp"
#include "core/export/file_text.hpp"
#include "core/export/write_vtm.hpp"

namespace flowcage {
namespace fs = std::filesystem;
namespace {

/// An option or argument, and the file that it names.
using Named = std::pair<std::string, std::string>;

/// The same place by any spelling. Devices and pipes are no place: they may be given twice.
bool same_file(const std::string& a, const std::string& b) {
  std::error_code failure;
  const fs::file_status status = fs::status(a, failure);
  if (fs::exists(status) && !fs::is_regular_file(status) && !fs::is_directory(status)) return false;
  const fs::path one = fs::weakly_canonical(fs::absolute(a, failure), failure);
  const fs::path other = fs::weakly_canonical(fs::absolute(b, failure), failure);
  return !failure && one == other;
}

}  // namespace

void check_output_names(Command command, const Options& options) {
  std::vector<Named> inputs, outputs;
  for (const std::string& name : options.inputs) inputs.emplace_back("the input", name);
  if (options.cage != "auto") inputs.emplace_back("--cage", options.cage);
  if (!options.outer.empty()) inputs.emplace_back("--outer", options.outer);
  if (!options.config.empty()) inputs.emplace_back("--config", options.config);
  std::vector<std::string> written;
  for (const std::vector<std::string>& member : family_outputs(options)) {
    written.insert(written.end(), member.begin(), member.end());
  }
  for (const std::string& name : written) outputs.emplace_back("-o", name);
  for (const std::string& name : written) {  // what stands beside a Plot3D grid and a VTM file
    const std::string extension = lower_extension(name);
    if (extension == ".xyz" || extension == ".p3d") {
      outputs.emplace_back("the map file of -o " + name, fs::path(name).replace_extension(".nmf").string());
    } else if (extension == ".vtm") {
      outputs.emplace_back("the folder of -o " + name, vtm_folder(name).string());
    }
  }
  if (!options.report.empty()) outputs.emplace_back("--report", options.report);
  if (!options.pictures.empty()) outputs.emplace_back("--pictures", options.pictures);
  if (!options.json.empty()) outputs.emplace_back("--json", options.json);
  if (!options.save_config.empty()) outputs.emplace_back("--save-config", options.save_config);
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    const auto& [option, name] = outputs[i];
    if (name.empty()) {
      throw Error(ErrorKind::usage, fmt::format("{}: the name is empty", option), "give the name of a file");
    }
    const auto clash = [&, &option = option, &name = name](const Named& other) {
      if (!same_file(name, other.second)) return;
      throw Error(ErrorKind::usage,
                  fmt::format("{} {}: the same file as {} {}", option, name, other.first, other.second),
                  "give the output a name of its own");
    };
    std::for_each_n(outputs.begin(), i, clash);
    if (command != Command::subdivide) std::for_each(inputs.begin(), inputs.end(), clash);
  }
}

}  // namespace flowcage
