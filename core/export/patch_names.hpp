#pragma once
#include <string>
#include <vector>

#include "core/mesh/hex_view.hpp"

namespace flowcage {

/// Patch names that every format takes: letters, digits, '_', '-', '.'; the first is a letter; at most 32
/// characters (CGNS); no two alike. A name that is legal and not yet taken stays; in others each further
/// character becomes '_', "patch_" goes before a first character that is no letter, and a repeated name gets
/// "_2", "_3", ... Deterministic, so that all formats of one run carry the same names.
struct PatchNames {
  std::vector<std::string> names;  ///< same order as given
  std::vector<std::string> notes;  ///< one sentence for each renamed patch
};
PatchNames legal_patch_names(const std::vector<std::string>& names);
/// Those of a mesh's patches.
PatchNames legal_patch_names(const HexView& mesh);

/// The type that a name suggests, for files that have names alone: farfield, symmetry, inlet or outlet if the
/// name contains "far", "sym", "inlet" or "inflow", "outlet" or "outflow" (capitals or not), else wall.
PatchType foreign_patch_type(const std::string& name);

}  // namespace flowcage
