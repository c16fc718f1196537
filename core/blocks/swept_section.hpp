#pragma once
#include <array>
#include <optional>
#include <vector>

#include "core/target/target_surface.hpp"

namespace flowcage {

/// Axes of a swept body, unit and right-handed: (chord, span, normal), like x, y, z of a wing whose chord
/// runs downstream along x and whose span along y. A place is u chord + s span + w normal, metres.
struct SweptAxes {
  Vec3 chord = Vec3::UnitX(), span = Vec3::UnitY(), normal = Vec3::UnitZ();

  Vec3 place(double u, double s, double w) const { return u * chord + s * span + w * normal; }
  Vec2 section_place(const Vec3& p) const { return {chord.dot(p), normal.dot(p)}; }
};

/// A plane cut through a tessellation: unordered segments, each with the material on its left when seen
/// against the span.
struct PlaneCut {
  std::vector<std::array<Vec3, 2>> segments;
  double perimeter = 0, area = 0;
  Index components = 0;  ///< connected pieces; ends nearer than `gap` belong together, slivers do not count
};
PlaneCut cut_plane(const Tessellation& tessellation, const Vec3& span, double s, double gap);

/// What ends the rear of a section: one sharp edge, two with a base between them, or none.
enum class TrailingEdge : std::uint8_t { sharp, blunt, round };

/// An airfoil section in a plane across the span.
struct AirfoilSection {
  double s = 0;                    ///< along the span
  Vec2 leading = Vec2::Zero();     ///< (u, w) of the leading edge,
  Vec2 trailing = Vec2::Zero();    ///< of the trailing edge or the middle of its base
  Vec2 base_upper = Vec2::Zero();  ///< ends of the base; both the trailing edge without one
  Vec2 base_lower = Vec2::Zero();
  std::vector<std::array<Vec2, 2>> segments;  ///< the cut
  TrailingEdge kind = TrailingEdge::round;

  double chord() const { return (trailing - leading).norm(); }
  /// Upper and lower point at a fraction of the chord, on the line across it; none where it misses.
  std::optional<std::array<Vec2, 2>> across(double fraction) const;
  /// Largest distance of upper and lower side at 20 fractions of the chord.
  double thickness() const;
};

/// The airfoil in a cut: leading and trailing edge are the two points farthest from each other; the trailing
/// edge is the end toward `chord`'s direction. Sharp feature chains of the target that pass the plane within
/// 8 % of the chord at that end tell the trailing edge's kind. None where the cut is empty.
std::optional<AirfoilSection> airfoil_section(const TargetSurface& target, const SweptAxes& axes, double s);

}  // namespace flowcage
