#pragma once
#include <ostream>
#include <string>
#include <vector>

#include "core/base/progress.hpp"
#include "core/export/structured_blocks.hpp"

namespace flowcage {

/// Writes a Plot3D grid: formatted, whole, multi-block, no IBLANK; of each block all x, then y, then z, i
/// fastest. Numbers read back as the same bits. The format has neither patches nor interfaces: see
/// write_neutral_map. Throws Error(output) through the stream.
void write_plot3d(std::ostream& out, const BlockMesh& mesh, const StructuredBlocks& blocks,
                  Progress* progress = nullptr);

/// Writes the neutral map file (NASA GeoLab's .nmf) of the same blocks: their sizes, each rectangle of a
/// patch (WALL, FARFIELD, SYMMETRY, INFLOW, OUTFLOW; a comment line above has the patch's name), and each
/// interface once (ONE-TO-ONE). Faces are numbered k-min, k-max, i-min, i-max, j-min, j-max = 1 to 6, their
/// ranges are in the cyclic order of the axes (i j, j k, k i). Returns notes for the user: patches renamed by
/// legal_patch_names.
std::vector<std::string> write_neutral_map(std::ostream& out, const BlockMesh& mesh,
                                           const StructuredBlocks& blocks);

}  // namespace flowcage
