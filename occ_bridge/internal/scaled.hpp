#pragma once
#include <BRepBuilderAPI_Transform.hxx>
#include <TopoDS_Shape.hxx>

namespace flowcage::occ {

/// The shape with its geometry scaled about the origin; its faces keep their order.
inline TopoDS_Shape scaled(const TopoDS_Shape& shape, double factor) {
  if (factor == 1) return shape;
  gp_Trsf trsf;
  trsf.SetScale(gp_Pnt(0, 0, 0), factor);
  return BRepBuilderAPI_Transform(shape, trsf, Standard_True).Shape();
}

}  // namespace flowcage::occ
