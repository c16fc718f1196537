#include "occ_bridge/internal/arc_length.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace flowcage {

namespace {

/// Sum of c[k] T_k(x) by Clenshaw's recurrence.
template <std::size_t N>
double chebyshev_sum(const std::array<double, N>& c, double x) {
  double b1 = 0, b2 = 0;
  for (std::size_t k = N - 1; k > 0; --k) {
    const double b0 = c[k] + 2 * x * b1 - b2;
    b2 = b1;
    b1 = b0;
  }
  return c[0] + x * b1 - b2;
}

}  // namespace

ArcLengthTable::ArcLengthTable(const std::function<double(double)>& speed, std::span<const double> breaks) {
  for (std::size_t i = 0; i + 1 < breaks.size(); ++i) {
    rough_length_ += speed(0.5 * (breaks[i] + breaks[i + 1])) * (breaks[i + 1] - breaks[i]);
  }
  for (std::size_t i = 0; i + 1 < breaks.size(); ++i) {
    add_panels(speed, breaks[i], breaks[i + 1] - breaks[i], 0);
  }
  double s = 0;
  for (Panel& panel : panels_) {
    panel.s = s;
    s += panel.length;
  }
}

void ArcLengthTable::add_panels(const std::function<double(double)>& speed, double t, double width,
                                int depth) {
  std::array<double, order> value{};
  for (int j = 0; j < order; ++j) {
    const double x = std::cos(std::numbers::pi * (j + 0.5) / order);
    value[j] = speed(t + 0.5 * width * (1 + x));
  }
  std::array<double, order + 2> c{};  // two zeros behind, for the integration below
  double largest = 0;
  for (int k = 0; k < order; ++k) {
    for (int j = 0; j < order; ++j) {
      c[k] += value[j] * std::cos(std::numbers::pi * k * (j + 0.5) / order);
    }
    c[k] *= (k == 0 ? 1.0 : 2.0) / order;
    largest = std::max(largest, std::abs(c[k]));
  }
  // Halving ends where the polynomial is exact to rounding, or where its error cannot be seen in the whole
  // length: a speed that vanishes at an end, or one whose own rounding is large, never converges.
  constexpr int deepest = 24;
  const double tail = std::abs(c[order - 1]) + std::abs(c[order - 2]);
  const bool converged = tail <= 2e-14 * largest || tail * width <= 1e-13 * rough_length_;
  if (!converged && depth < deepest) {
    add_panels(speed, t, 0.5 * width, depth + 1);
    add_panels(speed, t + 0.5 * width, 0.5 * width, depth + 1);
    return;
  }
  Panel panel{.t = t, .width = width};
  c[0] *= 2;  // the integration formula wants the halved first coefficient written in full
  double at_start = 0;
  for (int k = 1; k <= order; ++k) {
    panel.integral[k] = 0.5 * width * (c[k - 1] - c[k + 1]) / (2.0 * k);
    at_start += k % 2 == 0 ? panel.integral[k] : -panel.integral[k];
  }
  panel.integral[0] = -at_start;
  panel.length = std::max(0.0, chebyshev_sum(panel.integral, 1.0));
  panels_.push_back(panel);
}

double ArcLengthTable::local_length(const Panel& panel, double x) {
  return std::clamp(chebyshev_sum(panel.integral, x), 0.0, panel.length);
}

double ArcLengthTable::s_of(double t) const {
  auto next = std::ranges::upper_bound(panels_, t, {}, &Panel::t);
  const Panel& panel = next == panels_.begin() ? panels_.front() : *std::prev(next);
  const double x = std::clamp(2 * (t - panel.t) / panel.width - 1, -1.0, 1.0);
  return panel.s + local_length(panel, x);
}

double ArcLengthTable::t_of(double s) const {
  auto next = std::ranges::upper_bound(panels_, s, {}, &Panel::s);
  const Panel& panel = next == panels_.begin() ? panels_.front() : *std::prev(next);
  const double target = std::clamp(s - panel.s, 0.0, panel.length);
  if (panel.length <= 0) return panel.t;
  double low = -1, high = 1;
  double x = 2 * target / panel.length - 1;
  double previous = x > 0 ? low : high;
  double previous_error = local_length(panel, previous) - target;
  for (int i = 0; i < 60; ++i) {
    const double error = local_length(panel, x) - target;
    (error > 0 ? high : low) = x;
    if (std::abs(error) <= 1e-15 * panel.length || high - low < 1e-15) break;
    // Secant steps, with bisection where they leave the bracket: the length grows monotonically.
    double step_to = x - error * (x - previous) / (error - previous_error);
    if (!(step_to > low && step_to < high)) step_to = 0.5 * (low + high);
    previous = x;
    previous_error = error;
    x = step_to;
    if (x == previous) break;
  }
  return panel.t + 0.5 * panel.width * (1 + x);
}

}  // namespace flowcage
