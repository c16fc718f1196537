#include "occ_bridge/internal/face_edges.hpp"

#include <BRep_Tool.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>

namespace flowcage::occ {

const TopoDS_Face& FaceEdges::face(Index f) const {
  return TopoDS::Face(faces(f + 1));
}

const TopoDS_Edge& FaceEdges::edge(Index e) const {
  return TopoDS::Edge(edges(e + 1));
}

bool FaceEdges::degenerated(Index e) const {
  return BRep_Tool::Degenerated(edge(e));
}

bool FaceEdges::is_inconsistent(Index e) const {
  const auto row = uses[e];
  return row.size() == 2 && row[0].face != row[1].face && row[0].reversed == row[1].reversed &&
         !degenerated(e);
}

Index FaceEdges::free_edge_count() const {
  Index count = 0;
  for (Index e = 0; e < edge_count(); ++e) count += is_free(e) ? 1 : 0;
  return count;
}

FaceEdges face_edges_of(const TopoDS_Shape& shape) {
  FaceEdges result;
  TopExp::MapShapes(shape, TopAbs_FACE, result.faces);
  TopExp::MapShapes(shape, TopAbs_EDGE, result.edges);
  std::vector<std::vector<EdgeUse>> rows(static_cast<std::size_t>(result.edge_count()));
  for (Index f = 0; f < result.face_count(); ++f) {
    for (TopExp_Explorer it(result.face(f), TopAbs_EDGE); it.More(); it.Next()) {
      const TopAbs_Orientation orientation = it.Current().Orientation();
      if (orientation != TopAbs_FORWARD && orientation != TopAbs_REVERSED) continue;
      rows[result.edges.FindIndex(it.Current()) - 1].push_back({f, orientation == TopAbs_REVERSED});
    }
  }
  for (const auto& row : rows) result.uses.push_row(row);
  return result;
}

}  // namespace flowcage::occ
