#include "core/limit/spline_interpolation.hpp"

#include <algorithm>

#include "core/target/bspline_basis.hpp"

namespace flowcage {

CubicInterpolation::CubicInterpolation(std::vector<double> knots) : knots_(std::move(knots)) {
  const int n = static_cast<int>(knots_.size()) - 4;
  band_.assign(7 * static_cast<std::size_t>(n), 0);
  for (int r = 0; r < n; ++r) {
    const double site = (knots_[r + 1] + knots_[r + 2] + knots_[r + 3]) / 3;
    sites_.push_back(std::clamp(site, knots_.front(), knots_.back()));
    const int span = find_knot_span(knots_, sites_.back(), 3, n - 1);
    BasisRow weights;
    bspline_basis(knots_, 3, span, sites_.back(), {&weights, 1});
    for (int i = 0; i < 4; ++i) {
      const int offset = span - 3 + i - r;
      if (weights[i] != 0) band_[7 * r + 3 + offset] = weights[i];
    }
  }
  for (int k = 0; k < n; ++k) {
    for (int r = k + 1; r < std::min(n, k + 4); ++r) {
      const double factor = band_[7 * r + 3 + k - r] /= band_[7 * k + 3];
      for (int c = k + 1; c < std::min(n, k + 4); ++c) {
        band_[7 * r + 3 + c - r] -= factor * band_[7 * k + 3 + c - k];
      }
    }
  }
}

void CubicInterpolation::solve(Vec3* values, std::ptrdiff_t stride) const {
  const int n = static_cast<int>(sites_.size());
  for (int r = 0; r < n; ++r) {
    for (int c = std::max(0, r - 3); c < r; ++c)
      values[r * stride] -= band_[7 * r + 3 + c - r] * values[c * stride];
  }
  for (int r = n - 1; r >= 0; --r) {
    for (int c = r + 1; c < std::min(n, r + 4); ++c) {
      values[r * stride] -= band_[7 * r + 3 + c - r] * values[c * stride];
    }
    values[r * stride] /= band_[7 * r + 3];
  }
}

}  // namespace flowcage
