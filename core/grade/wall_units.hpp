#pragma once

namespace flowcage {

/// Height of the first cell, in units of `length`, whose outer points have the given y+ on a flat plate with
/// a turbulent boundary layer, at the distance `length` from its leading edge:
///   c_f = 0.026 / Re^(1/7)  (the one-seventh power law, as usual in estimates of y+),
///   y / L = y+ / (Re sqrt(c_f / 2)).
/// An estimate before the first run: y+ of a real flow varies along the wall.
/// Precondition: both positive.
double first_height_of_yplus(double yplus, double reynolds);

}  // namespace flowcage
