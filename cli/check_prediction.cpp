#include "cli/check_prediction.hpp"

#include <fmt/format.h>
#include <sys/stat.h>
#include <sys/statvfs.h>

#include <filesystem>
#include <map>

#include "cli/mesh_outputs.hpp"
#include "cli/terminal.hpp"

namespace flowcage {
namespace fs = std::filesystem;
namespace {

double disk_bytes(const Prediction& prediction, const Options& options) {
  double sum = 0;
  for (const std::string& name : options.outputs) {
    sum += MeshOutputs::predicted_bytes(name, prediction.cells, options.unstructured);
  }
  return sum;
}

/// The nearest folder above an output that exists; empty for what takes no space on a disk (a pipe, a
/// device).
fs::path folder_of_output(const std::string& name) {
  std::error_code ignored;
  fs::path path = fs::absolute(name, ignored);
  const fs::file_status status = fs::status(path, ignored);
  if (fs::exists(status) && !fs::is_regular_file(status) && !fs::is_directory(status)) return {};
  while (!fs::is_directory(path, ignored) && path.has_parent_path() && path != path.parent_path()) {
    path = path.parent_path();
  }
  return path;
}

std::string bytes_text(double bytes) {
  return bytes < 1e9 ? fmt::format("{:.3g} MB", bytes / 1e6) : fmt::format("{:.3g} GB", bytes / 1e9);
}

}  // namespace

void check_prediction(const Prediction& prediction, const Options& options) {
  if (!options.quiet) {
    print_summary(fmt::format("{} {:.3g} cells, {} of memory, {} on the disk\n",
                              prediction.at_most ? "at most" : "about", prediction.cells,
                              bytes_text(prediction.memory_bytes()),
                              bytes_text(disk_bytes(prediction, options))));
  }
  if (prediction.at_most) return;
  std::map<dev_t, double> needed;  // by file system: older outputs stay until the new ones are whole
  for (const std::string& name : options.outputs) {
    const fs::path folder = folder_of_output(name);
    struct stat at {};
    struct statvfs system {};
    if (folder.empty() || ::stat(folder.c_str(), &at) != 0 || ::statvfs(folder.c_str(), &system) != 0)
      continue;
    double& bytes = needed[at.st_dev];
    bytes += MeshOutputs::predicted_bytes(name, prediction.cells, options.unstructured);
    const double free = static_cast<double>(system.f_bavail) * static_cast<double>(system.f_frsize);
    if (bytes <= free) continue;
    throw Error(ErrorKind::usage,
                fmt::format("-o: {}: about {:.3g} cells take {}, and {} has {} left", name, prediction.cells,
                            bytes_text(bytes), folder.string(), bytes_text(free)),
                "free space on the disk, choose another folder with -o, or ask for fewer cells");
  }
}

Json prediction_json(const Prediction& prediction, const Options& options) {
  return {{"levels", prediction.levels},
          {"at_most", prediction.at_most},
          {"cells", prediction.cells},
          {"memory_bytes", prediction.memory_bytes()},
          {"disk_bytes", disk_bytes(prediction, options)}};
}

}  // namespace flowcage
