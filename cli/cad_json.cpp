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

/// Without triangles there is no box: null.
Json box(const Box3& bounds) {
  if (bounds.isEmpty()) return nullptr;
  return Json::array({numbers(bounds.min()), numbers(bounds.max())});
}

Json counts(const std::vector<NamedCount>& values) {
  Json object = Json::object();
  for (const NamedCount& value : values) object[value.name] = value.count;
  return object;
}

/// Only what the kind has.
Json border_json(const OpenBorder& border) {
  Json json{{"kind", name_of(border.kind)},   {"loop", border.loop},
            {"closed_loop", border.closed},   {"length", border.length},
            {"place", numbers(border.place)}, {"bbox", box(border.bounds)},
            {"chains", border.chains}};
  if (border.kind == BorderKind::gap) json["width"] = border.width;
  if (border.kind == BorderKind::plane || border.kind == BorderKind::hole) {
    json["axis"] = border.axis < 0 ? Json() : Json(std::string(1, "xyz"[border.axis]));
    json["normal"] = numbers(border.normal);
    json["value"] = border.value;
  }
  return json;
}

}  // namespace

Json cad_json(const CadSummary& summary) {
  Json names = Json::array(), sources = Json::array(), borders = Json::array(), overlaps = Json::array();
  for (const CadFile& file : summary.files) {
    names.push_back(file.name);
    sources.push_back({{"file", file.name},
                       {"format", file.format},
                       {"unit", file.unit},
                       {"unit_in_metres", file.unit_in_metres},
                       {"solids", file.solids},
                       {"faces", file.faces},
                       {"diagonal", file.diagonal}});
  }
  for (const OpenBorder& border : summary.borders) borders.push_back(border_json(border));
  for (const CadOverlap& overlap : summary.overlaps) {
    overlaps.push_back({{"bodies", overlap.bodies},
                        {"united", overlap.united},
                        {"split_faces", overlap.split_faces},
                        {"hidden_pieces", overlap.hidden_pieces},
                        {"problem", overlap.problem}});
  }
  return {{"files", names},
          {"unit", unit_symbol(summary)},
          {"faces", summary.faces},
          {"edges", summary.edges},
          {"sharp_edges", summary.sharp_edges},
          {"free_edges", summary.free_edges},
          {"bbox", box(summary.bounds)},
          {"diagonal", summary.diagonal},
          {"warnings", summary.warnings},
          {"sources", sources},
          {"closed", summary.closed()},
          {"solids", summary.solids},
          {"shells", summary.shells},
          {"open_shells", summary.open_shells},
          {"vertices", summary.vertices},
          {"faces_by_kind", counts(summary.faces_by_kind)},
          {"free_edges_before_sewing", summary.free_edges_before},
          {"free_edges_before_splitting", summary.free_edges_sewn},
          {"sewing_tolerance", summary.sewing_tolerance},
          {"partly_sharp_edges", summary.partly_sharp_edges},
          {"edges_of_more_than_two_faces", summary.crowded_edges},
          {"sharp_chains", summary.sharp_chains},
          {"boundary_chains", summary.boundary_chains},
          {"overlaps", overlaps},
          {"intersection_chains", summary.intersection_chains},
          {"corners", summary.corners},
          {"tips", summary.tips},
          {"solid_names", summary.solid_names},
          {"groups", counts(summary.groups)},
          {"parts", counts(summary.parts)},
          {"layers", counts(summary.layers)},
          {"colors", counts(summary.colors)},
          {"faces_left_out", summary.faces_left_out},
          {"open_borders", borders},
          {"bad_faces", summary.bad_faces}};
}

Json faces_json(const CadModel& model) {
  Json faces = Json::array();
  for (Index f = 0; f < model.face_count(); ++f) {
    const CadFace& face = model.face(f);
    faces.push_back({{"number", face.number},
                     {"kind", face.kind},
                     {"group", face.group},
                     {"name", face.name},
                     {"solid", face.solid},
                     {"part", face.part},
                     {"instance", face.instance},
                     {"layer", face.layer},
                     {"color", face.color},
                     {"file", face.file},
                     {"bbox", box(face.bounds)}});
  }
  return faces;
}

}  // namespace flowcage
