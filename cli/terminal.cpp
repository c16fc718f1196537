#include "cli/terminal.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <system_error>

namespace flowcage {
namespace {

double seconds(std::chrono::steady_clock::duration d) {
  return std::chrono::duration<double>(d).count();
}

void put(const std::string& text) {
  std::fwrite(text.data(), 1, text.size(), stderr);
  std::fflush(stderr);
}

}  // namespace

void print(const std::string& text) {
  const bool failed =
      std::fwrite(text.data(), 1, text.size(), stdout) != text.size() || std::fflush(stdout) != 0;
  if (failed) {
    throw Error(ErrorKind::output,
                fmt::format("standard output: cannot write: {}", std::generic_category().message(errno)),
                "check where the output goes");
  }
}

void print_summary(const std::string& text) {
  if (isatty(STDERR_FILENO) != 0) std::fputs("\r\033[K", stderr);
  std::fputs(text.c_str(), stderr);
}

void print_error(const Error& error) {
  std::string text = fmt::format("flowcage: {}\n", error.what());
  if (!error.remedy().empty()) text += fmt::format("  {}\n", error.remedy());
  put(text);
}

TerminalProgress::TerminalProgress(const Interruption& interruption, bool quiet)
    : interruption_(interruption), quiet_(quiet), terminal_(::isatty(STDERR_FILENO) == 1) {}

TerminalProgress::~TerminalProgress() {
  end_stage();
}

void TerminalProgress::report(std::string_view stage, double fraction) {
  if (quiet_) return;
  const std::scoped_lock lock(mutex_);
  const Clock::time_point now = Clock::now();
  if (stage != stage_) {
    end_stage();
    stage_ = stage;
    stage_start_ = now;
    last_shown_ = {};
  }
  constexpr auto interval = std::chrono::milliseconds(100);
  if (!terminal_ || now - last_shown_ < interval) return;
  last_shown_ = now;
  line_shown_ = true;
  fraction = std::clamp(fraction, 0.0, 1.0);
  std::string left;
  const double elapsed = seconds(now - stage_start_);
  if (fraction > 0.02 && elapsed > 1) left = fmt::format(", {:.0f} s left", elapsed / fraction - elapsed);
  put(fmt::format("\r\033[K{:3.0f} % {}{}", 100 * fraction, stage_, left));
}

void TerminalProgress::warn(std::string_view message) {
  if (quiet_) return;
  const std::scoped_lock lock(mutex_);
  clear_line();
  put(fmt::format("flowcage: warning: {}\n", message));
}

void TerminalProgress::end_stage() {
  clear_line();
  // Short stages are not worth a line, and an error that comes at once stands on the first.
  const double elapsed = stage_.empty() ? 0 : seconds(Clock::now() - stage_start_);
  if (elapsed >= 0.5 && !quiet_) put(fmt::format("{} ({:.1f} s)\n", stage_, elapsed));
  stage_.clear();
}

void TerminalProgress::clear_line() {
  if (line_shown_) put("\r\033[K");
  line_shown_ = false;
}

}  // namespace flowcage
