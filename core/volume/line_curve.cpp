#include "core/volume/line_curve.hpp"

#include <algorithm>

namespace flowcage {

LineCurve::LineCurve(std::vector<Vec3> points) : points_(std::move(points)), lengths_(points_.size(), 0) {
  const std::size_t n = points_.size();
  for (std::size_t k = 1; k < n; ++k) lengths_[k] = lengths_[k - 1] + (points_[k] - points_[k - 1]).norm();
  slopes_.resize(n);
  for (std::size_t k = 1; k + 1 < n; ++k) {
    const double h0 = lengths_[k] - lengths_[k - 1];
    const double h1 = lengths_[k + 1] - lengths_[k];
    slopes_[k] = (secant(k - 1) * h1 + secant(k) * h0) / std::max(h0 + h1, 1e-300);
  }
  slopes_.front() = n > 2 ? Vec3(2 * secant(0) - slopes_[1]) : secant(0);
  slopes_.back() = n > 2 ? Vec3(2 * secant(n - 2) - slopes_[n - 2]) : secant(0);
}

Vec3 LineCurve::at(double s) const {
  const auto above = std::upper_bound(lengths_.begin() + 1, lengths_.end() - 1, s);
  const auto k = static_cast<std::size_t>(above - lengths_.begin()) - 1;
  const double h = lengths_[k + 1] - lengths_[k];
  if (!(h > 0)) return points_[k];
  const double t = (s - lengths_[k]) / h;
  const double u = 1 - t;
  // From the nearer end, so that a shared coordinate stays exact.
  return points_[k] + (points_[k + 1] - points_[k]) * (t * t * (3 - 2 * t)) + slopes_[k] * (h * t * u * u) -
         slopes_[k + 1] * (h * t * t * u);
}

Vec3 LineCurve::secant(std::size_t k) const {
  const double h = lengths_[k + 1] - lengths_[k];
  return h > 0 ? Vec3((points_[k + 1] - points_[k]) / h) : Vec3::Zero();
}

}  // namespace flowcage
