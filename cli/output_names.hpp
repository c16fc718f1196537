#pragma once
#include <string>

#include "core/options.hpp"

namespace flowcage {

/// Refuses names of outputs (-o, --json, --report, --pictures) that are empty, appear twice or are an input
/// of the same run: one file would silently replace the other. Only `subdivide` may replace its own cage.
/// Throws Error(usage).
void check_output_names(Command command, const Options& options);

}  // namespace flowcage
