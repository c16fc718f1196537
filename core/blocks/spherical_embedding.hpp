#pragma once
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/blocks/match_polyhedra.hpp"
#include "core/blocks/symmetry_plane.hpp"

namespace flowcage {

/// A map of a closed surface of genus 0 (or of a half model with one rim in the symmetry plane) to the unit
/// sphere (half sphere) without folds: every corner a of every quad with its neighbours b, c has
/// det(a, b, c) > 0, and the quads cover the sphere once. The far field grows from it.
struct SphericalEmbedding {
  std::vector<Vec3> directions;  ///< #V, unit; rim vertices exactly in the plane
  double min_determinant = 0;    ///< least det(a, b, c) over the mean area of a quad; 1 for a perfect square
  double min_wall_cosine = 0;    ///< least cosine between a direction and the wall's normals at its corners
  int iterations = 0;
};

/// Start: places relative to a centre inside of the body, made round by the inverse square root of the
/// surface's covariance (no rotation: what lies above goes up), so thin and swept bodies start nearly
/// spherical. Then L-BFGS on the regularised barrier energy of Garanzha et al. ("Foldover-free maps in 50
/// lines of code", ACM TOG 40, 2021) in two dimensions, at every quad corner
///   (|b-a|^2 + |c-a|^2) / (2 chi(D)) + lambda (D^2 / A + A) / chi(D),   D = det(a, b, c), A = quad area,
/// chi(D) = (D + sqrt(eps^2 + D^2)) / 2, with eps lowered until every D is positive: shapes square, sizes
/// even. A second barrier on n . a, n the wall's normal at that corner, keeps the line that leaves the wall
/// toward a on the fluid's side, so that the shell's cells are valid at both ends.
/// Precondition: quads only, connected, genus 0. Throws Error(input), naming `source`, when folds remain.
SphericalEmbedding embed_on_sphere(const Polyhedron& surface, const std::optional<SymmetryPlane>& plane,
                                   const std::string& source);

}  // namespace flowcage
