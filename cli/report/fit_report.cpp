#include "cli/report/fit_report.hpp"

#include "cli/report/pictures.hpp"

namespace flowcage {

FitReport::FitReport(const Options& options) : page_(open_report(options)) {
  if (options.pictures.empty()) return;
  pictures_ = std::make_unique<AtomicFolder>(options.pictures, "", picture_names());
}

void FitReport::write(const ReportText& text, const Scene& scene, const std::vector<Gate>& gates,
                      Progress& progress) {
  progress.step("report", 0);
  if (page_) write_report_page(page_->stream(), text, scene);
  if (pictures_) write_pictures(*pictures_, scene, gates);
}

void FitReport::commit() {
  if (page_) page_->commit();
  if (pictures_) pictures_->commit();
}

}  // namespace flowcage
