#include "cli/json_report.hpp"

#include <ostream>

namespace flowcage {
namespace {

Json worst_json(const MetricSummary& metric) {
  Json list = Json::array();
  for (const WorstCell& w : metric.worst) {
    list.push_back({{"value", w.value}, {"cell", w.cell}, {"block", w.block}, {"place", json_of(w.place)}});
  }
  return list;
}

Json histogram_json(const Histogram& histogram) {
  return {{"low", histogram.low}, {"high", histogram.high}, {"counts", histogram.counts}};
}

}  // namespace

Json json_of(const Vec3& p) {
  return Json::array({p.x(), p.y(), p.z()});
}

Json new_report() {
  return {{"flowcage", FLOWCAGE_VERSION}};
}

Json volume_json(const QualityReport& report) {
  Json json;
  json["cells"] = report.cells;
  json["points"] = report.points;
  json["blocks"] = report.blocks;
  json["inverted_cells"] = report.inverted_cells;
  json["min_scaled_jacobian"] = report.scaled_jacobian.min;
  json["mean_scaled_jacobian"] = report.scaled_jacobian.mean;
  json["max_non_orthogonality"] = report.non_orthogonality.max;
  json["mean_non_orthogonality"] = report.non_orthogonality.mean;
  json["max_skewness"] = report.skewness.max;
  json["max_aspect_ratio"] = report.aspect_ratio.max;
  json["min_volume"] = report.min_volume;
  json["total_volume"] = report.total_volume;
  json["check_mesh_failures"] = check_mesh_failures(report);
  json["worst"] = {{"scaled_jacobian", worst_json(report.scaled_jacobian)},
                   {"non_orthogonality", worst_json(report.non_orthogonality)},
                   {"skewness", worst_json(report.skewness)},
                   {"aspect_ratio", worst_json(report.aspect_ratio)}};
  json["histograms"] = {{"scaled_jacobian", histogram_json(report.scaled_jacobian.histogram)},
                        {"non_orthogonality", histogram_json(report.non_orthogonality.histogram)},
                        {"skewness", histogram_json(report.skewness.histogram)}};
  return json;
}

const char* patch_type_name(PatchType type) {
  switch (type) {
    case PatchType::wall:
      return "wall";
    case PatchType::farfield:
      return "farfield";
    case PatchType::symmetry:
      return "symmetry";
    case PatchType::inlet:
      return "inlet";
    case PatchType::outlet:
      return "outlet";
  }
  return "wall";
}

Json patches_json(const HexView& mesh) {
  Json list = Json::array();
  for (const BoundaryPatch& patch : mesh.patches()) {
    list.push_back(
        {{"name", patch.name}, {"type", patch_type_name(patch.type)}, {"faces", patch.quads.size()}});
  }
  return list;
}

std::unique_ptr<AtomicFile> open_json(const Options& options) {
  return options.json.empty() ? nullptr : std::make_unique<AtomicFile>(options.json);
}

std::unique_ptr<AtomicFile> open_report(const Options& options) {
  return options.report.empty() ? nullptr : std::make_unique<AtomicFile>(options.report);
}

void write_json(const Json& json, AtomicFile& file) {
  file.stream() << json.dump(2, ' ', false, Json::error_handler_t::replace) << '\n' << std::flush;
}

}  // namespace flowcage
