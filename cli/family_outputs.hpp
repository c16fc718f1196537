#pragma once
#include <string>
#include <vector>

#include "core/options.hpp"

namespace flowcage {

/// The outputs (-o) of each mesh of a --family, coarsest first: wing.vtu becomes wing_1.vtu, wing_2.vtu, ...;
/// a folder case/ becomes case_1, case_2, ...; dir/x.foam becomes dir_1/x.foam, dir_2/x.foam, ... One row,
/// the outputs as they are, where no family is asked for. Throws Error(usage) for a .foam file without a
/// folder in its name: the case is the folder.
std::vector<std::vector<std::string>> family_outputs(const Options& options);

}  // namespace flowcage
