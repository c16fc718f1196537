#pragma once
#include "core/project/trimmed_cells.hpp"

namespace flowcage {

/// The nearest point of a cell's two triangles: the surface is within the cell's slack of it.
struct CellStart {
  Vec2 fraction;  ///< where in the cell's box, in [0, 1]^2
  double distance;
};

CellStart cell_start(const PatchCell& cell, const Vec3& query);

}  // namespace flowcage
