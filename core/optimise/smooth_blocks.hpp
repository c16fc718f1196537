#pragma once
#include "core/blocks/shell.hpp"
#include "core/optimise/untangle.hpp"

namespace flowcage {

/// How the points of a shell's mesh may move: walls stay where the fit put them, symmetry planes slide in
/// themselves (those across an axis; others stay), a grown far field slides on its sphere or on the sides and
/// edges of its box, a drawn outer polyhedron stays.
struct BoundaryFreedom {
  std::vector<PointFreedom> points;   ///< #points
  std::vector<Projector> projectors;  ///< that they number
};
BoundaryFreedom boundary_freedom(const BlockMesh& mesh, const Shell& shell);

/// Draws the blocks toward right-angled cells of even size along and across the lines, untangled first where
/// need be (optimise/untangle); never worse than before.
void smooth_blocks(BlockMesh& mesh, const Shell& shell, Progress& progress);

/// Mends inverted and unproved cells; the rest of a valid mesh keeps every bit.
void mend_blocks(BlockMesh& mesh, const Shell& shell, Progress& progress);

}  // namespace flowcage
