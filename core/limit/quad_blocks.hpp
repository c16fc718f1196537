#pragma once
#include <cstdint>
#include <optional>
#include <vector>

#include "core/mesh/surface_level.hpp"

namespace flowcage {

/// A rectangular array of quads over which the limit surface is smooth: count_u x count_v of them, (i,j) at
/// faces[i + count_u * j]. `turns` says how each lies in it: the corner number of the face that is the
/// array's lower left one there, so corner turn + 1 lies one step along u, corner turn + 3 one step along v.
/// u x v points to the side from which faces are counter-clockwise.
struct QuadBlock {
  Index count_u = 0, count_v = 0;
  std::vector<Index> faces;
  std::vector<std::uint8_t> turns;
  Index patch = 0;  ///< face_patch of all its quads
};

/// By corner of each face (positions of face_vertices.values): whether the limit surface over the face is no
/// plain bicubic there, that is next to an extraordinary vertex, a dart, or an irregular sector of a crease
/// or corner (limit_masks.hpp, is_regular). Mirrored edges are inner ones.
std::vector<char> irregular_corners(const SurfaceLevel& level);

/// Cuts a level into few rectangular blocks. Their borders are creases, open boundaries, borders of patches,
/// and lines that go straight from irregular vertices until they meet another border: the motorcycle graph of
/// the quad mesh (Eppstein, Goodrich, Kim & Tamstorf, "Motorcycle graphs: canonical quad mesh partitioning",
/// SGP 2008), with T-junctions. Then blocks that share a whole side that is no feature are joined, longest
/// sides first. Closed strips and tori are cut where the numbering is lowest. An irregular corner of a face
/// is a corner of its block, and no block meets itself along an edge (no seams, which CAD readers stumble
/// over). Precondition: quads only. No value if the level is too coarse for that: refine it once more.
std::optional<std::vector<QuadBlock>> partition_into_blocks(const SurfaceLevel& level);

}  // namespace flowcage
