#pragma once
#include <array>
#include <vector>

#include "core/mesh/block_mesh.hpp"

namespace flowcage {

/// How a box of blocks sees one of its coarse blocks: axis d of the box is axis[d] of the block, backward
/// where `reversed`.
struct BlockPlacement {
  Index block = no_index;
  std::array<int, 3> axis{0, 1, 2};
  std::array<bool, 3> reversed{};
};

/// A logical box of coarse blocks: one block of a structured format. Right-handed, as the coarse blocks are.
struct StructuredBlock {
  std::array<Index, 3> coarse{1, 1, 1};        ///< coarse blocks along each axis
  std::vector<BlockPlacement> blocks;          ///< of each place, i fastest
  std::array<std::vector<Index>, 3> starts{};  ///< first cell of each place along an axis, and the end
  std::array<Index, 3> cells() const { return {starts[0].back(), starts[1].back(), starts[2].back()}; }
};

/// A rectangle of points on a face of a structured block, `low` to `high` (inclusive; equal along the face's
/// axis), which is a part of a patch or joins a block.
struct BlockWindow {
  Index block = 0;  ///< in StructuredBlocks::blocks
  int face = 0;     ///< order of hex_faces
  std::array<Index, 3> low{}, high{};
  Index patch = no_index;                          ///< or no_index: an interface
  Index donor = no_index;                          ///< the block across an interface; may be the same
  std::array<Index, 3> donor_low{}, donor_high{};  ///< where `low` and `high` lie in it
  std::array<int, 3> transform{};  ///< CGNS's Transform: +-(1 + axis of the donor) for each axis
};

struct StructuredBlocks {
  std::vector<StructuredBlock> blocks;
  std::vector<BlockWindow> windows;  ///< every outer quad in one; every inner quad of two faces in two, which
                                     ///< follow each other and are each other's opposite
};

struct MergeSettings {
  /// Up to so many coarse blocks a box may start at any block, and the largest comes first; above, a box
  /// starts at the lowest block that is left, which takes time in proportion to the blocks.
  Index any_start_up_to = 200;
};

/// Merges neighbouring coarse blocks, greedily, into boxes: a box grows by whole slabs, along its axes in
/// each order, and the largest (by cells) is taken; then the same with the blocks that are left. No box can
/// then be joined with a neighbour as it stands. Deterministic. A box may touch itself (an O-grid does).
StructuredBlocks merge_blocks(const BlockMesh& mesh, const MergeSettings& settings = {});

/// The number of a structured block's point, 0 <= i <= cells()[0] and so on.
Index point_number(const BlockMesh& mesh, const StructuredBlock& block, const std::array<Index, 3>& ijk);

/// The number of a structured block's cell, 0 <= i < cells()[0] and so on.
Offset cell_number(const BlockMesh& mesh, const StructuredBlock& block, const std::array<Index, 3>& ijk);

/// The block mesh of a mesh that knows no blocks: each cell is one; points and patches stay. Throws
/// Error(input) as build_hex_complex.
BlockMesh blocks_of_cells(const HexView& mesh);

}  // namespace flowcage
