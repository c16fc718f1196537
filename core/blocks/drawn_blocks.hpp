#pragma once
#include <string>

#include "core/blocks/block_draft.hpp"
#include "core/blocks/cage_of_blocks.hpp"
#include "core/mesh/hex_view.hpp"

namespace flowcage {

/// A user's hex blocks, sorted out.
struct DrawnBlocks {
  BlockDraft draft;                        ///< patch: into `patches`
  std::vector<HexComplex::Patch> patches;  ///< of the file, in its order
  WallCage wall;                           ///< its quads, with the names of their patches
  std::vector<SharpEdge> sharp;            ///< edges of the boundary off the wall that stay sharp
  bool pillowed = false;                   ///< a layer of blocks was put round the wall
};

/// Each cell of `mesh` becomes a block, its boundary patches say what is fitted to the CAD: those of type
/// wall. Where the file has only walls and its boundary is in several parts, the part with the largest
/// bounding box is the far field (external flow). A body is held by one wall face of each block: blocks with
/// two get a layer round the wall (blocks/pillow). Boundary edges off the wall stay sharp where patches meet
/// or their quads turn by more than 60 degrees.
/// Faces of the wall are counter-clockwise seen from the fluid. Throws Error(input), naming `source`: for a
/// mesh of more than 200,000 cells (it is no block mesh), for one without wall, or a wall as its only part
/// in external flow.
DrawnBlocks sort_out_blocks(const HexView& mesh, bool internal, const std::string& source);

}  // namespace flowcage
