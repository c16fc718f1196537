#pragma once
#include <chrono>

namespace flowcage {

/// Wall-clock seconds since it was made. For reports only: no result may depend on it.
class Stopwatch {
 public:
  double seconds() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point start_ = Clock::now();
};

}  // namespace flowcage
