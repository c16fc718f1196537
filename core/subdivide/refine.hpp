#pragma once
#include <span>
#include <vector>

#include "core/mesh/stencil_table.hpp"
#include "core/mesh/surface_level.hpp"

namespace flowcage {

/// Catmull-Clark refinement (Catmull & Clark 1978) with infinitely sharp and semi-sharp creases, corners and
/// darts (DeRose, Kass & Truong 1998), uniform crease decay by 1 a level, and boundaries by the
/// edge-and-corner rule, or as inner edges where they are mirrored (mirror.hpp); agrees with OpenSubdiv
/// (tests/oracle). Numbering of children: see SurfaceLevel.

/// Topology and sharpness of the next level.
SurfaceLevel build_child_level(const SurfaceLevel& parent);

/// Child points as combinations of the level's: #V + #E + #F rows in the child's vertex order.
StencilTable refinement_stencils(const SurfaceLevel& level);

/// A cage's levels 0 .. depth.
std::vector<SurfaceLevel> build_levels(const Cage& cage, int depth);

/// Points of levels.back() from those of levels.front(). Precondition: consecutive levels.
std::vector<Vec3> refine_points(std::span<const SurfaceLevel> levels, std::vector<Vec3> points);

}  // namespace flowcage
