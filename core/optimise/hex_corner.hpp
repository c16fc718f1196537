#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/mesh/hex_numbering.hpp"

namespace flowcage {

using HexCornerPoints = std::array<Vec3, 8>;  ///< positions of a hex's corners, VTK order

/// The corner reached from corner c along axis a (0: i, 1: j, 2: k).
constexpr int hex_corner_neighbour(int c, int a) {
  std::array<int, 3> ijk = hex_corner_ijk[c];
  ijk[a] = 1 - ijk[a];
  return hex_corner_at(ijk[0], ijk[1], ijk[2]);
}

/// The edge (order of hex_edges) that leaves corner c along axis a.
constexpr int hex_corner_edge(int c, int a) {
  const std::array<int, 3> ijk = hex_corner_ijk[c];
  const int first = a == 0 ? 1 : 0;
  const int second = a == 2 ? 1 : 2;
  return 4 * a + ijk[first] + 2 * ijk[second];
}

/// Jacobian determinant over the product of the edge lengths at corner c, in [-1, 1]; 0 where an edge has no
/// length, NaN where a coordinate is not finite. Independent of the hex's size.
inline double corner_scaled_jacobian(const HexCornerPoints& p, int c) {
  std::array<Vec3, 3> e;
  for (int a = 0; a < 3; ++a) {
    const double sign = hex_corner_ijk[c][a] == 0 ? 1.0 : -1.0;
    e[a] = sign * (p[hex_corner_neighbour(c, a)] - p[c]);
    const double square = e[a].squaredNorm();
    const bool normal_range = square > 1e-280 && square < 1e280;
    const double length = normal_range ? std::sqrt(square) : e[a].stableNorm();
    if (length == 0) return 0;
    e[a] /= length;
  }
  return e[0].dot(e[1].cross(e[2]));
}

/// Least corner_scaled_jacobian of the eight; the cell is inverted when it is not positive.
inline double min_scaled_jacobian(const HexCornerPoints& p) {
  double least = std::numeric_limits<double>::infinity();
  for (int c = 0; c < 8; ++c) {
    const double value = corner_scaled_jacobian(p, c);
    if (std::isnan(value)) return value;
    least = std::min(least, value);
  }
  return least;
}

}  // namespace flowcage
