#include <BRepAdaptor_Surface.hxx>
#include <BRepAlgoAPI_Cut.hxx>
#include <BRepBndLib.hxx>
#include <BRepBuilderAPI_MakeEdge.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_MakeSolid.hxx>
#include <BRepBuilderAPI_MakeWire.hxx>
#include <BRepBuilderAPI_Sewing.hxx>
#include <BRepLib.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakeCone.hxx>
#include <BRepPrimAPI_MakeRevol.hxx>
#include <BRep_Builder.hxx>
#include <Bnd_Box.hxx>
#include <Geom_BezierCurve.hxx>
#include <Geom_BezierSurface.hxx>
#include <Geom_Ellipse.hxx>
#include <TColgp_Array1OfPnt.hxx>
#include <TColgp_Array2OfPnt.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Shell.hxx>
#include <TopoDS_Solid.hxx>
#include <cmath>
#include <initializer_list>
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

BRepBuilderAPI_MakeWire polygon(std::initializer_list<gp_Pnt> corners) {
  BRepBuilderAPI_MakeWire wire;
  for (const gp_Pnt* p = corners.begin(); p != corners.end(); ++p) {
    wire.Add(BRepBuilderAPI_MakeEdge(*p, p + 1 == corners.end() ? *corners.begin() : p[1]));
  }
  return wire;
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

Shape make_cone(double radius, double height) {
  return wrap(BRepPrimAPI_MakeCone(radius, 0, height).Shape());
}

Shape make_fading_ridge() {
  constexpr double sunk = 0.25;  // the quadratic's middle pole: half of its largest slope
  BRepBuilderAPI_Sewing sewing(1e-6);
  const auto add_plane = [&](const BRepBuilderAPI_MakeWire& outline) {
    sewing.Add(BRepBuilderAPI_MakeFace(BRepBuilderAPI_MakeWire(outline).Wire(), true).Face());
  };
  BRepBuilderAPI_MakeWire front;  // x = 0, from (0, 1, 1) over the ridge to (0, -1, 1) and round below
  for (const double side : {1.0, -1.0}) {
    TColgp_Array2OfPnt poles(1, 4, 1, 3);
    for (int i = 0; i < 4; ++i) {
      for (int j = 0; j < 3; ++j) {
        poles.SetValue(i + 1, j + 1, gp_Pnt(i / 3.0, side * j / 2.0, i == 0 && j == 1 ? 1 - sunk : 1));
      }
    }
    sewing.Add(BRepBuilderAPI_MakeFace(new Geom_BezierSurface(poles), 1e-9).Face());
    TColgp_Array1OfPnt arc(1, 3);
    for (int j = 0; j < 3; ++j) arc.SetValue(j + 1, poles.Value(1, side > 0 ? 3 - j : j + 1));
    front.Add(BRepBuilderAPI_MakeEdge(new Geom_BezierCurve(arc)));
    add_plane(polygon({{1, 0, 1}, {2, 0, 1}, {2, side, 1}, {1, side, 1}}));
    add_plane(polygon({{0, side, 0}, {2, side, 0}, {2, side, 1}, {1, side, 1}, {0, side, 1}}));
  }
  front.Add(BRepBuilderAPI_MakeEdge(gp_Pnt(0, -1, 1), gp_Pnt(0, -1, 0)));
  front.Add(BRepBuilderAPI_MakeEdge(gp_Pnt(0, -1, 0), gp_Pnt(0, 1, 0)));
  front.Add(BRepBuilderAPI_MakeEdge(gp_Pnt(0, 1, 0), gp_Pnt(0, 1, 1)));
  add_plane(front);
  add_plane(polygon({{2, -1, 0}, {2, 1, 0}, {2, 1, 1}, {2, 0, 1}, {2, -1, 1}}));
  add_plane(polygon({{0, -1, 0}, {0, 1, 0}, {2, 1, 0}, {2, -1, 0}}));
  sewing.Perform();
  TopExp_Explorer shell(sewing.SewedShape(), TopAbs_SHELL);
  TopoDS_Solid solid = BRepBuilderAPI_MakeSolid(TopoDS::Shell(shell.Current())).Solid();
  BRepLib::OrientClosedSolid(solid);
  return wrap(solid);
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
