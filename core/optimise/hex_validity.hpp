#pragma once
#include <span>

#include "core/optimise/hex_corner.hpp"

namespace flowcage {

/// Validity and shape of hexes. Scaled Jacobian: see corner_scaled_jacobian; 1 in an empty mesh.
struct HexValidity {
  Offset inverted = 0;     ///< the Jacobian is not positive at a corner
  Offset uncertified = 0;  ///< positive at the corners, but not proved positive inside (jacobian_sign)
  double min_scaled_jacobian = 1;
  double mean_scaled_jacobian = 1;
};

/// How many cells of a mesh are not sound: what remains of HexValidity where shapes are not asked for.
struct CellProof {
  Offset inverted = 0;     ///< as in HexValidity
  Offset uncertified = 0;  ///< as in HexValidity
  bool all_sound() const { return inverted == 0 && uncertified == 0; }
};

/// Of all cells of a mesh, read as they come: no memory. Fast where cells are nearly parallelepipeds.
CellProof prove_cells(const HexView& mesh);

/// Of the cells into `points`. The same bits for any number of threads.
HexValidity measure_validity(std::span<const HexPoints> cells, std::span<const Vec3> points);

/// Positions of a cell's corners.
inline HexCornerPoints corner_points(std::span<const Vec3> points, const HexPoints& cell) {
  HexCornerPoints p;
  for (int c = 0; c < 8; ++c) p[c] = points[cell[c]];
  return p;
}

}  // namespace flowcage
