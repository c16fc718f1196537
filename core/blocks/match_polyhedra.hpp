#pragma once
#include <span>
#include <vector>

#include "core/mesh/surface_level.hpp"

namespace flowcage {

/// A polyhedron: topology and the places of its vertices.
struct Polyhedron {
  const SurfaceLevel& level;
  std::span<const Vec3> points;
};

/// The vertex of `b` for each vertex of `a` under an isomorphism that keeps faces and orientation. Empty when
/// there is none. Both connected.
///
/// An isomorphism of connected oriented surfaces is fixed by the image of one face and one of its corners:
/// each candidate is spread over the neighbours and dropped at the first disagreement, O(#F) each. Among
/// several (symmetric polyhedra) the one with the least total squared distance is taken, after both were
/// moved to their centroids and scaled to radius of gyration 1; among equals (1e-9) that with the
/// lexicographically smallest images, so the result does not depend on how b is numbered.
std::vector<Index> match_vertices(const Polyhedron& a, const Polyhedron& b);

}  // namespace flowcage
