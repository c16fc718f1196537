#include "core/blocks/grid_lines.hpp"

#include <algorithm>
#include <cmath>

namespace flowcage {
namespace {

/// Anchors sorted, near ones merged into the heavier; a chart that faces down and one that faces up are the
/// two sides of something thin, and stay apart.
std::vector<double> merged(std::vector<LineAnchor> anchors, double width) {
  std::sort(anchors.begin(), anchors.end(), [](const LineAnchor& a, const LineAnchor& b) {
    return std::tie(a.value, a.side, a.weight) < std::tie(b.value, b.side, b.weight);
  });
  for (bool again = true; again;) {
    again = false;
    std::size_t best = 0;
    double least = width;
    for (std::size_t n = 0; n + 1 < anchors.size(); ++n) {
      const bool opposite = anchors[n].side * anchors[n + 1].side < 0;
      const double gap = anchors[n + 1].value - anchors[n].value;
      if (gap < least && !(opposite && gap > 1e-3 * width)) {
        least = gap;
        best = n;
        again = true;
      }
    }
    if (!again) break;
    LineAnchor& keep = anchors[best];
    const LineAnchor& other = anchors[best + 1];
    const double weight = keep.weight + other.weight;
    if (other.weight > keep.weight) keep.value = other.value;
    keep.side = keep.side == other.side ? keep.side : 0;
    keep.weight = weight;
    anchors.erase(anchors.begin() + static_cast<std::ptrdiff_t>(best) + 1);
  }
  std::vector<double> values;
  for (const LineAnchor& a : anchors) values.push_back(a.value);
  return values;
}

/// Lines from the body to a side of the box, spacings growing from `size`; `from` is not repeated.
std::vector<double> growing(double from, double to, double size, double growth) {
  const double distance = std::abs(to - from);
  std::vector<double> steps;
  double total = 0;
  for (double step = size; total < distance; step *= growth) {
    steps.push_back(step);
    total += step;
  }
  if (steps.size() > 1 && total - distance > 0.5 * steps.back()) {
    total -= steps.back();
    steps.pop_back();
  }
  std::vector<double> lines;
  double sum = 0;
  for (const double step : steps) {
    sum += step * distance / total;
    lines.push_back(from + (to > from ? sum : -sum));
  }
  lines.back() = to;
  return lines;
}

}  // namespace

std::array<std::vector<double>, 3> grid_lines(const AmbientFrame& frame,
                                              const std::array<std::vector<LineAnchor>, 3>& anchors,
                                              double growth, double merge) {
  std::array<std::vector<double>, 3> result;
  for (int axis = 0; axis < 3; ++axis) {
    const double size = frame.size[axis];
    const double low = frame.far.min()[axis], high = frame.far.max()[axis];
    std::vector<double> fixed = merged(anchors[axis], merge * size);
    std::erase_if(fixed, [&](double v) { return v <= low + 1e-9 * size || v >= high - 1e-9 * size; });
    std::vector<double>& lines = result[axis];
    const bool cut_low = frame.sides[2 * axis].at_body, cut_high = frame.sides[2 * axis + 1].at_body;
    if (cut_low) fixed.insert(fixed.begin(), low);
    if (cut_high) fixed.push_back(high);
    for (std::size_t n = 0; n < fixed.size(); ++n) {
      if (n > 0) {
        const double gap = fixed[n] - fixed[n - 1];
        const int parts = std::max(1, static_cast<int>(std::lround(gap / size)));
        for (int p = 1; p < parts; ++p) lines.push_back(fixed[n - 1] + gap * p / parts);
      }
      lines.push_back(fixed[n]);
    }
    if (!cut_low) {
      const std::vector<double> outside = growing(lines.front(), low, size, growth);
      lines.insert(lines.begin(), outside.rbegin(), outside.rend());
    }
    if (!cut_high) {
      const std::vector<double> outside = growing(lines.back(), high, size, growth);
      lines.insert(lines.end(), outside.begin(), outside.end());
    }
  }
  return result;
}

}  // namespace flowcage
