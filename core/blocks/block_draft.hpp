#pragma once
#include <vector>

#include "core/mesh/hex_complex.hpp"

namespace flowcage {

/// Hexes with a marked boundary, while blocks are being made: what mesh/hex_complex checks and numbers once
/// they are done. Every face of one hex alone is in `boundary` once, counter-clockwise seen from outside of
/// the fluid; what `patch` numbers is the maker's matter.
struct BlockDraft {
  std::vector<Vec3> points;
  std::vector<HexPoints> hexes;  ///< VTK order, right-handed
  std::vector<BoundaryQuad> boundary;
};

}  // namespace flowcage
