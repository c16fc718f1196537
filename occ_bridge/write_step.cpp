#include "occ_bridge/write_step.hpp"

#include <APIHeaderSection_MakeHeader.hxx>
#include <BRepCheck_Analyzer.hxx>
#include <BRepLib.hxx>
#include <BRep_Builder.hxx>
#include <Geom2d_Line.hxx>
#include <GeomAbs_Shape.hxx>
#include <Geom_BSplineCurve.hxx>
#include <Geom_BSplineSurface.hxx>
#include <STEPConstruct.hxx>
#include <STEPControl_Writer.hxx>
#include <StepBasic_Product.hxx>
#include <StepData_StepModel.hxx>
#include <StepRepr_RepresentationItem.hxx>
#include <TColStd_Array1OfInteger.hxx>
#include <TColStd_Array1OfReal.hxx>
#include <TColgp_Array2OfPnt.hxx>
#include <TCollection_HAsciiString.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Compound.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Shell.hxx>
#include <TopoDS_Solid.hxx>
#include <TopoDS_Vertex.hxx>
#include <TopoDS_Wire.hxx>
#include <Transfer_FinderProcess.hxx>
#include <XSControl_TransferWriter.hxx>
#include <XSControl_WorkSession.hxx>
#include <filesystem>
#include <numeric>

#include "core/base/error.hpp"
#include "occ_bridge/internal/kernel_scope.hpp"
#include "occ_bridge/internal/kernel_units.hpp"

namespace flowcage {
namespace {

// The shape is built in millimetres, as the kernel's smallest tolerance (and what reads the file) expects;
// the writer converts. Shared curves agree far better.
constexpr double millimetres = 1000, tolerance = 1e-7;

struct KnotVector {
  TColStd_Array1OfReal values;
  TColStd_Array1OfInteger multiplicities;

  explicit KnotVector(const std::vector<double>& flat) : KnotVector(flat, distinct(flat)) {}

 private:
  KnotVector(const std::vector<double>& flat, const std::vector<double>& set)
      : values(1, static_cast<int>(set.size())), multiplicities(1, static_cast<int>(set.size())) {
    for (std::size_t k = 0; k < set.size(); ++k) {
      values.SetValue(static_cast<int>(k) + 1, set[k]);
      multiplicities.SetValue(static_cast<int>(k) + 1,
                              static_cast<int>(std::count(flat.begin(), flat.end(), set[k])));
    }
  }
  static std::vector<double> distinct(std::vector<double> flat) {
    flat.erase(std::unique(flat.begin(), flat.end()), flat.end());
    return flat;
  }
};

gp_Pnt point(const Vec3& p) {
  return {millimetres * p.x(), millimetres * p.y(), millimetres * p.z()};
}

Handle(Geom_BSplineSurface) kernel_surface(const BSplineSurface& s) {
  TColgp_Array2OfPnt poles(1, s.count_u(), 1, s.count_v());
  for (int i = 0; i < s.count_u(); ++i) {
    for (int j = 0; j < s.count_v(); ++j) poles.SetValue(i + 1, j + 1, point(s.poles[i * s.count_v() + j]));
  }
  const KnotVector u(s.knots_u), v(s.knots_v);
  return new Geom_BSplineSurface(poles, u.values, v.values, u.multiplicities, v.multiplicities, s.degree_u,
                                 s.degree_v);
}

// A piece of a side as a curve, by the side's own parameter.
Handle(Geom_BSplineCurve) side_curve(const Handle(Geom_BSplineSurface) & surface, const PatchSide& use) {
  Standard_Real u0, u1, v0, v1;
  surface->Bounds(u0, u1, v0, v1);
  const Handle(Geom_Curve) iso =
      use.side % 2 == 0 ? surface->VIso(use.side == 0 ? v0 : v1) : surface->UIso(use.side == 1 ? u1 : u0);
  Handle(Geom_BSplineCurve) curve = Handle(Geom_BSplineCurve)::DownCast(iso->Copy());
  curve->Segment(use.from, use.to);
  return curve;
}

// The same piece in the patch's parameters, run through like the edge's curve: from `use.from` on, or
// backward.
Handle(Geom2d_Line) side_line(const BSplineSurface& s, const PatchSide& use, bool backward, double start) {
  const double u1 = s.knots_u.back(), v1 = s.knots_v.back();
  const double at = backward ? use.to + start : use.from - start;  // the line's origin: parameter 0
  const double step = backward ? -1 : 1;
  if (use.side % 2 == 0) return new Geom2d_Line(gp_Pnt2d(at, use.side == 0 ? 0 : v1), gp_Dir2d(step, 0));
  return new Geom2d_Line(gp_Pnt2d(use.side == 1 ? u1 : 0, at), gp_Dir2d(0, step));
}

// Whether a use's side runs counter-clockwise with growing parameter.
bool ascending(const PatchSide& use) {
  return use.side < 2;
}

// Shared vertices and edges, then faces.
class Assembly {
 public:
  explicit Assembly(const PatchSurface& patches) : patches_(patches) {
    for (const Vec3& node : patches.nodes) {
      TopoDS_Vertex vertex;
      builder_.MakeVertex(vertex, point(node), tolerance);
      vertices_.push_back(vertex);
    }
    for (const BicubicPatch& patch : patches.patches) surfaces_.push_back(kernel_surface(patch.surface));
    for (const PatchEdge& edge : patches.edges) edges_.push_back(make_edge(edge));
    for (std::size_t p = 0; p < patches.patches.size(); ++p) faces_.push_back(make_face(p));
  }

