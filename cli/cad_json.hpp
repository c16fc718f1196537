#pragma once
#include <nlohmann/json.hpp>

#include "occ_bridge/cad_model.hpp"

namespace flowcage {

/// The "cad" object of the JSON reports. Lengths in metres. `unit` is that of the first file, `files` are
/// their names; what only `inspect` shows follows behind the keys that all reports have.
nlohmann::ordered_json cad_json(const CadSummary& summary);

}  // namespace flowcage
