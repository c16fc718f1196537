#pragma once
#include <span>
#include <vector>

#include "core/mesh/surface_level.hpp"
#include "core/project/crease_chains.hpp"

namespace flowcage {

/// Two segments of crease chains that lie opposite each other across a strip of quads (the base of a blunt
/// trailing edge).
struct OppositeSegments {
  Index chain_a = no_index, segment_a = 0;
  Index chain_b = no_index, segment_b = 0;
  bool against = false;  ///< the chains run in opposite directions
};

/// All pairs whose strip is at most five quads wide, each once. Pairs across wide strips are among them: what
/// is narrow is to be judged by lengths.
std::vector<OppositeSegments> opposite_segments(const SurfaceLevel& level,
                                                std::span<const CreaseChain> chains);

}  // namespace flowcage
