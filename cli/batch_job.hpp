#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "core/options.hpp"

namespace flowcage {

/// One input of a batch (cli/batch).
struct BatchJob {
  std::string input;
  std::filesystem::path output;  ///< as -o takes it
  std::filesystem::path record;  ///< what a finished one leaves for the next run
  std::string key;               ///< of options and inputs; changes with any of them
};

/// The jobs, in the order of the inputs. Throws Error(usage) for two inputs of one name, a name that would
/// leave --out-dir, or an ending that is no mesh format.
std::vector<BatchJob> batch_jobs(const Options& options);

/// The options of `mesh` as arguments for one input, without those of the batch; `json` gets the figures.
std::vector<std::string> child_arguments(const Options& options, const BatchJob& job,
                                         const std::filesystem::path& json);

/// Whether an earlier run finished this job: same key, and the output is there.
bool is_finished(const BatchJob& job);
/// Leaves the record of a finished job.
void write_record(const BatchJob& job);

}  // namespace flowcage
