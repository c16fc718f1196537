#pragma once
#include <memory>
#include <string>
#include <vector>

#include "core/blocks/swept_cage.hpp"
#include "core/blocks/wall_blocks.hpp"

namespace flowcage {

struct SweptSettings {
  double body_lengths = 20;  ///< half the box's edge in largest extents of the body (as FarField)
};

/// A corner of the blocks: a vertex of the plan at a level along the span (the fine wall's, far planes
/// beyond).
struct SweptCorner {
  Index level = 0, vertex = 0;
};

/// Blocks of C-H topology round a wing or blade: the plan (swept_plan.hpp) swept along the span from the
/// symmetry plane (or the far field beyond the first end) to the far field, the plug left out between the
/// body's sections: that hole is the body. C and wake blocks go on past the ends, the plug carries the cap's
/// pattern outward.
///
/// Patches: wall, farfield (a box with sharp edges, its sides across `axes`), symmetry (across the span) of
/// half models. Every face of the wall has its own block; at trailing edges and rims of the ends several
/// lines leave a wall vertex: `wall` is cut open there, so that each of its vertices has one line.
struct SweptBlocks {
  SweptBody body;
  SweptPlan plan;
  Cage cage;          ///< what refit/fit_surface takes; its level 1 is the blocks' wall
  WallBlocks blocks;  ///< wall: the cut cage; cage_level 0: its levels are counted from the blocks' on
  std::vector<Index> cage_vertex;     ///< #V of blocks.wall: vertex of the cage's level 1
  std::vector<std::uint8_t> outward;  ///< #corners: bit 0 on the box's sides, bit 1 at the wake's end, bit 2
                                      ///< beyond an end of the span; edges from 0 to 1 are outward
  std::vector<SweptCorner> corners;   ///< #corners
  SweptAxes box_axes;                 ///< of the box: coordinate axes where the span is one
};

/// Throws Error(input), naming `source` and the place, when the CAD is no swept body (find_swept_body), and
/// Error(usage) when the box does not clear it.
SweptBlocks make_swept_blocks(const TargetSurface& target, const SweptSettings& settings,
                              const std::string& source);

/// Points of a level of the fit, reordered and repeated for the cut wall refined to the same level: place v
/// of `cut` (levels of blocks.wall) is that vertex of `level` which lies at the same corner of the same face.
std::vector<Index> cut_vertices(const SurfaceLevel& cut, const SurfaceLevel& level);

}  // namespace flowcage
