#include "cli/cad_report.hpp"

#include <fmt/format.h>

#include <array>

#include "cli/cad_json.hpp"
#include "cli/cad_table.hpp"
#include "cli/report/report_page.hpp"

namespace flowcage {
namespace {

/// By BorderKind: what is likely meant is blue, what to mend red, orange and violet.
constexpr std::array<Rgb, 4> border_colors{
    {{0.12, 0.44, 0.82}, {0.88, 0, 0}, {0.88, 0.48, 0}, {0.54, 0.17, 0.89}}};

SceneMark mark_of(const OpenBorder& border, const FeatureGraph& features) {
  SceneMark mark{fmt::format("{:.4g} m: {}", border.length, border_text(border)), border.place,
                 border_colors[static_cast<std::size_t>(border.kind)]};
  for (const Index chain : border.chains) mark.lines.push_back(features.chains[chain].polyline);
  return mark;
}

}  // namespace

void write_cad_report(std::ostream& out, const Options& options, const CadModel& model) {
  Scene scene = cad_scene(model);
  for (const OpenBorder& border : model.summary().borders) {
    scene.marks.push_back(mark_of(border, model.features()));
  }
  Json facts = new_report();
  facts["cad"] = cad_json(model.summary());
  facts["cad"]["face_list"] = faces_json(model);
  facts["table"] = cad_table(model);
  write_report_page(
      out, {.command = "inspect", .options = options, .warnings = model.summary().warnings, .facts = facts},
      scene);
}

}  // namespace flowcage
