#pragma once
#include "core/base/progress.hpp"
#include "core/options.hpp"

namespace flowcage {

/// `mesh --out-dir DIR --jobs N --format EXT`: each input by a process of its own, N at once, so that one
/// that crashes is one failed line. The output of wing.step is DIR/wing.EXT, with EXT foam the case folder
/// DIR/wing. stdout gets one line of JSON a file, in the order in which they end:
///   {"input", "output", "status": "done|failed|skipped", "exit_code", "seconds", "message"}
/// and of a mesh that was made "cells", "min_scaled_jacobian" and "max_deviation"; of a crash "signal".
/// Resumable: beside an output that is done a record DIR/.NAME.flowcage.json holds the options and a hash of
/// every input; where both are as before and the output is there, the file is skipped.
/// Returns 0 if none failed, else the exit code of the first input (in the given order) that did; 70 for a
/// crash. Throws Error(usage) for names that clash or would leave DIR, Error(output) where DIR cannot be
/// made, Error(interrupted) after the children have ended.
int run_batch(const Options& options, Progress& progress);

}  // namespace flowcage
