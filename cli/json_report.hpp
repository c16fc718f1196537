#pragma once
#include <nlohmann/json.hpp>
#include <string>

#include "core/mesh/hex_view.hpp"
#include "core/quality/quality_report.hpp"

namespace flowcage {

/// Keys keep the order in which they were added.
using Json = nlohmann::ordered_json;

/// {"flowcage": VERSION}, the beginning of every report.
Json new_report();

/// [x, y, z].
Json json_of(const Vec3& p);

/// The contract's "volume", without what only the maker of a mesh knows; and lists of the worst cells.
Json volume_json(const QualityReport& report);

/// The contract's "patches" of a mesh file.
Json patches_json(const HexView& mesh);

const char* patch_type_name(PatchType type);

/// Writes to a file, whole or not at all. Numbers that are not finite become null, bytes that are no UTF-8
/// are replaced. Throws Error(output).
void write_json(const Json& json, const std::string& file);

}  // namespace flowcage
