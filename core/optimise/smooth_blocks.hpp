#pragma once
#include <functional>

#include "core/blocks/shell.hpp"
#include "core/optimise/untangle.hpp"

namespace flowcage {

/// How the points of a mesh may move. Walls stay where the fit put them.
struct BoundaryFreedom {
  std::vector<PointFreedom> points;   ///< #points
  std::vector<Projector> projectors;  ///< that they number
};
/// Of a shell: symmetry planes slide in themselves (those across an axis; others stay), a grown far field
/// slides on its sphere or on the sides and edges of its box, a drawn outer polyhedron stays.
BoundaryFreedom shell_freedom(const BlockMesh& mesh, const Shell& shell);
/// Of blocks in a box: boundary quads off the wall slide in their plane where that is across an axis, others
/// stay.
BoundaryFreedom planar_freedom(const HexView& mesh);

/// Draws the blocks toward right-angled cells of even size along and across the lines, untangled first where
/// need be (optimise/untangle); never worse than before.
void smooth_blocks(BlockMesh& mesh, BoundaryFreedom freedom, Progress& progress);

/// Mends inverted and unproved cells; the rest of a valid mesh keeps every bit. `freedom` is called only
/// where there are such. Returns what remains of them.
CellProof mend_blocks(BlockMesh& mesh, const std::function<BoundaryFreedom()>& freedom, Progress& progress);

}  // namespace flowcage
