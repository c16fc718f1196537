#pragma once
#include <atomic>
#include <thread>

namespace flowcage {

/// Turns Ctrl-C, SIGTERM and SIGHUP into a request to stop, which Progress::cancelled passes to core. What
/// does not stop within two seconds, or at a second signal, ends the process with 130 after its unfinished
/// outputs were removed. Construct one, first in main, before any other thread: it blocks the signals for all
/// of them.
class Interruption {
 public:
  Interruption();
  ~Interruption();
  Interruption(const Interruption&) = delete;
  Interruption& operator=(const Interruption&) = delete;

  bool requested() const { return requested_; }

 private:
  void watch();

  std::atomic<bool> requested_{false};
  std::atomic<bool> over_{false};
  std::thread watcher_;
};

}  // namespace flowcage
