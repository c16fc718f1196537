#pragma once
#include "core/blocks/ambient_frame.hpp"
#include "core/blocks/ambient_grid.hpp"
#include "core/blocks/cage_of_blocks.hpp"

namespace flowcage {

/// Numbers a finished draft: result.complex, vertex_corner and face_quad, from result.cage (patches, creases
/// and corners) and the wall it was made of. Boundary quads off the wall: patch 1 + number of the frame's
/// side. Sharp are the cage's creases, the borders of walls and the box's edges; between walls of different
/// names the surface is as smooth as the cage says.
void assemble_blocks(BlockDraft draft, const AmbientFrame& frame, AmbientBlocks& result,
                     const WallCage& wall);

/// The same for a draft whose boundary quads have their patch in `patches` already; `sharp`: edges of the
/// boundary off the wall.
void assemble_blocks(BlockDraft draft, std::vector<HexComplex::Patch> patches, std::vector<SharpEdge> sharp,
                     AmbientBlocks& result, const WallCage& wall);

}  // namespace flowcage
