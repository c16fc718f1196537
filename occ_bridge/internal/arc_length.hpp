#pragma once
#include <array>
#include <functional>
#include <span>
#include <vector>

namespace flowcage {

/// Arc length of a parametric curve as a function of its parameter and back, to about 1e-12 of the length,
/// without evaluating the curve again.
///
/// The speed |c'(t)| is interpolated in Chebyshev points on panels that are halved until the last
/// coefficients vanish (Trefethen, Approximation Theory and Approximation Practice, 2013, ch. 3 and 19); the
/// interpolant is integrated exactly, and inverted by a safeguarded Newton iteration.
class ArcLengthTable {
 public:
  /// `speed(t)`: |dc/dt| >= 0 on [breaks.front(), breaks.back()], smooth between neighbouring breaks.
  /// Precondition: breaks ascend strictly, at least two.
  ArcLengthTable(const std::function<double(double)>& speed, std::span<const double> breaks);

  double length() const { return panels_.back().s + panels_.back().length; }
  /// Arc length from the first break to t (clamped).
  double s_of(double t) const;
  /// The parameter at arc length s (clamped to [0, length]).
  double t_of(double s) const;

 private:
  static constexpr int order = 16;
  struct Panel {
    double t = 0, width = 0, s = 0, length = 0;
    std::array<double, order + 1> integral{};  ///< Chebyshev coefficients of s - panel.s on [-1, 1]
  };
  void add_panels(const std::function<double(double)>& speed, double t, double width, int depth);
  static double local_length(const Panel& panel, double x);

  std::vector<Panel> panels_;
  double rough_length_ = 0;
};

}  // namespace flowcage
