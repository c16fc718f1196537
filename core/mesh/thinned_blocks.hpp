#pragma once
#include <span>
#include <vector>

#include "core/mesh/block_mesh.hpp"

namespace flowcage {

/// A block mesh of the same blocks with fewer divisions: its points are points of the finer mesh, so it shows
/// the same lines, only fewer of them. For pictures of meshes that are too large to be shown whole.
struct ThinnedBlocks {
  BlockMesh mesh;            ///< patches and their types as the finer mesh has them
  std::vector<Index> point;  ///< #points of mesh: their numbers in the finer mesh
  Index stride = 1;          ///< a cell covers up to so many finer ones in each direction
};

/// The least stride that leaves at most `most_cells` cells (one cell a block, if those are more). A chord of
/// d divisions keeps about d / stride of them, evenly spread and the same from both ends, so that blocks fit.
ThinnedBlocks thin_blocks(const BlockMesh& fine, Offset most_cells);

/// #cells of thinned.mesh: the least of the finer cells that each covers. `values`: #cells of fine.
std::vector<float> least_of_covered(const BlockMesh& fine, const ThinnedBlocks& thinned,
                                    std::span<const float> values);

}  // namespace flowcage
