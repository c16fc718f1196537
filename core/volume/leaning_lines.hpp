#pragma once
#include "core/blocks/wall_blocks.hpp"
#include "core/mesh/block_mesh.hpp"

namespace flowcage {

/// How long the first cell of a line may be that leans over a face of the wall.
struct LeanSettings {
  double most_lean = 1.5;  ///< its shift along the face, in lengths of the wall's edge on that side
  double slope = 0.5;      ///< of the bound over the wall
  double keep = 0.9, good_enough = 0.3;  ///< a cell may lose a tenth of its scaled Jacobian, or more above
};

/// Shortens the first cells of lines that leave a sharp convex edge (a trailing edge) of the wall. Such a
/// line runs on nearly in the plane of the faces beside it: of their cells the centre moves off the face by a
/// third of the first height, which in half extents of the face is OpenFOAM's skewness. With c the cosine
/// between the line and the prolonged wall edge e behind its foot, the first height is kept below most_lean
/// |e| / c; over the wall the bound rises at most by `slope`. A shortened line is drawn in
/// smoothly over its first eight cells' length, on its own curve; its ends stay. Lines at an end of the
/// wall's net that other blocks share stay as they are, and the others of cells that would lose too much are
/// shortened by less, at last not at all. Deterministic. Returns the number of lines that were shortened.
Index shorten_leaning_lines(BlockMesh& mesh, const WallBlocks& blocks, const LeanSettings& settings = {});

}  // namespace flowcage
