#pragma once
#include <ostream>

#include "occ_bridge/cad_model.hpp"

namespace flowcage {

/// The report of `inspect`: one HTML page without scripts or other files. Pictures of the tessellation from
/// three sides, faces coloured by patch name, open borders by their kind with numbers that a table explains;
/// the problems (faces without triangles by number and place) and what `inspect` prints. Whatever a file
/// calls its parts stays text.
void write_cad_report(std::ostream& out, const CadModel& model);

}  // namespace flowcage
