#pragma once
#include <nlohmann/json.hpp>

#include "occ_bridge/cad_model.hpp"

namespace flowcage {

/// The "cad" object of the JSON reports. Lengths in metres. `unit` is that of the first file, `files` are
/// their names; what is no part of the contract follows behind the keys that all reports have.
nlohmann::ordered_json cad_json(const CadSummary& summary);

/// What `inspect` adds to it: every face with all that is known of it.
nlohmann::ordered_json faces_json(const CadModel& model);

}  // namespace flowcage
