#pragma once
#include <ostream>
#include <string>
#include <vector>

#include "core/base/progress.hpp"
#include "core/mesh/hex_view.hpp"

namespace flowcage {

/// Writes a Gmsh mesh, ASCII, format 4.1: patch i is surface i + 1 with the physical group i + 1 of the
/// patch's name, the hexes are volume 1 with the physical group "volume" behind those of the patches. A point
/// belongs to the first patch that has it, inner points to the volume. Nodes are numbered in the order of the
/// file, by these entities, because gmshToFoam takes them so whatever their numbers are; elements are the
/// quads (outward) and then the hexes, which keep their order. Numbers read back as the same bits. The format
/// has no types of patches. Returns notes for the user: patches renamed by legal_patch_names. Throws
/// Error(output) through the stream.
std::vector<std::string> write_gmsh(std::ostream& out, const HexView& mesh, Progress* progress = nullptr);

}  // namespace flowcage
