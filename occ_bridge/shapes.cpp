#include "occ_bridge/shapes.hpp"

#include <BRepAlgoAPI_Cut.hxx>
#include <BRepAlgoAPI_Fuse.hxx>
#include <BRepBuilderAPI_Transform.hxx>
#include <BRepFilletAPI_MakeFillet.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <BRepPrimAPI_MakeSphere.hxx>
#include <BRepPrimAPI_MakeTorus.hxx>
#include <BRep_Builder.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Compound.hxx>
#include <gp_Trsf.hxx>
#include <numbers>

#include "occ_bridge/internal/shape_rep.hpp"

namespace flowcage {

Shape make_sphere(double radius) {
  return wrap(BRepPrimAPI_MakeSphere(radius).Shape());
}

Shape make_torus(double major_radius, double minor_radius) {
  return wrap(BRepPrimAPI_MakeTorus(major_radius, minor_radius).Shape());
}

Shape make_cylinder(double radius, double height) {
  return wrap(BRepPrimAPI_MakeCylinder(radius, height).Shape());
}

Shape make_box(const Vec3& size) {
  return wrap(
      BRepPrimAPI_MakeBox(gp_Pnt(-size.x() / 2, -size.y() / 2, -size.z() / 2), size.x(), size.y(), size.z())
          .Shape());
}

Shape make_rounded_box(const Vec3& size, double radius) {
  const Shape box = make_box(size);
  BRepFilletAPI_MakeFillet fillet(box.rep().shape);
  for (TopExp_Explorer edge(box.rep().shape, TopAbs_EDGE); edge.More(); edge.Next()) {
    fillet.Add(radius, TopoDS::Edge(edge.Current()));
  }
  return wrap(fillet.Shape());
}

Shape make_compound(const Shape& a, const Shape& b) {
  TopoDS_Compound compound;
  BRep_Builder builder;
  builder.MakeCompound(compound);
  builder.Add(compound, a.rep().shape);
  builder.Add(compound, b.rep().shape);
  return wrap(compound);
}

Shape make_union(const Shape& a, const Shape& b) {
  return wrap(BRepAlgoAPI_Fuse(a.rep().shape, b.rep().shape).Shape());
}

Shape make_difference(const Shape& a, const Shape& b) {
  return wrap(BRepAlgoAPI_Cut(a.rep().shape, b.rep().shape).Shape());
}

Shape translated(const Shape& shape, const Vec3& by) {
  gp_Trsf move;
  move.SetTranslation(gp_Vec(by.x(), by.y(), by.z()));
  return wrap(BRepBuilderAPI_Transform(shape.rep().shape, move, true).Shape());
}

Shape rotated(const Shape& shape, const Vec3& axis, double degrees) {
  gp_Trsf turn;
  turn.SetRotation(gp_Ax1(gp_Pnt(0, 0, 0), gp_Dir(axis.x(), axis.y(), axis.z())),
                   degrees * std::numbers::pi / 180);
  return wrap(BRepBuilderAPI_Transform(shape.rep().shape, turn, true).Shape());
}

Shape make_bend(double bend_radius, double pipe_radius, double degrees) {
  return wrap(BRepPrimAPI_MakeTorus(bend_radius, pipe_radius, degrees * std::numbers::pi / 180).Shape());
}

}  // namespace flowcage
