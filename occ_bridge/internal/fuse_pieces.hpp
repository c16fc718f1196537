#pragma once
#include <TopoDS_Face.hxx>
#include <string>
#include <vector>

#include "occ_bridge/internal/body_overlaps.hpp"

namespace flowcage::occ {

/// One face of a body that takes part in a piece.
struct PieceOwner {
  Index body = no_index;  ///< position in the group
  int side = 1;           ///< -1: the body's face looks the other way than the piece
};

/// A part of a face between the curves in which bodies meet.
struct Piece {
  TopoDS_Face face;
  TopoDS_Face origin;              ///< the first face that it is a part of
  std::vector<PieceOwner> owners;  ///< several where faces of several bodies coincide
};

struct FusedPieces {
  std::vector<Piece> pieces;  ///< body by body, in the order of their faces
  Index split_faces = 0;      ///< faces that became several pieces
  Index shared_faces = 0;     ///< pieces of more than one body
};

/// Cuts the faces of a group's bodies along the curves in which the bodies meet (OpenCASCADE's general fuse):
/// afterwards the pieces share these curves as edges, and faces that coincide are one piece. Faces that are
/// not near another body are passed on as they are. Changes tolerances of the given shapes. Throws
/// Standard_Failure where the kernel gives up.
FusedPieces fuse_pieces(const std::vector<Body>& bodies, const BodyGroup& group);

}  // namespace flowcage::occ
