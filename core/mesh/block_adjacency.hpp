#pragma once
#include <array>
#include <span>
#include <vector>

#include "core/mesh/block_mesh.hpp"

namespace flowcage {

/// What lies across the six faces of a cell, in the order of hex_faces: a cell, or `~q` (negative) for
/// boundary quad q, counted through all patches in their order.
using CellNeighbours = std::array<Index, 6>;

/// The neighbours of a block mesh's cells in closed form. Inside of a block they are one step along an axis
/// away. Across a block's face they run, as that face's two lattice coordinates do, with constant strides:
/// through the block at its other side, or through the boundary quads of that face, so that three numbers a
/// block face say all. Nothing is stored a cell. Keeps no reference to the mesh.
class BlockAdjacency {
 public:
  /// Precondition: the complex is one that build_hex_complex made (each block face is in two blocks, or in
  /// one block and one patch).
  explicit BlockAdjacency(const BlockMesh& mesh);

  /// Of cells [begin, begin + out.size()). Thread-safe.
  void read_across(Offset begin, std::span<CellNeighbours> out) const;

 private:
  /// Across the cell at (a,b), the face's lattice axes in ascending order: base + a along_a + b along_b.
  struct Link {
    Index base = 0, along_a = 0, along_b = 0;
    Index at(Index a, Index b) const { return base + a * along_a + b * along_b; }
  };
  struct Block {
    Offset begin = 0;
    std::array<Index, 3> dims{};
    std::array<Link, 6> links;
  };
  static Link link_to_block(const BlockMesh& mesh, std::array<Index, 2> from, std::array<Index, 2> to);

  std::vector<Block> blocks_;
  Offset cells_ = 0;
};

}  // namespace flowcage
