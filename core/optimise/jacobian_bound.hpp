#pragma once
#include "core/optimise/hex_corner.hpp"

namespace flowcage {

/// What is proved of det J over a whole trilinear hex, its inside included.
enum class JacobianSign : std::uint8_t {
  positive,      ///< det J > 0 everywhere: proved
  not_positive,  ///< det J <= 0 at a point that was found
  undecided,     ///< det J touches zero to within rounding or the subdivision's depth
};

/// The 27 Bernstein coefficients of det J over the unit cube: det J of a trilinear map is a tensor polynomial
/// of degree 2 in each coordinate, so it lies within their convex hull. Coefficient (i,j,k) is entry i + 3 j
/// + 9 k; those with all of i,j,k in {0,2} are the Jacobians at the corners. Unit: metre^3, 1 for a unit
/// cube. (Johnen, Remacle, Geuzaine, J. Comput. Phys. 233, 2013.)
std::array<double, 27> jacobian_bernstein(const HexCornerPoints& corners);

/// A number that det J exceeds or equals everywhere in the hex, rounding included (metre^3): the least
/// Bernstein coefficient after `subdivisions` splits of the worst part in 8, less a bound of the rounding
/// error. Sharp on affine hexes; it approaches the true minimum by a factor of about 4 a level. NaN where a
/// coordinate is not finite.
double jacobian_lower_bound(const HexCornerPoints& corners, int subdivisions = 0);

/// Subdivides until the sign is certain, to `max_depth` levels. Corners alone do not prove a hex valid; this
/// does.
JacobianSign jacobian_sign(const HexCornerPoints& corners, int max_depth = 6);

}  // namespace flowcage
