#pragma once
#include <span>
#include <vector>

#include "core/curve/curved_mesh.hpp"
#include "core/optimise/jacobian_bound.hpp"

namespace flowcage {

/// det J over a Lagrange hex of order p with equally spaced nodes is a tensor polynomial of degree 3p - 1 in
/// each coordinate, so it lies within the convex hull of its (3p)^3 Bernstein coefficients; those at the
/// eight ends are the Jacobians at the corners. (Johnen, Remacle, Geuzaine, J. Comput. Phys. 233, 2013.)

/// The coefficients, i fastest, for nodes as CurvedMesh::read_cell orders them. Unit: metre^3, 1 for a unit
/// cube. Precondition: (order + 1)^3 nodes, 1 <= order <= 4.
std::vector<double> curved_jacobian_bernstein(std::span<const Vec3> nodes, int order);

/// What is proved of det J over the whole cell, rounding included: the part with the least coefficient is
/// split in 8 until the sign is certain, at most `max_splits` times.
JacobianSign curved_jacobian_sign(std::span<const Vec3> nodes, int order, int max_splits = 20);

struct CurvedValidity {
  Offset not_positive = 0;  ///< cells where det J <= 0 at a point that was found
  Offset undecided = 0;     ///< cells not proved positive
  double min_ratio = 1;   ///< least over the cells: least Bernstein coefficient / largest, unsplit; 1: affine
  Offset worst_cell = 0;  ///< where that is
  Vec3 worst_place = Vec3::Zero();
};

/// Of all cells. The same bits for any number of threads.
CurvedValidity measure_curved_validity(const CurvedMesh& mesh);

}  // namespace flowcage
