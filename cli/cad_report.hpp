#pragma once
#include <ostream>

#include "core/options.hpp"
#include "occ_bridge/cad_model.hpp"

namespace flowcage {

/// The report of `inspect`: the page of report/report_page.hpp with the CAD alone. Faces coloured by patch
/// name, open borders marked by their kind with numbers, the problems with the places that they name, what
/// `inspect` prints, and of each face that is clicked its number, as --include and --exclude take it.
void write_cad_report(std::ostream& out, const Options& options, const CadModel& model);

}  // namespace flowcage
