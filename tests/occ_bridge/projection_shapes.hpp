#pragma once
#include <BRepAlgoAPI_Cut.hxx>
#include <BRepBuilderAPI_MakeEdge.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_MakeWire.hxx>
#include <BRepFilletAPI_MakeFillet.hxx>
#include <BRepOffsetAPI_ThruSections.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakeCone.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <BRepPrimAPI_MakeSphere.hxx>
#include <BRepPrimAPI_MakeTorus.hxx>
#include <BRep_Builder.hxx>
#include <GeomAPI_PointsToBSpline.hxx>
#include <GeomAPI_PointsToBSplineSurface.hxx>
#include <Geom_BSplineCurve.hxx>
#include <Geom_BSplineSurface.hxx>
#include <TColgp_Array1OfPnt.hxx>
#include <TColgp_Array2OfPnt.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Compound.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Wire.hxx>
#include <cmath>
#include <gp_Ax2.hxx>
#include <string>
#include <vector>

// Shapes whose projection is hard in different ways; for the tests of occ_bridge only.
namespace flowcage::test_shapes {

inline std::vector<TopoDS_Face> faces_of(const TopoDS_Shape& shape) {
  std::vector<TopoDS_Face> faces;
  for (TopExp_Explorer it(shape, TopAbs_FACE); it.More(); it.Next()) {
    faces.push_back(TopoDS::Face(it.Current()));
  }
  return faces;
}

inline TopoDS_Shape rounded_box() {
  const TopoDS_Shape box = BRepPrimAPI_MakeBox(2, 1, 0.6).Shape();
  BRepFilletAPI_MakeFillet fillet(box);
  for (TopExp_Explorer it(box, TopAbs_EDGE); it.More(); it.Next())
    fillet.Add(0.12, TopoDS::Edge(it.Current()));
  return fillet.Shape();
}

/// A swept wing of NACA 0012 sections with a blunt trailing edge and flat ends: thin, with a tight nose.
inline TopoDS_Shape wing() {
  BRepOffsetAPI_ThruSections loft(true, false, 1e-7);
  for (const double span : {0.0, 0.8, 2.0}) {
    const double chord = 1 - 0.3 * span, sweep = 0.5 * span;
    TColgp_Array1OfPnt points(1, 61);
    for (int i = 0; i <= 60; ++i) {
      const double angle = 2 * std::acos(-1.0) * i / 60, x = 0.5 * (1 + std::cos(angle));
      const double thick = 0.6 * (0.2969 * std::sqrt(x) - 0.126 * x - 0.3516 * x * x + 0.2843 * x * x * x -
                                  0.1015 * x * x * x * x);
      points.SetValue(i + 1, gp_Pnt(sweep + chord * x, span, chord * (i <= 30 ? thick : -thick)));
    }
    const Handle(Geom_BSplineCurve) section = GeomAPI_PointsToBSpline(points, 3, 3, GeomAbs_C2, 1e-5).Curve();
    const TopoDS_Edge upper = BRepBuilderAPI_MakeEdge(section);
    const TopoDS_Edge base = BRepBuilderAPI_MakeEdge(section->EndPoint(), section->StartPoint());
    BRepBuilderAPI_MakeWire wire(upper, base);
    loft.AddWire(wire.Wire());
  }
  return loft.Shape();
}

/// A wavy B-spline sheet with a round and a four-sided hole.
inline TopoDS_Shape sheet_with_holes() {
  TColgp_Array2OfPnt points(1, 9, 1, 9);
  for (int i = 0; i < 9; ++i) {
    for (int j = 0; j < 9; ++j) {
      const double x = 0.25 * i, y = 0.25 * j;
      points.SetValue(i + 1, j + 1, gp_Pnt(x, y, 0.15 * std::sin(3 * x) * std::cos(2 * y)));
    }
  }
  const Handle(Geom_BSplineSurface) surface = GeomAPI_PointsToBSplineSurface(points).Surface();
  const TopoDS_Shape face = BRepBuilderAPI_MakeFace(surface, 1e-7).Face();
  const TopoDS_Shape round =
      BRepPrimAPI_MakeCylinder(gp_Ax2(gp_Pnt(0.7, 0.8, -1), gp_Dir(0.1, 0.05, 1)), 0.3, 2).Shape();
  const TopoDS_Shape square = BRepPrimAPI_MakeBox(gp_Pnt(1.3, 1.2, -1), gp_Pnt(1.7, 1.75, 1)).Shape();
  return BRepAlgoAPI_Cut(BRepAlgoAPI_Cut(face, round).Shape(), square).Shape();
}

/// A bumpy ring of 12 x 13 cubic B-spline faces, each with a slanted round hole and a corner cut off (some
/// fall apart into two: 216 faces).
inline TopoDS_Shape trimmed_panels() {
  constexpr int around = 12, across = 13, grid = 8;
  const double pi = std::acos(-1.0);
  const auto point = [&](double a, double b) {
    const double u = 2 * pi * a / around, v = 2 * pi * b / across;
    const double r = 0.4 + 0.04 * std::sin(3 * u) * std::cos(2 * v), ring = 1 + r * std::cos(v);
    return gp_Pnt(ring * std::cos(u), ring * std::sin(u), r * std::sin(v));
  };
  TopoDS_Compound panels;
  BRep_Builder builder;
  builder.MakeCompound(panels);
  for (int i = 0; i < around; ++i) {
    for (int j = 0; j < across; ++j) {
      TColgp_Array2OfPnt points(1, grid, 1, grid);
      for (int k = 0; k < grid * grid; ++k) {
        const int row = k / grid, column = k % grid;
        points.SetValue(row + 1, column + 1, point(i + row / (grid - 1.0), j + column / (grid - 1.0)));
      }
      const TopoDS_Shape face = BRepBuilderAPI_MakeFace(
          GeomAPI_PointsToBSplineSurface(points, 3, 3, GeomAbs_C2, 1e-5).Surface(), 1e-7);
      const gp_Pnt center = point(i + 0.45, j + 0.45), corner = point(i + 1, j + 1),
                   inner = point(i + 0.5, j + 0.5);
      const gp_Vec normal =
          gp_Vec(center, point(i + 0.6, j + 0.45)) ^ gp_Vec(center, point(i + 0.45, j + 0.6));
      const gp_Dir slanted(normal.Normalized() + 0.3 * gp_Vec(0.2, 0.5, 0.8));
      const auto drill = [&](const gp_Pnt& at, double radius) {
        return BRepPrimAPI_MakeCylinder(gp_Ax2(at.Translated(gp_Vec(slanted) * -0.2), slanted), radius, 0.4)
            .Shape();
      };
      const double size = center.Distance(corner);
      const TopoDS_Shape holed =
          BRepAlgoAPI_Cut(face, drill(center, 0.35 * inner.Distance(point(i + 1, j + 0.5)))).Shape();
      builder.Add(panels, BRepAlgoAPI_Cut(holed, drill(corner, 0.4 * size)).Shape());
    }
  }
  return panels;
}

struct NamedShape {
  std::string name;
  TopoDS_Shape shape;
};

inline std::vector<NamedShape> all() {
  return {{"sphere", BRepPrimAPI_MakeSphere(gp_Pnt(0.3, -0.2, 0.1), 0.9).Shape()},
          {"torus", BRepPrimAPI_MakeTorus(1, 0.3).Shape()},
          {"cylinder", BRepPrimAPI_MakeCylinder(0.5, 1.6).Shape()},
          {"cone", BRepPrimAPI_MakeCone(0.8, 0, 1.5).Shape()},
          {"rounded box", rounded_box()},
          {"wing", wing()},
          {"sheet with holes", sheet_with_holes()}};
}

}  // namespace flowcage::test_shapes
