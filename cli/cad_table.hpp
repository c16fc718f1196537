#pragma once
#include <string>

#include "occ_bridge/cad_model.hpp"

namespace flowcage {

/// What `flowcage inspect` prints: files, model, what the faces can be chosen by, open borders, problems.
std::string cad_table(const CadModel& model);

/// "symmetry plane, waterline or open end in y = 0": what an open border most likely is, for a person.
std::string border_text(const OpenBorder& border);

}  // namespace flowcage
