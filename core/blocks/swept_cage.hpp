#pragma once
#include <vector>

#include "core/blocks/swept_body.hpp"
#include "core/blocks/swept_plan.hpp"
#include "core/mesh/cage.hpp"

namespace flowcage {

/// A vertex of the cage: which vertex of the plan at which section.
struct SweptPlace {
  Index section = 0, vertex = 0;
  bool operator==(const SweptPlace&) const = default;
};

/// The wall cage of a swept body: one ring of the plan's coarse vertices a section (leading edge, 0.2 and
/// 0.65 chord on both sides, trailing edge), joined along the span, and the plan's plug as cap of each closed
/// end. Right side out. Creases: the sharp trailing edge or both edges of the base, between sections that
/// both have it, and the rims of flat ends; corners where the trailing edge meets a rounded end.
struct SweptCage {
  Cage cage;
  std::vector<SweptPlace> places;  ///< #V
};
SweptCage make_swept_cage(const TargetSurface& target, const SweptBody& body, const SweptPlan& plan);

}  // namespace flowcage
