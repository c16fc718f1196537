#include <fmt/format.h>

#include <iterator>

#include "cli/commands/commands.hpp"
#include "cli/json_report.hpp"
#include "cli/terminal.hpp"
#include "core/export/read_mesh.hpp"
#include "core/mesh/hex_adjacency.hpp"
#include "core/quality/quality_report.hpp"

namespace flowcage {
namespace {

void append_worst(std::string& text, const char* title, const MetricSummary& metric) {
  fmt::format_to(std::back_inserter(text), "\nworst by {}\n", title);
  for (const WorstCell& w : metric.worst) {
    fmt::format_to(std::back_inserter(text), "  {:>12.6g}  cell {:<10} at {}\n", w.value, w.cell,
                   place(w.place));
  }
}

}  // namespace

std::string quality_text(const QualityReport& report) {
  std::string text = fmt::format(
      "cells     {}\npoints    {}\nblocks    {}\ninverted  {}\nvolume    {:.6g} (cubed units of the "
      "mesh)\n\n",
      report.cells, report.points, report.blocks, report.inverted_cells, report.total_volume);
  auto out = std::back_inserter(text);
  fmt::format_to(out, "{:<28}{:>12}{:>12}{:>12}\n", "", "min", "mean", "max");
  const auto row = [&](const char* name, const MetricSummary& m) {
    fmt::format_to(out, "{:<28}{:>12.5g}{:>12.5g}{:>12.5g}\n", name, m.min, m.mean, m.max);
  };
  row("scaled Jacobian", report.scaled_jacobian);
  row("non-orthogonality (degrees)", report.non_orthogonality);
  row("skewness", report.skewness);
  row("aspect ratio", report.aspect_ratio);
  const std::vector<std::string> failures = check_mesh_failures(report);
  fmt::format_to(out, "\ncheckMesh  {}\n", failures.empty() ? "Mesh OK" : "fails:");
  for (const std::string& failure : failures) fmt::format_to(out, "  {}\n", failure);
  return text;
}

int run_quality(const Options& options, Progress& progress) {
  const std::unique_ptr<AtomicFile> json_file = open_json(options);
  progress.step("read", 0);
  const HexMesh mesh = read_mesh(options.inputs.front());
  progress.step("faces", 0);
  const HexAdjacency adjacency = build_hex_adjacency(mesh);
  const QualityReport report = measure_quality(mesh, adjacency, {}, &progress);

  std::string text = quality_text(report);
  text += "\npatches\n";
  for (const BoundaryPatch& patch : mesh.patches()) {
    fmt::format_to(std::back_inserter(text), "  {:<32} {:<9} {:>10} faces\n", patch.name,
                   patch_type_name(patch.type), patch.quads.size());
  }
  append_worst(text, "scaled Jacobian", report.scaled_jacobian);
  append_worst(text, "non-orthogonality", report.non_orthogonality);
  append_worst(text, "skewness", report.skewness);
  append_worst(text, "aspect ratio", report.aspect_ratio);
  if (json_file) {
    Json json = new_report();
    json["mesh"] = options.inputs.front();
    json["volume"] = volume_json(report);
    json["patches"] = patches_json(mesh);
    write_json(json, *json_file);
    json_file->commit();
  }
  print(text);
  return 0;
}

}  // namespace flowcage
