#pragma once
#include <span>
#include <vector>

#include "core/blocks/swept_blocks.hpp"

namespace flowcage {

/// Straightens the lines across the base of a blunt trailing edge: every inner vertex of the base, in control
/// or limit points of a level of the fit, comes to lie on the straight line between the two edges' vertices
/// of its row, evenly spaced. A base is a few thousandths of the chord wide and a cell there a hundred times
/// as long, so that a fit, which sees distances across the surface only, lets its inner vertices drift along
/// it by more than the width; between control points of two matched creases the straight line is the ruled
/// surface. `cut`: blocks.wall refined to the level. Without a blunt trailing edge nothing moves.
void straighten_base(const SweptBlocks& swept, const SurfaceLevel& cut, const SurfaceLevel& level,
                     std::span<Vec3> points);

}  // namespace flowcage
