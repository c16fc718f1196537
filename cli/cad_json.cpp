#include "cli/cad_json.hpp"

#include <array>
#include <cmath>
#include <string>
#include <utility>

namespace flowcage {

using Json = nlohmann::ordered_json;

namespace {

Json numbers(const Vec3& p) {
  return Json::array({p.x(), p.y(), p.z()});
}

/// "mm" where the file says "millimetre"; other units as the file calls them.
std::string unit_symbol(const CadSummary& summary) {
  static constexpr std::array units{std::pair{1.0, "m"}, std::pair{1e-3, "mm"}, std::pair{1e-2, "cm"},
                                    std::pair{0.0254, "in"}, std::pair{0.3048, "ft"}};
  const double metres = summary.files.empty() ? 0 : summary.files.front().unit_in_metres;
  for (const auto& [length, symbol] : units) {
    if (std::abs(metres - length) < 1e-9 * length) return symbol;
  }
  return summary.unit;
}

}  // namespace

Json cad_json(const CadSummary& summary) {
  Json names = Json::array(), sources = Json::array(), kinds = Json::object();
  for (const CadFile& file : summary.files) {
    names.push_back(file.name);
    sources.push_back({{"file", file.name},
                       {"format", file.format},
                       {"unit", file.unit},
                       {"unit_in_metres", file.unit_in_metres},
                       {"solids", file.solids},
                       {"faces", file.faces}});
  }
  for (const NamedCount& kind : summary.faces_by_kind) kinds[kind.name] = kind.count;
  return {{"files", names},
          {"unit", unit_symbol(summary)},
          {"faces", summary.faces},
          {"edges", summary.edges},
          {"sharp_edges", summary.sharp_edges},
          {"free_edges", summary.free_edges},
          {"bbox", Json::array({numbers(summary.bounds.min()), numbers(summary.bounds.max())})},
          {"diagonal", summary.diagonal},
          {"warnings", summary.warnings},
          {"sources", sources},
          {"closed", summary.closed()},
          {"solids", summary.solids},
          {"shells", summary.shells},
          {"open_shells", summary.open_shells},
          {"vertices", summary.vertices},
          {"faces_by_kind", kinds},
          {"free_edges_before_sewing", summary.free_edges_before},
          {"sewing_tolerance", summary.sewing_tolerance},
          {"partly_sharp_edges", summary.partly_sharp_edges},
          {"edges_of_more_than_two_faces", summary.crowded_edges},
          {"sharp_chains", summary.sharp_chains},
          {"boundary_chains", summary.boundary_chains},
          {"corners", summary.corners},
          {"solid_names", summary.solid_names},
          {"face_names", summary.face_names}};
}

}  // namespace flowcage
