#pragma once
#include <array>
#include <cstddef>

namespace flowcage {

/// sRGB, each in [0, 1].
struct Rgb {
  double r = 0, g = 0, b = 0;
};

/// Colours of things that have no order (patches, blocks): evenly spread hues, the same in every run.
Rgb palette_color(std::size_t index);

/// From bad (0) over pale yellow to good (1): red and blue, which colour-blind people tell apart.
/// Evenly spaced; between them linear.
inline constexpr std::array<Rgb, 7> verdict_stops{{{0.65, 0.06, 0.14},
                                                   {0.87, 0.30, 0.18},
                                                   {0.99, 0.66, 0.36},
                                                   {1.00, 0.95, 0.70},
                                                   {0.62, 0.83, 0.90},
                                                   {0.29, 0.56, 0.76},
                                                   {0.16, 0.27, 0.60}}};
/// Beyond the bad end of a scale: inverted cells, a deviation above the tolerance.
inline constexpr Rgb failure_color{0.85, 0.0, 0.85};
/// Where there is nothing to judge.
inline constexpr Rgb neutral_color{0.78, 0.81, 0.85};

/// What is bad and what is good. `bad` may be the larger or the smaller one; logarithmic: both positive.
struct VerdictScale {
  double bad = 0, good = 1;
  bool logarithmic = false;
};

/// The scaled Jacobian of cells: from degenerate to a box.
inline constexpr VerdictScale jacobian_scale{0, 1, false};
/// Deviations in the CAD's diagonals: from the tolerance down to 1e-4 of it.
VerdictScale deviation_scale(double tolerance);

/// The colour of a value; beyond the bad end (for the scaled Jacobian: at it, too) failure_color.
Rgb verdict_color(const VerdictScale& scale, double value);

}  // namespace flowcage
