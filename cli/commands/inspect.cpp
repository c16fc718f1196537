#include "cli/cad_json.hpp"
#include "cli/cad_report.hpp"
#include "cli/cad_table.hpp"
#include "cli/commands/commands.hpp"
#include "cli/fit_job.hpp"
#include "cli/json_report.hpp"
#include "cli/terminal.hpp"
#include "core/base/atomic_file.hpp"
#include "occ_bridge/cad_model.hpp"

namespace flowcage {
namespace {

/// Warnings are part of what inspect prints; they need not appear on stderr as well.
class WithoutWarnings final : public Progress {
 public:
  explicit WithoutWarnings(Progress& progress) : progress_(progress) {}
  void report(std::string_view stage, double fraction) override { progress_.report(stage, fraction); }
  void warn(std::string_view) override {}
  bool cancelled() const override { return progress_.cancelled(); }

 private:
  Progress& progress_;
};

}  // namespace

int run_inspect(const Options& options, Progress& progress) {
  const std::unique_ptr<AtomicFile> json = open_json(options);
  const std::unique_ptr<AtomicFile> report = open_report(options);
  WithoutWarnings quiet(progress);
  const CadModel model = read_cad(options.inputs, cad_settings(options), quiet);
  if (json) {
    Json facts = new_report();
    facts["cad"] = cad_json(model.summary());
    facts["cad"]["face_list"] = faces_json(model);
    write_json(facts, *json);
  }
  if (report) write_cad_report(report->stream(), options, model);
  if (json) json->commit();
  if (report) report->commit();
  print(cad_table(model));
  return 0;
}

}  // namespace flowcage
