#include "cli/batch_job.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <fstream>
#include <set>
#include <thread>

#include "cli/json_report.hpp"
#include "cli/mesh_outputs.hpp"
#include "core/base/atomic_file.hpp"
#include "core/base/error.hpp"

namespace flowcage {
namespace fs = std::filesystem;
namespace {

/// 64-bit FNV-1a (Fowler, Noll & Vo): enough to see that a file changed.
class Hash {
 public:
  void add(std::string_view bytes) {
    for (const char c : bytes) {
      value_ = (value_ ^ static_cast<unsigned char>(c)) * 0x100000001b3U;
    }
  }
  std::string text() const { return fmt::format("{:016x}", value_); }

 private:
  std::uint64_t value_ = 0xcbf29ce484222325U;
};

/// The bytes of a file; of a folder (a case given as --cage) those of its files. What cannot be read adds its
/// name alone: the run itself will say so.
void add_content(Hash& hash, const fs::path& path) {
  std::vector<fs::path> files{path};
  std::error_code ignored;
  if (fs::is_directory(path, ignored)) {
    files.clear();
    for (const auto& entry : fs::recursive_directory_iterator(path, ignored)) files.push_back(entry.path());
    std::sort(files.begin(), files.end());
  }
  for (const fs::path& file : files) {
    hash.add(file.string());
    std::ifstream in(file, std::ios::binary);
    std::array<char, 65536> buffer{};
    while (in.read(buffer.data(), buffer.size()) || in.gcount() > 0) {
      hash.add({buffer.data(), static_cast<std::size_t>(in.gcount())});
    }
  }
}

/// Options that belong to the batch or change nothing in the mesh.
bool is_of_batch(const OptionSpec& row) {
  static const std::set<std::string> names{"out-dir",  "format", "jobs",  "json",        "report",
                                           "pictures", "config", "quiet", "save-config", "threads"};
  return names.count(row.name) != 0;
}

std::vector<std::string> mesh_arguments(const Options& options) {
  std::vector<std::string> arguments;
  const Options defaults;
  for (const OptionSpec& row : option_table()) {
    if (!row.belongs_to(Command::mesh) || is_of_batch(row)) continue;
    const std::string value = row.show(options);
    if (value == row.show(defaults)) continue;
    if (row.is_flag()) {
      arguments.push_back((value == "true" ? "--" : "--no-") + row.name);
    } else if (row.repeatable) {
      for (const std::string& item : row.values(options))
        arguments.push_back(fmt::format("--{}={}", row.name, item));
    } else {
      arguments.push_back(fmt::format("--{}={}", row.name, value));
    }
  }
  return arguments;
}

}  // namespace

std::vector<BatchJob> batch_jobs(const Options& options) {
  const bool plain =
      std::ranges::all_of(options.format, [](unsigned char c) { return std::isalnum(c) != 0; });
  if (!plain) {
    throw Error(ErrorKind::usage, fmt::format("--format: \"{}\" is no ending", options.format),
                "give vtu, vtm, cgns, msh, su2, xyz or foam");
  }
  MeshOutputs::check_formats({"x." + options.format});
  const fs::path folder = options.out_dir;
  Hash of_all;
  of_all.add(
      fmt::format("{} {} {}", FLOWCAGE_VERSION, options.format, fmt::join(mesh_arguments(options), "\n")));
  if (options.cage != "auto") add_content(of_all, options.cage);
  if (!options.outer.empty()) add_content(of_all, options.outer);

  std::vector<BatchJob> jobs;
  for (const std::string& input : options.inputs) {
    const std::string name = fs::path(input).stem().string();
    if (name.empty() || name == "." || name == "..") {
      throw Error(ErrorKind::usage,
                  fmt::format("{}: an output of this name would leave {}", input, options.out_dir),
                  "rename the file");
    }
    const auto same = std::ranges::find_if(
        jobs, [&](const BatchJob& job) { return fs::path(job.input).stem().string() == name; });
    if (same != jobs.end()) {
      throw Error(
          ErrorKind::usage,
          fmt::format("{} and {} would have the same output in {}", same->input, input, options.out_dir),
          "rename one of them, or give them different folders in two runs");
    }
    BatchJob job;
    job.input = input;
    job.output = options.format == "foam" ? folder / name / "" : folder / (name + "." + options.format);
    job.record = folder / fmt::format(".{}.{}.flowcage.json", name, options.format);
    Hash hash;
    add_content(hash, input);
    job.key = of_all.text() + hash.text();
    jobs.push_back(std::move(job));
  }
  return jobs;
}

std::vector<std::string> child_arguments(const Options& options, const BatchJob& job, const fs::path& json) {
  std::vector<std::string> arguments{"mesh",   "--quiet",     fmt::format("--output={}", job.output.string()),
                                     "--json", json.string(), "--threads"};
  const int cores = options.threads > 0 ? options.threads
                                        : static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  arguments.push_back(fmt::format("{}", std::max(1, cores / options.jobs)));
  for (std::string& argument : mesh_arguments(options)) arguments.push_back(std::move(argument));
  arguments.insert(arguments.end(), {"--", job.input});  // whatever the name begins with
  return arguments;
}

bool is_finished(const BatchJob& job) {
  std::error_code ignored;
  if (!fs::exists(job.output, ignored)) return false;
  std::ifstream in(job.record);
  const Json record = Json::parse(in, nullptr, false);
  return record.is_object() && record.value("key", "") == job.key;
}

void write_record(const BatchJob& job) {
  AtomicFile file(job.record);
  file.stream() << Json{{"input", job.input}, {"key", job.key}}.dump() << '\n';
  file.commit();
}

}  // namespace flowcage
