#include "occ_bridge/internal/fuse_pieces.hpp"

#include <BOPTools_AlgoTools.hxx>
#include <BRepAlgoAPI_BuilderAlgo.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <Geom_Surface.hxx>
#include <IntTools_Context.hxx>
#include <NCollection_DataMap.hxx>
#include <Standard_Failure.hxx>
#include <TopTools_ListOfShape.hxx>
#include <TopTools_ShapeMapHasher.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Compound.hxx>
#include <algorithm>
#include <sstream>

#include "occ_bridge/internal/face_edges.hpp"

namespace flowcage::occ {

namespace {

std::string first_error(const BRepAlgoAPI_BuilderAlgo& fuse) {
  std::ostringstream text;
  fuse.DumpErrors(text);
  std::string line;
  std::istringstream lines(text.str());
  std::getline(lines, line);
  return line.empty() ? "no result" : line;
}

TopoDS_Compound compound_of_faces(const FaceEdges& topology, const std::vector<Index>& faces) {
  TopoDS_Compound compound;
  BRep_Builder builder;
  builder.MakeCompound(compound);
  for (const Index f : faces) builder.Add(compound, topology.face(f));
  return compound;
}

class Collector {
 public:
  void add(const TopoDS_Face& origin, const TopoDS_Face& part, Index body) {
    const TopoDS_Face face = on_side_of(origin, part);
    const auto known = number_.Seek(face);
    if (known == nullptr) {
      number_.Bind(face, static_cast<Index>(result_.pieces.size()));
      result_.pieces.push_back({face, origin, {{body, 1}}});
      return;
    }
    Piece& piece = result_.pieces[*known];
    piece.owners.push_back({body, piece.face.Orientation() == face.Orientation() ? 1 : -1});
    if (piece.owners.size() == 2) ++result_.shared_faces;
  }
  void count_split() { ++result_.split_faces; }
  FusedPieces result() { return std::move(result_); }

 private:
  /// A piece looks where its face does. The kernel compares normals at a point inside, and finds none in thin
  /// pieces: that is needed only where the piece has the surface of another body's face.
  TopoDS_Face on_side_of(const TopoDS_Face& origin, const TopoDS_Face& part) {
    TopLoc_Location of_origin, of_part;
    const bool same_surface =
        BRep_Tool::Surface(origin, of_origin) == BRep_Tool::Surface(part, of_part) && of_origin == of_part;
    if (same_surface) return TopoDS::Face(part.Oriented(origin.Orientation()));
    const bool turn = BOPTools_AlgoTools::IsSplitToReverse(part, origin, context_);
    return turn ? TopoDS::Face(part.Reversed()) : part;
  }

  FusedPieces result_;
  NCollection_DataMap<TopoDS_Shape, Index, TopTools_ShapeMapHasher> number_;
  Handle(IntTools_Context) context_ = new IntTools_Context;
};

}  // namespace

FusedPieces fuse_pieces(const std::vector<Body>& bodies, const BodyGroup& group) {
  std::vector<FaceEdges> topologies;
  TopTools_ListOfShape arguments;
  for (std::size_t i = 0; i < group.bodies.size(); ++i) {
    topologies.push_back(face_edges_of(bodies[group.bodies[i]].shape));
    const std::vector<Index>& near = group.near_faces[i];
    if (!near.empty()) arguments.Append(compound_of_faces(topologies.back(), near));
  }
  BRepAlgoAPI_BuilderAlgo fuse;
  if (arguments.Extent() > 1) {
    fuse.SetArguments(arguments);
    fuse.SetRunParallel(Standard_False);
    fuse.SetUseOBB(Standard_True);
    fuse.Build();
    if (fuse.HasErrors() || fuse.Shape().IsNull()) throw Standard_Failure(first_error(fuse).c_str());
  }
  Collector collector;
  for (std::size_t i = 0; i < group.bodies.size(); ++i) {
    const std::vector<Index>& near = group.near_faces[i];
    for (Index f = 0; f < topologies[i].face_count(); ++f) {
      const TopoDS_Face& face = topologies[i].face(f);
      const bool took_part = arguments.Extent() > 1 && std::ranges::binary_search(near, f);
      if (took_part && fuse.IsDeleted(face)) continue;
      const auto body = static_cast<Index>(i);
      if (!took_part || fuse.Modified(face).IsEmpty()) {
        collector.add(face, face, body);
        continue;
      }
      const TopTools_ListOfShape& parts = fuse.Modified(face);
      if (parts.Extent() > 1) collector.count_split();
      for (const TopoDS_Shape& part : parts) collector.add(face, TopoDS::Face(part), body);
    }
  }
  return collector.result();
}

}  // namespace flowcage::occ