  const std::vector<TopoDS_Face>& faces() const { return faces_; }

 private:
  // The curve is the first use's piece of side; the edge goes with its parameter.
  TopoDS_Edge make_edge(const PatchEdge& edge) {
    const PatchSide& use = edge.uses[0];
    TopoDS_Edge result;
    builder_.MakeEdge(result, side_curve(surfaces_[use.patch], use), tolerance);
    const bool up = ascending(use);
    builder_.Add(result, vertices_[edge.nodes[up ? 0 : 1]].Oriented(TopAbs_FORWARD));
    builder_.Add(result, vertices_[edge.nodes[up ? 1 : 0]].Oriented(TopAbs_REVERSED));
    builder_.Range(result, use.from, use.to);
    return result;
  }

  TopoDS_Face make_face(std::size_t p) {
    const BicubicPatch& patch = patches_.patches[p];
    TopoDS_Face face;
    builder_.MakeFace(face, surfaces_[p], tolerance);
    TopoDS_Wire wire;
    builder_.MakeWire(wire);
    for (const PatchBoundary& boundary : patch.boundary) {
      const PatchEdge& edge = patches_.edges[boundary.edge];
      const PatchSide& first = edge.uses[0];
      const PatchSide& use = boundary.forward ? first : edge.uses[1];
      // Parameters of both uses grow the same way along the curve unless exactly one of them descends: a
      // second use goes the other way round.
      const bool backward = !boundary.forward && ascending(use) == ascending(first);
      builder_.UpdateEdge(edges_[boundary.edge], side_line(patch.surface, use, backward, first.from), face,
                          tolerance);
      const bool with_curve = ascending(first) == boundary.forward;
      builder_.Add(wire, edges_[boundary.edge].Oriented(with_curve ? TopAbs_FORWARD : TopAbs_REVERSED));
    }
    wire.Closed(true);
    builder_.Add(face, wire);
    return face;
  }

