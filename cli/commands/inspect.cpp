#include <fmt/format.h>

#include "cli/cad_json.hpp"
#include "cli/commands/commands.hpp"
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

std::string row(std::string_view name, const std::string& value) {
  return fmt::format("  {:<14}{}\n", name, value);
}

std::string list(std::string_view title, const std::vector<std::string>& entries, std::size_t most) {
  if (entries.empty()) return "";
  std::string text = fmt::format("{} ({})\n", title, entries.size());
  for (std::size_t i = 0; i < std::min(most, entries.size()); ++i) text += fmt::format("  {}\n", entries[i]);
  if (entries.size() > most)
    text += fmt::format("  ... and {} more (--json has all)\n", entries.size() - most);
  return text;
}

std::string summary_table(const CadSummary& cad) {
  std::string text;
  for (const CadFile& file : cad.files) {
    text += fmt::format("{}\n", file.name);
    text += row("format", file.format);
    const std::string unit = file.unit.empty() ? "none stated" : file.unit;
    text += row("unit", file.unit_in_metres > 0 ? fmt::format("{} (1 is {:g} m)", unit, file.unit_in_metres)
                                                : fmt::format("{} (as the file defines it)", unit));
    text += row("holds", fmt::format("{} solid(s), {} face(s)", file.solids, file.faces));
  }
  const Vec3 size = cad.bounds.sizes();
  text += "model, in metres\n";
  text += row("from", place(cad.bounds.min()));
  text += row("to", place(cad.bounds.max()));
  text += row("size", fmt::format("{:.6g} x {:.6g} x {:.6g}, diagonal {:.6g}", size.x(), size.y(), size.z(),
                                  cad.diagonal));
  text += row("bodies", fmt::format("{} solid(s), {} shell(s), {} of them open", cad.solids, cad.shells,
                                    cad.open_shells));
  std::string kinds;
  for (const NamedCount& kind : cad.faces_by_kind) {
    kinds += fmt::format("{}{} {}", kinds.empty() ? ": " : ", ", kind.count, kind.name);
  }
  text += row("faces", fmt::format("{}{}", cad.faces, kinds));
  text += row("edges", fmt::format("{}, vertices {}", cad.edges, cad.vertices));
  text += row("free edges", cad.sewing_tolerance > 0
                                ? fmt::format("{} after sewing at {:.2g} m, {} before", cad.free_edges,
                                              cad.sewing_tolerance, cad.free_edges_before)
                                : fmt::format("{}", cad.free_edges));
  text += row("sharp edges",
              fmt::format("{} in {} chain(s){}", cad.sharp_edges, cad.sharp_chains,
                          cad.partly_sharp_edges > 0
                              ? fmt::format(", {} sharp on a part of their length", cad.partly_sharp_edges)
                              : ""));
  text += row("open border", fmt::format("{} chain(s)", cad.boundary_chains));
  text += row("corners", fmt::format("{}", cad.corners));
  constexpr std::size_t names_shown = 20, problems_shown = 50;
  text += list("names of solids", cad.solid_names, names_shown);
  text += list("names of faces", cad.face_names, names_shown);
  text += list("problems", cad.warnings, problems_shown);
  return text;
}

}  // namespace

int run_inspect(const Options& options, Progress& progress) {
  const std::unique_ptr<AtomicFile> json = open_json(options);
  CadReadSettings settings;
  settings.cad_unit = options.cad_unit;
  settings.crease_angle_degrees = options.crease_angle;
  WithoutWarnings quiet(progress);
  const CadModel model = read_cad(options.inputs, settings, quiet);
  if (json) {
    Json report = new_report();
    report["cad"] = cad_json(model.summary());
    write_json(report, *json);
    json->commit();
  }
  print(summary_table(model.summary()));
  return 0;
}

}  // namespace flowcage
