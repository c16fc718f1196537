#pragma once
#include <mutex>
#include <string>
#include <vector>

#include "core/base/progress.hpp"

namespace flowcage {

/// Passes everything on and keeps the warnings, for a report.
class RecordedWarnings final : public Progress {
 public:
  explicit RecordedWarnings(Progress& progress) : progress_(progress) {}
  void report(std::string_view stage, double fraction) override { progress_.report(stage, fraction); }
  void warn(std::string_view message) override {
    progress_.warn(message);
    const std::scoped_lock lock(mutex_);
    messages_.emplace_back(message);
  }
  bool cancelled() const override { return progress_.cancelled(); }
  const std::vector<std::string>& messages() const { return messages_; }

 private:
  Progress& progress_;
  std::mutex mutex_;
  std::vector<std::string> messages_;
};

}  // namespace flowcage
