#include <BinTools.hxx>
#include <cstring>
#include <nlohmann/json.hpp>
#include <sstream>

#include "occ_bridge/internal/prepared_model.hpp"

namespace flowcage {

// CBOR, not JSON text: names in files need not be valid UTF-8.
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(CadFile, name, format, unit, unit_in_metres, solids, faces, diagonal)
// Kind and bounds are found on the other side.
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(CadFace, number, name, solid, part, instance, layer, color, file, group)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(CadOverlap, bodies, united, split_faces, hidden_pieces, problem)

namespace occ {

std::string bytes_of(const PreparedModel& model) {
  const CadSummary& summary = model.summary;
  const nlohmann::json facts{{"metres", model.metres},
                             {"deflection", model.deflection},
                             {"labels", model.labels},
                             {"bodies", model.bodies},
                             {"overlaps", summary.overlaps},
                             {"files", summary.files},
                             {"unit", summary.unit},
                             {"free_edges_before", summary.free_edges_before},
                             {"free_edges_sewn", summary.free_edges_sewn},
                             {"faces_left_out", summary.faces_left_out},
                             {"bad_faces", summary.bad_faces},
                             {"sewing_tolerance", summary.sewing_tolerance},
                             {"solid_names", summary.solid_names},
                             {"warnings", summary.warnings}};
  const std::vector<std::uint8_t> packed = nlohmann::json::to_cbor(facts);
  const std::uint64_t size = packed.size();
  std::ostringstream out(std::ios::binary);
  out.write(reinterpret_cast<const char*>(&size), sizeof size);
  out.write(reinterpret_cast<const char*>(packed.data()), static_cast<std::streamsize>(size));
  BinTools::Write(model.shape, out);
  return std::move(out).str();
}

PreparedModel prepared_from(const std::string& bytes) {
  std::uint64_t size = 0;
  std::memcpy(&size, bytes.data(), sizeof size);
  const auto* start = reinterpret_cast<const std::uint8_t*>(bytes.data()) + sizeof size;
  const nlohmann::json facts = nlohmann::json::from_cbor(start, start + size);
  PreparedModel model;
  model.metres = facts["metres"];
  model.deflection = facts["deflection"];
  model.labels = facts["labels"].get<std::vector<CadFace>>();
  model.bodies = facts["bodies"].get<std::vector<Index>>();
  model.summary.overlaps = facts["overlaps"].get<std::vector<CadOverlap>>();
  model.summary.files = facts["files"].get<std::vector<CadFile>>();
  model.summary.unit = facts["unit"];
  model.summary.free_edges_before = facts["free_edges_before"];
  model.summary.free_edges_sewn = facts["free_edges_sewn"];
  model.summary.faces_left_out = facts["faces_left_out"];
  model.summary.bad_faces = facts["bad_faces"].get<std::vector<Index>>();
  model.summary.sewing_tolerance = facts["sewing_tolerance"];
  model.summary.solid_names = facts["solid_names"].get<std::vector<std::string>>();
  model.summary.warnings = facts["warnings"].get<std::vector<std::string>>();
  std::istringstream in(bytes.substr(sizeof size + size), std::ios::binary);
  BinTools::Read(model.shape, in);
  return model;
}

}  // namespace occ
}  // namespace flowcage
