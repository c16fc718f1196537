#pragma once
#include "core/optimise/hex_corner.hpp"

namespace flowcage {

/// What is proved of det J over a whole trilinear hex, its inside included.
enum class JacobianSign : std::uint8_t {
  positive,      ///< det J > 0 everywhere: proved
  not_positive,  ///< det J <= 0 at a point that was found
  undecided,     ///< det J comes closer to zero than rounding or the number of splits can tell
};

/// The 27 Bernstein coefficients of det J over the unit cube: det J of a trilinear map is a tensor polynomial
/// of degree 2 in each coordinate, so it lies within their convex hull. Coefficient (i,j,k) is entry i + 3 j
/// + 9 k; those with all of i,j,k in {0,2} are the Jacobians at the corners. Unit: metre^3, 1 for a unit
/// cube. (Johnen, Remacle, Geuzaine, J. Comput. Phys. 233, 2013.)
std::array<double, 27> jacobian_bernstein(const HexCornerPoints& corners);

/// A number that det J exceeds or equals everywhere in the hex, rounding included (metre^3): the least
/// Bernstein coefficient after `splits` times splitting the worst part in 8, less a bound of the rounding
/// error. Sharp on affine hexes; the gap to the true minimum falls by about 4 a level. NaN where a
/// coordinate is not finite.
double jacobian_lower_bound(const HexCornerPoints& corners, int splits = 0);

/// A cheap proof of det J > 0 everywhere, for cells that are nearly parallelepipeds, as those of fine levels
/// are. With A the affine map whose columns are the means of the hex's four edges along each axis, and d_a
/// the largest deviation of an edge along axis a from its mean, each column of J stays within d_a of A's, so
///   |det J - det A| <= (|A_1| + d_1) (|A_2| + d_2) (|A_3| + d_3) - |A_1| |A_2| |A_3|
/// (Hadamard's inequality on the expanded determinant); true where det A exceeds that and the rounding. The
/// same holds for every Bernstein coefficient, so wherever this is true, jacobian_sign is positive.
bool positive_near_affine(const HexCornerPoints& corners);

/// Splits the part with the least coefficient until the sign is certain, at most `max_splits` times. Corners
/// alone do not prove a hex valid; this does. Tries positive_near_affine first: about a fifth of the time.
JacobianSign jacobian_sign(const HexCornerPoints& corners, int max_splits = 50);

}  // namespace flowcage
