#pragma once
#include <span>
#include <vector>

#include "core/blocks/block_draft.hpp"
#include "core/mesh/cage.hpp"

namespace flowcage {

/// The wall of a draft as a cage.
struct WallCage {
  Cage cage;                         ///< points, faces; no patches, no creases
  std::vector<Index> vertex_corner;  ///< #V: point of the draft
  std::vector<Index> face_boundary;  ///< #F: boundary quad of the draft
};

/// The boundary quads that `is_wall` (#boundary) marks, in their order. Faces are turned against the boundary
/// quads (which are outward of the fluid) where `fluid_side`: counter-clockwise seen from the fluid.
WallCage cage_of_blocks(const BlockDraft& draft, std::span<const char> is_wall, bool fluid_side);

}  // namespace flowcage
