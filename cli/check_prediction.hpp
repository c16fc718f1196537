#pragma once
#include "cli/json_report.hpp"
#include "core/options.hpp"
#include "core/prediction.hpp"

namespace flowcage {

/// Says on stderr (not with --quiet) what a mesh job will make and what that takes of memory and disk. Throws
/// Error(usage) where the file system of an output has less space than its mesh needs; not for a bound that a
/// tolerance may keep the job below.
void check_prediction(const Prediction& prediction, const Options& options);

/// The same for --json.
Json prediction_json(const Prediction& prediction, const Options& options);

}  // namespace flowcage
