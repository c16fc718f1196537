#pragma once
#include <functional>
#include <string>

#include "core/base/progress.hpp"

namespace flowcage::occ {

struct IsolationSettings {
  std::string file;            ///< what errors name
  std::string stage;           ///< what progress shows
  double limit_seconds = 300;  ///< of the child's processor time; tenfold on the clock
};

/// Runs `work` in a child process and returns the bytes that it returned. OpenCASCADE ends the process on
/// many damaged files (a missing reference is a null pointer to it) and never returns on some: that costs the
/// child alone. Throws what `work` threw as an Error, and Error(input) naming the file where the child died
/// or passed the time limit; Error(interrupted) soon after progress.cancelled().
///
/// `work` sees a copy of this process with this one thread: it must not use parallel loops, and what it
/// prints is lost.
std::string run_isolated(const std::function<std::string()>& work, const IsolationSettings& settings,
                         Progress& progress);

}  // namespace flowcage::occ
