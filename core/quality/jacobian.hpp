#pragma once
#include <array>
#include <vector>

#include "core/mesh/hex_view.hpp"

namespace flowcage {

/// The corner positions of a hex, VTK order.
using HexCorners = std::array<Vec3, 8>;

/// Jacobian of the trilinear map at the eight corners: the triple product of the three edges that leave the
/// corner, right-handed. Unit m^3; a unit cube has 1 everywhere.
std::array<double, 8> corner_jacobians(const HexCorners& hex);

/// Scaled Jacobian: corner (or centre) Jacobian over the product of the lengths of its three edges (or
/// principal axes), the least of NINE values: the 8 corners and the centre. Range [-1, 1]; 1 for a box. 0 at
/// a collapsed edge, -1 if a coordinate is not finite. Source: Stimpson, Ernst, Knupp, Pebay, Thompson, "The
/// Verdict Library Reference Manual" (2007), section 6.16; so ParaView's and Cubit's figure. Only an
/// extremely twisted hex has its least value at the centre.
double scaled_jacobian(const HexCorners& hex);

/// An inverted cell: the Jacobian is not positive (or no number) at some corner.
bool is_inverted(const HexCorners& hex);

/// Both of the above at once, for less than the price of one after the other.
struct JacobianVerdict {
  double scaled_jacobian = 0;
  bool inverted = false;
};
JacobianVerdict judge_jacobians(const HexCorners& hex);

/// Scaled Jacobian of each cell of a mesh, as a field for pictures.
std::vector<float> scaled_jacobians(const HexView& mesh);

}  // namespace flowcage
