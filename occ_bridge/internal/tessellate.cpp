#include "occ_bridge/internal/tessellate.hpp"

#include <fmt/format.h>
#include <BRepBndLib.hxx>
#include <BRepMesh_IncrementalMesh.hxx>
#include <BRep_Tool.hxx>
#include <Bnd_Box.hxx>
#include <IMeshTools_Parameters.hxx>
#include <Poly_PolygonOnTriangulation.hxx>
#include <Poly_Triangulation.hxx>
#include <TopoDS.hxx>
#include <numbers>
#include <numeric>

#include "occ_bridge/internal/kernel_scope.hpp"

namespace flowcage::occ {

namespace {

bool has_triangles(const TopoDS_Face& face) {
  TopLoc_Location location;
  const auto mesh = BRep_Tool::Triangulation(face, location);
  return !mesh.IsNull() && mesh->NbTriangles() > 0;
}

std::string place_of(const TopoDS_Shape& shape, double scale) {
  Bnd_Box box;
  failure_of([&] { BRepBndLib::Add(shape, box, Standard_False); });
  if (box.IsVoid()) return "at an unknown place";
  const gp_XYZ middle = 0.5 * scale * (box.CornerMin().XYZ() + box.CornerMax().XYZ());
  return "near " + place({middle.X(), middle.Y(), middle.Z()}) + " m";
}

/// Union-find over nodes; the smaller number represents.
class Joined {
 public:
  explicit Joined(Index count) : parent_(static_cast<std::size_t>(count)) {
    std::iota(parent_.begin(), parent_.end(), 0);
  }
  Index root(Index i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join(Index a, Index b) {
    a = root(a);
    b = root(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<Index> parent_;
};

}  // namespace

void triangulate_faces(const TopoDS_Shape& shape, const TessellateSettings& settings,
                       const FaceLabels& labels, CadSummary& summary, Progress& progress) {
  IMeshTools_Parameters parameters;
  parameters.Deflection = settings.deflection;
  parameters.Angle = settings.angle_degrees * std::numbers::pi / 180;
  parameters.InParallel = Standard_False;  // the same triangles in every run
  const Handle(KernelProgress) bridge = new KernelProgress(progress, "tessellate the CAD");
  const std::string failure =
      failure_of([&] { BRepMesh_IncrementalMesh mesh(shape, parameters, bridge->Start()); });
  progress.step("tessellate the CAD", 1.0);
  const FaceEdges topology = face_edges_of(shape);
  for (Index f = 0; f < topology.face_count(); ++f) {
    const TopoDS_Face& face = topology.face(f);
    if (has_triangles(face)) continue;
    // Alone, and coarser: a failure beside it, or too small a size, was the cause in some files.
    std::string reason = failure;
    for (const double factor : {1.0, 10.0}) {
      IMeshTools_Parameters coarser = parameters;
      coarser.Deflection *= factor;
      reason = failure_of([&] { BRepMesh_IncrementalMesh mesh(face, coarser); });
      if (has_triangles(face)) break;
    }
    if (has_triangles(face)) continue;
    summary.bad_faces.push_back(labels.of(face).number);
    summary.warnings.push_back(fmt::format("{} {} has no triangulation{}: it is left out of the target",
                                           labels.word_for(face), place_of(face, settings.scale),
                                           reason.empty() ? "" : " (" + reason + ")"));
  }
}

Tessellation collect_triangles(const FaceEdges& topology, double scale) {
  struct FaceMesh {
    Handle(Poly_Triangulation) mesh;
    TopLoc_Location location;
    Index first = 0;
  };
  std::vector<FaceMesh> meshes(static_cast<std::size_t>(topology.face_count()));
  Index nodes = 0;
  for (Index f = 0; f < topology.face_count(); ++f) {
    FaceMesh& part = meshes[f];
    part.first = nodes;
    part.mesh = BRep_Tool::Triangulation(topology.face(f), part.location);
    if (!part.mesh.IsNull()) nodes += part.mesh->NbNodes();
  }

  // Nodes of an edge's polygon are the same points in each of its faces.
  Joined joined(nodes);
  for (Index e = 0; e < topology.edge_count(); ++e) {
    const TopoDS_Edge& edge = topology.edge(e);
    const bool degenerated = topology.degenerated(e);
    std::vector<Index> shared;
    for (const EdgeUse& use : topology.uses[e]) {
      const FaceMesh& part = meshes[use.face];
      if (part.mesh.IsNull()) continue;
      for (const TopAbs_Orientation side : {TopAbs_FORWARD, TopAbs_REVERSED}) {  // both runs of a seam
        const auto polygon =
            BRep_Tool::PolygonOnTriangulation(TopoDS::Edge(edge.Oriented(side)), part.mesh, part.location);
        if (polygon.IsNull()) continue;
        const int count = polygon->NbNodes();
        if (shared.empty()) {
          for (int i = 1; i <= count; ++i) shared.push_back(part.first + polygon->Node(i) - 1);
        }
        if (static_cast<int>(shared.size()) != count) continue;
        for (int i = 1; i <= count; ++i) joined.join(shared[i - 1], part.first + polygon->Node(i) - 1);
        if (degenerated) {
          for (int i = 2; i <= count; ++i) joined.join(shared[0], shared[i - 1]);
        }
      }
    }
  }

  Tessellation result;
  std::vector<Index> number(static_cast<std::size_t>(nodes), no_index);
  for (Index f = 0; f < topology.face_count(); ++f) {
    const FaceMesh& part = meshes[f];
    if (part.mesh.IsNull()) continue;
    const gp_Trsf trsf = part.location.Transformation();
    const bool flip = topology.face(f).Orientation() ==
                      TopAbs_REVERSED;  // also under a mirroring location: the winding mirrors, too
    const auto point = [&](int node) {
      const Index root = joined.root(part.first + node - 1);
      if (number[root] == no_index) {
        const gp_Pnt p = part.mesh->Node(node).Transformed(trsf);
        number[root] = static_cast<Index>(result.points.size());
        result.points.emplace_back(scale * p.X(), scale * p.Y(), scale * p.Z());
      }
      return number[root];
    };
    for (int t = 1; t <= part.mesh->NbTriangles(); ++t) {
      int a = 0, b = 0, c = 0;
      part.mesh->Triangle(t).Get(a, b, c);
      std::array<Index, 3> triangle{point(a), point(b), point(c)};
      if (triangle[0] == triangle[1] || triangle[1] == triangle[2] || triangle[2] == triangle[0]) continue;
      if (flip) std::swap(triangle[1], triangle[2]);
      result.triangles.push_back(triangle);
      result.triangle_face.push_back(f);
    }
  }
  return result;
}

}  // namespace flowcage::occ
