#pragma once
#include "core/base/progress.hpp"
#include "core/blocks/ambient_grid.hpp"
#include "core/mesh/block_mesh.hpp"
#include "core/optimise/untangle.hpp"
#include "core/refit/fit_surface.hpp"

namespace flowcage {

/// Automatic blocks whose points were placed: the wall's on the CAD, the others untangled.
struct PlacedBlocks {
  AmbientBlocks blocks;  ///< complex.points and cage.points are the placed ones
  UntangleReport untangle;
  std::vector<Index> unmatched_chains;  ///< of the CAD, that no crease of the cage follows
};

/// Puts the wall's points where the fit's level 0 wants them on the CAD (fit_surface.hpp), moves the others
/// along and untangles them. Points in symmetry planes stay in them, those of the far field do not move.
PlacedBlocks place_blocks(AmbientBlocks blocks, const TargetSurface& target, Progress& progress);

}  // namespace flowcage
