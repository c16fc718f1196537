#pragma once
#include <TopoDS_Shape.hxx>
#include <vector>

#include "core/project/winding_number.hpp"
#include "core/target/target_surface.hpp"

namespace flowcage::occ {

/// A body of a model: one child of its compound, that is a solid, an open shell or a single face.
struct Body {
  TopoDS_Shape shape{};
  bool closed = false;    ///< no free edge
  bool encloses = false;  ///< its area vectors cancel to a tenth: closed, or with small openings
  Tessellation mesh{};    ///< in the shape's length unit
};

/// Precondition: the faces are triangulated.
std::vector<Body> bodies_of(const TopoDS_Shape& compound);

/// Bodies that may interfere with each other, directly or through others of the group.
struct BodyGroup {
  std::vector<Index> bodies;                     ///< at least two, ascending
  std::vector<std::vector<Index>> near_faces{};  ///< of each: its faces with a triangle near another body's
};

/// Two bodies belong together where a triangle of one comes within `reach` of a triangle of the other (by
/// their boxes and planes: some pairs that are a little farther count, too), or where one lies inside of the
/// other; and where at least one of them encloses something (sheets hide nothing). With reach of at least
/// twice the tessellation's deviation no pair that touches is missed.
std::vector<BodyGroup> interfering_bodies(const std::vector<Body>& bodies, double reach);

}  // namespace flowcage::occ
