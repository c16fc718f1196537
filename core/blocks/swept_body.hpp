#pragma once
#include <string>
#include <vector>

#include "core/blocks/swept_section.hpp"
#include "core/target/target_surface.hpp"

namespace flowcage {

/// How a swept body ends along its span.
enum class SweptEnd : std::uint8_t { open, flat, rounded };

/// A wing or blade: sections from one end to the other along the span.
struct SweptBody {
  SweptAxes axes;
  std::array<SweptEnd, 2> ends{SweptEnd::open, SweptEnd::flat};  ///< at the first and last section
  std::array<double, 2> reach{0, 0};  ///< where the body ends; beyond the sections of rounded ends, metres
  TrailingEdge trailing = TrailingEdge::sharp;
  std::vector<AirfoilSection> sections;  ///< ascending s: where rings of the cage lie
  std::vector<std::string> warnings;
};

/// Finds span axis, chord, trailing edge, ends and stations of a wing or blade in CAD; the first end is the
/// open one where there is one. Span axis: of the coordinate axes and the normals of planar open borders the
/// one along which the body is longest in mean section diameters, with one connected section in nearly all of
/// 13 cuts; a principal axis (they tilt on swept wings) only where it is 1.6 times better and
/// no open or flat end lies across the other. Stations: where
/// leading edge, trailing edge or thickness leave the straight line between their neighbours by more than 0.5
/// % of the chord, half a chord inside a closed end, and no spacing above 2.5 chords or twice its
/// neighbour's.
///
/// Throws Error(input), naming `source`, the reason and the place, when the body is no swept one: no such
/// axis, separate sections, sections thicker than half their chord, an end that is neither open, flat nor
/// rounded.
SweptBody find_swept_body(const TargetSurface& target, const std::string& source);

}  // namespace flowcage
