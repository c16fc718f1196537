#pragma once
#include <string>
#include <vector>

#include "occ_bridge/internal/fuse_pieces.hpp"

namespace flowcage::occ {

/// Which pieces a flow around the group of bodies sees.
struct OuterSkin {
  std::vector<TopoDS_Face> faces;    ///< on the side that is outside
  std::vector<TopoDS_Face> origins;  ///< the face that each is a part of
  Index hidden = 0;                  ///< pieces left out
  double doubtful = 0;               ///< area of pieces that are partly hidden, over that of all
};

/// A piece is hidden where the space on both of its sides is inside of a body: inside of another one, or
/// between two that touch. Decided by winding numbers (above one half is inside) just off the triangles of
/// the pieces, which meet exactly along the curves that they share. Open rims of a body are closed by a fan
/// first, so that it holds for bodies with gaps and open ends, too.
/// Triangles of one piece that disagree make it doubtful: a curve was missed. The larger area decides then.
/// Preconditions: pieces triangulated together; closed[i]: whether body i of the group is closed.
OuterSkin outer_skin(const std::vector<Piece>& pieces, const std::vector<bool>& closed);

}  // namespace flowcage::occ
