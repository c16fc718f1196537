#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/blocks/block_draft.hpp"

namespace flowcage {

/// A rectilinear grid whose cells are body or fluid. Cells and nodes are numbered with the first axis
/// fastest.
struct VoxelGrid {
  std::array<std::vector<double>, 3> lines;  ///< ascending, at least two an axis
  std::vector<std::uint8_t> body;            ///< #cells, 1 inside of the body

  Index cells(int axis) const { return static_cast<Index>(lines[axis].size()) - 1; }
  Index nodes(int axis) const { return static_cast<Index>(lines[axis].size()); }
  Index cell_count() const { return cells(0) * cells(1) * cells(2); }
  Index node_count() const { return nodes(0) * nodes(1) * nodes(2); }
  Index cell(const std::array<Index, 3>& at) const { return at[0] + cells(0) * (at[1] + cells(1) * at[2]); }
  Index node(const std::array<Index, 3>& at) const { return at[0] + nodes(0) * (at[1] + nodes(1) * at[2]); }
  std::array<Index, 3> cell_at(Index cell) const {
    return {cell % cells(0), cell / cells(0) % cells(1), cell / (cells(0) * cells(1))};
  }
  Vec3 point(const std::array<Index, 3>& at) const {
    return {lines[0][at[0]], lines[1][at[1]], lines[2][at[2]]};
  }
};

/// Nodes where the boundary between body and fluid is no manifold: among the (up to eight) cells round the
/// node the body's, or the fluid's, do not hang together through faces. Ascending.
std::vector<Index> non_manifold_nodes(const VoxelGrid& grid);

/// Turns single cells from body to fluid or back until the boundary is a manifold; `fraction` (#cells) is how
/// much of each cell lies in the body, and cells near one half turn first. Returns how many were turned.
/// Nodes that stay bad are those of non_manifold_nodes afterwards.
Index repair_manifold(VoxelGrid& grid, std::span<const double> fraction);

/// Number of the connected part (through faces) that each cell of one kind (body 1 or fluid 0) belongs to, in
/// the order of their first cells; no_index for cells of the other kind.
struct VoxelParts {
  std::vector<Index> part;  ///< #cells
  Index count = 0;
};
VoxelParts voxel_parts(const VoxelGrid& grid, std::uint8_t kind);

/// The cells of one kind as hexes. Boundary quads: `patch` 0 where the cell across is of the other kind,
/// 1 + 2 axis (+ 1) on the grid's lower (upper) side across an axis. Points are the grid's nodes that are
/// used, in their order; `node` (filled) numbers them in the grid.
BlockDraft draft_of_voxels(const VoxelGrid& grid, std::uint8_t kind, std::vector<Index>& node);

}  // namespace flowcage
