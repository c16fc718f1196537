#pragma once
#include "core/cage/lint_report.hpp"
#include "core/mesh/cage.hpp"
#include "core/target/target_surface.hpp"

namespace flowcage {

struct TaggedTips {
  Cage cage;
  LintReport findings;  ///< rule "tip": mended where a vertex was made a corner, a warning where none is near
};

/// The cage with a corner at each tip of the target (the apex of a cone): a smooth vertex would round it off
/// by a share of the cell. Precondition: a manifold.
TaggedTips tag_tips(const Cage& cage, const TargetSurface& target);

}  // namespace flowcage
