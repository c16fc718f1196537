#pragma once
#include "core/project/cell_polynomial.hpp"

namespace flowcage {

struct CellFootSettings {
  double length = 1;         ///< size of the model
  double tolerance = 1e-12;  ///< of the last step, relative to `length`
  double give_up_above = 0;  ///< a distance: no nearer point is of interest
  /// Bound of how much an eigenvalue of H (see closest_point.hpp) relative to the first fundamental form
  /// may differ between two points of the cell.
  double eigenvalue_change = 0;
};

enum class CellFootEnd : std::uint8_t {
  found,      ///< the only minimum over the cell
  given_up,   ///< no point of the cell is nearer than give_up_above
  concave,    ///< f has a direction of descent everywhere: no minimum but on the cell's border
  undecided,  ///< none of these can be shown by the bounds: closest_point's several starts are needed
};

struct CellFoot {
  CellFootEnd end = CellFootEnd::undecided;
  Vec2 st = Vec2::Zero();
  PatchPoint point;  ///< derivatives by s and t
  double distance = 0;
  int evaluations = 0;
};

/// The quick form of closest_point for a cell of a polynomial that is nearly flat: Newton's method over
/// [-1, 1]^2 where f is shown to be convex over all of it.
CellFoot cell_foot(const CellPolynomial& cell, const Vec3& query, const Vec2& start,
                   const CellFootSettings& settings);

}  // namespace flowcage
