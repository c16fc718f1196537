#pragma once
#include <optional>

#include "core/cage/lint_report.hpp"
#include "core/mesh/cage.hpp"
#include "core/mesh/surface_level.hpp"
#include "core/target/target_surface.hpp"

namespace flowcage {

/// Components, boundary loops and genus of the target, from its tessellation with points that coincide merged
/// (1e-7 of the diagonal). None where the faces do not make one oriented surface (gaps, parts that overlap or
/// touch): then nothing can be said.
std::optional<Topology> target_topology(const TargetSurface& target);

/// Compares the topology of a cage with that of the target.
/// Throws Error(input) where both are closed and of one piece, and their genus differs: no fit can help.
/// Warnings (rule "open_boundary") where only one of them is open.
LintReport lint_cage_topology(const Cage& cage, const TargetSurface& target);

}  // namespace flowcage
