#pragma once
#include <limits>
#include <memory>
#include <vector>

#include "core/mesh/block_adjacency.hpp"
#include "core/mesh/visit_cells.hpp"

namespace flowcage {

/// What lies across each face of each cell of a hex mesh.
///
/// Face f (order of hex_faces) of cell c: the neighbouring cell, or `~q` (negative) where the face is
/// boundary quad q, counted through all patches in their order. Of a BlockMesh nothing is stored: blocks tell
/// their cells' neighbours in closed form. Of another mesh: 24 bytes a cell; building it takes at most about
/// 130 MB more, plus 4 bytes a point.
struct HexAdjacency {
  std::vector<Index> across;                     ///< 6 #cells; empty where `blocks` tells
  std::shared_ptr<const BlockAdjacency> blocks;  ///< of a BlockMesh
  std::vector<Index> boundary_owner;             ///< #boundary quads: the cell that carries it
  Offset internal_faces = 0;

  Offset boundary_faces() const { return static_cast<Offset>(boundary_owner.size()); }
  /// What lies across the faces of cells [begin, begin + out.size()). Thread-safe.
  void read_across(Offset begin, std::span<CellNeighbours> out) const;
};

/// `across` of a face that neither a second cell nor a boundary quad covers (only in FaceMatching).
inline constexpr Index uncovered_face = std::numeric_limits<Index>::min();

/// As HexAdjacency, for a mesh whose boundary may be incomplete.
struct FaceMatching {
  HexAdjacency adjacency;
  std::vector<Offset> uncovered;  ///< 6 c + f of each face without a second cell or quad, ascending
};

/// Pairs faces by their points. Throws Error(input) naming the place for a point number out of range, a face
/// of more than two cells, a boundary quad of no cell, of two cells, or listed twice, more cells than 32-bit
/// face numbers can hold.
FaceMatching match_faces(const HexView& mesh);

/// As match_faces, and throws Error(input) if a face is uncovered. Of a BlockMesh in closed form.
HexAdjacency build_hex_adjacency(const HexView& mesh);

/// As visit_cells, for visit(cell, points, neighbours).
template <typename Visit>
void visit_neighbours(const HexView& mesh, const HexAdjacency& adjacency, Offset begin, Offset end,
                      const Visit& visit) {
  constexpr Offset batch = 256;
  std::array<HexPoints, batch> cells;
  std::array<CellNeighbours, batch> across;
  for (Offset c = begin; c < end; c += batch) {
    const auto n = static_cast<std::size_t>(std::min(batch, end - c));
    mesh.read_cells(c, {cells.data(), n});
    adjacency.read_across(c, {across.data(), n});
    for (std::size_t i = 0; i < n; ++i) visit(c + static_cast<Offset>(i), cells[i], across[i]);
  }
}

}  // namespace flowcage
