#include <BRepAdaptor_Surface.hxx>
#include <BRepAlgoAPI_Cut.hxx>
#include <BRepBndLib.hxx>
#include <BRepBuilderAPI_MakeEdge.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_MakeWire.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakeRevol.hxx>
#include <BRep_Builder.hxx>
#include <Bnd_Box.hxx>
#include <Geom_Ellipse.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Shell.hxx>
#include <cmath>
#include <numbers>

#include "core/base/error.hpp"
#include "occ_bridge/internal/shape_rep.hpp"

namespace flowcage {
namespace {

// True where the face is a plane of constant coordinate 0.
bool lies_in_plane(const TopoDS_Face& face, int axis) {
  const BRepAdaptor_Surface surface(face);
  if (surface.GetType() != GeomAbs_Plane) return false;
  const gp_Pln plane = surface.Plane();
  const double normal = std::abs(plane.Axis().Direction().Coord(axis + 1));
  return normal > 1 - 1e-12 && std::abs(plane.Location().Coord(axis + 1)) < 1e-9;
}

}  // namespace

Shape make_ellipsoid(double half_length, double radius) {
  const Handle(Geom_Ellipse) ellipse =
      new Geom_Ellipse(gp_Ax2(gp_Pnt(0, 0, 0), gp_Dir(0, -1, 0), gp_Dir(1, 0, 0)), half_length, radius);
  const gp_Pnt nose(-half_length, 0, 0), tail(half_length, 0, 0);
  BRepBuilderAPI_MakeWire wire;
  wire.Add(BRepBuilderAPI_MakeEdge(ellipse, tail, nose, 0, std::numbers::pi));
  wire.Add(BRepBuilderAPI_MakeEdge(nose, tail));
  const TopoDS_Face section = BRepBuilderAPI_MakeFace(wire.Wire(), true);
  return wrap(BRepPrimAPI_MakeRevol(section, gp_Ax1(gp_Pnt(0, 0, 0), gp_Dir(1, 0, 0))).Shape());
}

Shape make_half(const Shape& solid, int axis) {
  Bnd_Box bounds;
  BRepBndLib::Add(solid.rep().shape, bounds);
  bounds.Enlarge(0.1 * std::sqrt(bounds.SquareExtent()));
  gp_Pnt low = bounds.CornerMin(), high = bounds.CornerMax();
  high.SetCoord(axis + 1, 0);
  const TopoDS_Shape half =
      BRepAlgoAPI_Cut(solid.rep().shape, BRepPrimAPI_MakeBox(low, high).Shape()).Shape();
  TopoDS_Shell shell;
  BRep_Builder builder;
  builder.MakeShell(shell);
  bool cut = false;
  for (TopExp_Explorer face(half, TopAbs_FACE); face.More(); face.Next()) {
    if (lies_in_plane(TopoDS::Face(face.Current()), axis)) {
      cut = true;
    } else {
      builder.Add(shell, face.Current());
    }
  }
  if (!cut) throw Error(ErrorKind::internal, "the plane does not cut the solid", "move the solid across it");
  return wrap(shell);
}

}  // namespace flowcage
