#include "cli/report/color_map.hpp"

#include <algorithm>
#include <cmath>

namespace flowcage {

Rgb palette_color(std::size_t index) {
  // Hues a golden section apart never come together.
  const double hue = std::fmod(0.58 + 0.618034 * static_cast<double>(index), 1.0) * 6;
  const auto channel = [&](double shift) {
    const double k = std::fmod(shift + hue, 6.0);
    return 0.92 - 0.42 * std::max(0.0, std::min({k, 4 - k, 1.0}));
  };
  return {channel(5), channel(3), channel(1)};
}

VerdictScale deviation_scale(double tolerance) {
  return {tolerance, 1e-4 * tolerance, true};
}

Rgb verdict_color(const VerdictScale& scale, double value) {
  double t = 0;
  if (scale.logarithmic) {
    t = value > 0 ? std::log(value / scale.bad) / std::log(scale.good / scale.bad) : 1;
  } else {
    t = (value - scale.bad) / (scale.good - scale.bad);
  }
  if (!(t >= 0) || (t == 0 && !scale.logarithmic)) return failure_color;
  const double at = std::min(t, 1.0) * (verdict_stops.size() - 1);
  const std::size_t low = std::min(static_cast<std::size_t>(at), verdict_stops.size() - 2);
  const double f = at - static_cast<double>(low);
  const Rgb &a = verdict_stops[low], &b = verdict_stops[low + 1];
  return {a.r + f * (b.r - a.r), a.g + f * (b.g - a.g), a.b + f * (b.b - a.b)};
}

}  // namespace flowcage
