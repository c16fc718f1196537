#pragma once
#include <limits>
#include <vector>

#include "core/mesh/hex_view.hpp"

namespace flowcage {

/// What lies across each face of each cell of a hex mesh.
///
/// across[6 c + f] belongs to face f (order of hex_faces) of cell c: the neighbouring cell, or `~q`
/// (negative) where the face is boundary quad q, counted through all patches in their order. Memory: 24 bytes
/// a cell; building it takes at most about 130 MB more, plus 4 bytes a point.
struct HexAdjacency {
  std::vector<Index> across;          ///< 6 #cells
  std::vector<Index> boundary_owner;  ///< #boundary quads: the cell that carries it
  Offset internal_faces = 0;

  Offset boundary_faces() const { return static_cast<Offset>(boundary_owner.size()); }
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

/// As match_faces, and throws Error(input) if a face is uncovered.
HexAdjacency build_hex_adjacency(const HexView& mesh);

}  // namespace flowcage
