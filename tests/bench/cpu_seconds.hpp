// What the programs under tests/bench measure their cost with.
#pragma once
#include <ctime>

namespace flowcage::test {

/// CPU time of this process so far, all threads, seconds.
inline double cpu_seconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

}  // namespace flowcage::test
