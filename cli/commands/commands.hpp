#pragma once
#include "core/base/progress.hpp"
#include "core/options.hpp"
#include "core/quality/quality_report.hpp"

namespace flowcage {

/// One function a command, in a file of its name. Each returns the exit code 0 or 4 (a gate is missed) and
/// throws Error otherwise.
int run_subdivide(const Options& options, Progress& progress);
int run_inspect(const Options& options, Progress& progress);
int run_quality(const Options& options, Progress& progress);
int run_surface(const Options& options, Progress& progress);
int run_cage(const Options& options, Progress& progress);
int run_mesh(const Options& options, Progress& progress);
int run_convert(const Options& options, Progress& progress);

/// The quality table as text for stdout.
std::string quality_text(const QualityReport& report);

}  // namespace flowcage