  const PatchSurface& patches_;
  BRep_Builder builder_;
  std::vector<TopoDS_Vertex> vertices_;
  std::vector<Handle(Geom_BSplineSurface)> surfaces_;
  std::vector<TopoDS_Edge> edges_;
  std::vector<TopoDS_Face> faces_;
};

// Components as lists of patches, each with whether it is closed.
struct Component {
  std::vector<std::size_t> patches;
  bool closed = true;
};
std::vector<Component> components_of(const PatchSurface& surface) {
  std::vector<std::size_t> parent(surface.patches.size());
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&](std::size_t p) {
    while (parent[p] != p) p = parent[p] = parent[parent[p]];
    return p;
  };
  for (const PatchEdge& edge : surface.edges) {
    if (edge.use_count < 2) continue;
    const std::size_t a = root(edge.uses[0].patch), b = root(edge.uses[1].patch);
    parent[std::max(a, b)] = std::min(a, b);
  }
  std::vector<Component> components;
  std::vector<std::size_t> number(parent.size());
  for (std::size_t p = 0; p < parent.size(); ++p) {
    if (root(p) == p) {
      number[p] = components.size();
      components.emplace_back();
    }
    components[number[root(p)]].patches.push_back(p);
  }
  for (const PatchEdge& edge : surface.edges) {
    if (edge.use_count == 1) components[number[root(edge.uses[0].patch)]].closed = false;
  }
  return components;
}

TopoDS_Shape assemble(const PatchSurface& surface, std::vector<TopoDS_Face>& faces) {
  const Assembly assembly(surface);
  faces = assembly.faces();
  BRep_Builder builder;
  std::vector<TopoDS_Shape> parts;
  for (const Component& component : components_of(surface)) {
    TopoDS_Shell shell;
    builder.MakeShell(shell);
    for (const std::size_t p : component.patches) builder.Add(shell, faces[p]);
    shell.Closed(component.closed);
    if (!component.closed) {
      parts.push_back(shell);
      continue;
    }
    TopoDS_Solid solid;
    builder.MakeSolid(solid);
    builder.Add(solid, shell);
    // A cage round a cavity has its faces inward; the solid is what it encloses.
    BRepLib::OrientClosedSolid(solid);
    parts.push_back(solid);
  }
  TopoDS_Shape shape = parts.front();
  if (parts.size() > 1) {
    TopoDS_Compound compound;
    builder.MakeCompound(compound);
    for (const TopoDS_Shape& part : parts) builder.Add(compound, part);
    shape = compound;
  }
  for (const TopoDS_Face& face : faces) BRepLib::SameParameter(face, tolerance);
  if (!BRepCheck_Analyzer(shape).IsValid()) {
    throw Error(ErrorKind::internal, "B-spline patches: the kernel finds the shape not valid",
                "write the surface as .obj or .vtp, and report this cage");
  }
  return shape;
}

Handle(TCollection_HAsciiString) text(const std::string& value) {
  return new TCollection_HAsciiString(value.c_str());
}

}  // namespace

void write_step(const PatchSurface& surface, std::span<const std::string> patch_names, const StepFile& to) {
  const std::string unit = kernel_unit(to.unit);
  const std::string title = std::filesystem::path(to.shown_as).filename().string();
  const occ::KernelScope scope({{"xstep.cascade.unit", "MM"}, {"write.step.unit", unit}});
  std::vector<TopoDS_Face> faces;
  const TopoDS_Shape shape = assemble(surface, faces);
  STEPControl_Writer writer;
  bool written = writer.Transfer(shape, STEPControl_AsIs) == IFSelect_RetDone;
  if (written) {
    const Handle(Transfer_FinderProcess) process = writer.WS()->TransferWriter()->FinderProcess();
    for (std::size_t p = 0; p < faces.size(); ++p) {
      const std::string& name = patch_names[surface.patches[p].name];
      const auto item = STEPConstruct::FindEntity(process, faces[p]);
      if (!item.IsNull() && !name.empty()) item->SetName(text(name));
    }
    // The kernel counts its products through a process's life.
    for (int k = 1; k <= writer.Model()->NbEntities(); ++k) {
      const auto product = Handle(StepBasic_Product)::DownCast(writer.Model()->Value(k));
      if (product.IsNull()) continue;
      product->SetId(text(title));
      product->SetName(text(title));
    }
    APIHeaderSection_MakeHeader header(writer.Model());
    header.SetName(text(title));
    header.SetTimeStamp(text("1970-01-01T00:00:00"));  // the same bytes for the same input
    header.SetAuthorValue(1, text(""));
    header.SetOrganizationValue(1, text(""));
    header.SetOriginatingSystem(text("flowcage"));
    written = writer.Write(to.file.c_str()) == IFSelect_RetDone;
  }
  if (!written) {
    throw Error(ErrorKind::output, to.shown_as + ": cannot write STEP",
                "check the folder, its permissions and free space");
  }
}

}  // namespace flowcage
