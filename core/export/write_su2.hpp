#pragma once
#include <ostream>
#include <string>
#include <vector>

#include "core/base/progress.hpp"
#include "core/mesh/hex_view.hpp"

namespace flowcage {

/// Writes a mesh of SU2 (its native ASCII format): the hexes (VTK type 12), the points, and one marker per
/// patch with its quads (type 9, outward). Numbers are 0-based and read back as the same bits. The format has
/// no types of patches: SU2's configuration file gives them (MARKER_FAR, MARKER_SYM, ...).
/// Returns notes for the user: patches renamed by legal_patch_names. Throws Error(output) through the stream.
std::vector<std::string> write_su2(std::ostream& out, const HexView& mesh, Progress* progress = nullptr);

}  // namespace flowcage
