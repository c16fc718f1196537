#pragma once
#include <vector>

#include "core/mesh/block_mesh.hpp"

namespace flowcage {

/// Every second point of a block mesh along each axis: the same blocks with half the divisions.
struct CoarsenedBlocks {
  BlockMesh mesh;
  std::vector<Index> fine_point;  ///< #points of `mesh`: each one's number in the fine mesh, same bits
};

/// Precondition: every chord of `fine` has an even number of divisions. Types of patches are kept.
CoarsenedBlocks coarsen_blocks(const BlockMesh& fine);

}  // namespace flowcage
