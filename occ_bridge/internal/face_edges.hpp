#pragma once
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Shape.hxx>

#include "core/base/csr.hpp"

namespace flowcage::occ {

/// One run of a face's boundary along an edge.
struct EdgeUse {
  Index face = no_index;
  bool reversed = false;  ///< the wire runs against the edge
};

/// Faces and edges of a shape, numbered from 0 in the order of exploration, and who bounds whom. Seams are
/// used twice by their face; edges inside of faces (INTERNAL, EXTERNAL) are not listed as uses.
struct FaceEdges {
  TopTools_IndexedMapOfShape faces, edges;
  Csr<EdgeUse> uses;  ///< one row an edge

  Index face_count() const { return faces.Extent(); }
  Index edge_count() const { return edges.Extent(); }
  const TopoDS_Face& face(Index f) const;
  const TopoDS_Edge& edge(Index e) const;
  bool degenerated(Index e) const;  ///< a point in space: pole of a sphere, apex of a cone
  /// Bounds one face, once.
  bool is_free(Index e) const { return uses.row_size(e) == 1 && !degenerated(e); }
  /// Two faces run along it in the same direction, so that one of them is inside out.
  bool is_inconsistent(Index e) const;
  Index free_edge_count() const;
};

FaceEdges face_edges_of(const TopoDS_Shape& shape);

}  // namespace flowcage::occ
