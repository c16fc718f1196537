#pragma once
#include <span>

#include "core/blocks/swept_blocks.hpp"
#include "core/mesh/block_mesh.hpp"

namespace flowcage {

/// The block mesh before any refinement: `layers` cells on each outward chord, on straight lines, the first
/// two cells `wall_cell` of the chord's mean length and growing geometrically; `level_points` are the control
/// points of the cage's level 1.
BlockMesh start_swept_volume(const SweptBlocks& blocks, std::span<const Vec3> level_points, Index layers);

}  // namespace flowcage
