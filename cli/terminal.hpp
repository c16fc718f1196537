#pragma once
#include <chrono>
#include <mutex>
#include <string>

#include "cli/interruption.hpp"
#include "core/base/progress.hpp"

namespace flowcage {

/// Writes to stdout; throws Error(output) where that fails (a full disk, a closed pipe).
void print(const std::string& text);

/// A summary for a person, on stderr: stdout carries only what was asked for. Takes a progress line away.
void print_summary(const std::string& text);

/// An error as the user sees it on stderr: what and where on the first line, then the remedy.
void print_error(const Error& error);

/// Progress on stderr: on a terminal one line that changes (stage, part done, time left), otherwise one line
/// a stage; nothing with `quiet`. Safe to call from several threads.
class TerminalProgress final : public Progress {
 public:
  TerminalProgress(const Interruption& interruption, bool quiet);
  ~TerminalProgress() override;

  void report(std::string_view stage, double fraction) override;
  void warn(std::string_view message) override;
  bool cancelled() const override { return interruption_.requested(); }

 private:
  using Clock = std::chrono::steady_clock;
  void end_stage();
  void clear_line();

  const Interruption& interruption_;
  const bool quiet_, terminal_;
  std::mutex mutex_;
  std::string stage_;
  Clock::time_point stage_start_, last_shown_;
  bool line_shown_ = false;
};

}  // namespace flowcage
