#pragma once
#include <vector>

#include "core/mesh/hex_adjacency.hpp"

namespace flowcage {

/// A face between two cells, owner < neighbour; its points are counter-clockwise seen from the neighbour, so
/// the normal goes from owner to neighbour.
struct InternalFace {
  std::array<Index, 4> points{};
  Index owner = no_index, neighbour = no_index;
};

/// The inner faces that cells [begin, end) own, in OpenFOAM's upper-triangular order: by owner, then by
/// neighbour. `faces` is overwritten. Consecutive ranges of cells give all inner faces in order, so a writer
/// never holds them.
void read_internal_faces(const HexView& mesh, const HexAdjacency& adjacency, Offset begin, Offset end,
                         std::vector<InternalFace>& faces);

}  // namespace flowcage
