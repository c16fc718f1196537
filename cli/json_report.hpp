#pragma once
#include <memory>
#include <nlohmann/json.hpp>

#include "core/base/atomic_file.hpp"
#include "core/mesh/hex_view.hpp"
#include "core/options.hpp"
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

/// The file of --json, opened before long work so that a place that cannot be written shows at once; none
/// without the option. Throws Error(output).
std::unique_ptr<AtomicFile> open_json(const Options& options);

/// The same for --report.
std::unique_ptr<AtomicFile> open_report(const Options& options);

/// Writes all of it; the caller commits. Numbers that are not finite become null, bytes that are no UTF-8
/// are replaced. Throws Error(output).
void write_json(const Json& json, AtomicFile& file);

}  // namespace flowcage
