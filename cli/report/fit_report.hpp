#pragma once
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cli/report/recorded_warnings.hpp"
#include "cli/report/report_page.hpp"
#include "core/base/atomic_file.hpp"

namespace flowcage {

/// --report and --pictures of mesh and surface: opened before the work, shown after it, whether gates hold or
/// not.
class FitReport {
 public:
  /// Opens what the options ask for. Throws Error(output).
  explicit FitReport(const Options& options);
  bool wanted() const { return page_ || pictures_; }

  /// Writes both. `facts`: what --json writes. Throws Error(output).
  void write(const ReportText& text, const Scene& scene, const std::vector<Gate>& gates, Progress& progress);
  void commit();

 private:
  std::unique_ptr<AtomicFile> page_;
  std::unique_ptr<AtomicFolder> pictures_;
};

}  // namespace flowcage
