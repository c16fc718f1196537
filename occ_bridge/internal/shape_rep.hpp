#pragma once
#include <TopoDS_Shape.hxx>

#include "occ_bridge/shapes.hpp"

namespace flowcage {

struct Shape::Rep {
  TopoDS_Shape shape;
};

inline Shape wrap(const TopoDS_Shape& shape) {
  return Shape(std::make_shared<const Shape::Rep>(Shape::Rep{shape}));
}

}  // namespace flowcage
