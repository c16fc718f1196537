#pragma once
#include <functional>
#include <vector>

#include "core/blocks/block_draft.hpp"

namespace flowcage {

/// A layer of hexes put round a set of hexes.
struct Pillow {
  BlockDraft draft;
  /// For each point of the new draft beyond those of the old: the old point that it was split from. The old
  /// point stays outside of the set (on the wall), the new one is the set's.
  std::vector<Index> split_from;
  std::vector<Index> layer_hexes;  ///< the new hexes, one a quad of the set's surface
};

/// Puts one layer of hexes ("pillow", a closed sheet of the dual) between a set of hexes and what lies
/// outside of it, so that no hex of the set touches that surface any more (Mitchell, Tautges 1995).
///
/// The surface is every quad between a hex of the set and one that is not in it, and those boundary quads of
/// the set that `covers` accepts. Where the surface ends at the boundary, the layer ends there, too, and its
/// side belongs to the patch of the boundary quad beside it. Used for the O-grid round a body (the set is all
/// hexes, `covers` accepts walls), rings round regions, and wake columns (the set is all but the column).
///
/// New points lie at `depth` of the way from the old point to the mean of its neighbours inside the set.
/// Precondition: in_set has #hexes entries; the surface is a manifold, with its rim on the boundary
/// (Error(internal) with the place otherwise).
Pillow pillow(const BlockDraft& draft, const std::vector<char>& in_set,
              const std::function<bool(const BoundaryQuad&)>& covers, double depth = 0.3);

}  // namespace flowcage
