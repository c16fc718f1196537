#pragma once
#include <span>

#include "core/cage/lint_report.hpp"
#include "core/mesh/surface_level.hpp"
#include "core/target/target_surface.hpp"

namespace flowcage {

/// Throws Error(input), with the numbers, when the cage cannot belong to the target: its size differs as
/// between two units (the remedy names the factor and the units), it lies too far away, or it is turned
/// inside out.
/// points: #V control points; limits, normals: #V limit points and unit normals (zero where there is none);
/// source: the cage's file for the message, or "".
struct CageToCheck {
  const SurfaceLevel& level;
  std::span<const Vec3> points;
  std::span<const Vec3> normals;
  const std::string& source;
};
void check_cage_belongs(const CageToCheck& cage, const TargetSurface& target);

/// The same for a cage whose limit points were not made yet.
void check_cage_belongs(const Cage& cage, const TargetSurface& target);

struct TurnedCage {
  Cage cage;
  LintReport findings;  ///< rule "inside_out", one a part that was turned
};

/// Reverses the connected parts of a cage that are turned inside out: their normals point against the
/// target's and they enclose a negative volume (open ones with their boundary closed to its middle). A part
/// that encloses a positive volume is left: there the target's faces point the wrong way.
TurnedCage turn_parts_outside(const Cage& cage, const TargetSurface& target);

}  // namespace flowcage
