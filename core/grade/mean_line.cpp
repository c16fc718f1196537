#include "core/grade/mean_line.hpp"

#include <algorithm>
#include <cmath>

namespace flowcage {

MeanLine::MeanLine(const BlockMesh& mesh, const WallBlocks& blocks, const WallColumns& columns,
                   const LayerSettings& settings) {
  const Index n = columns.layers;
  lengths_.assign(n + 1, 0);
  for (const WallLine& line : columns.lines) {
    const std::vector<Vec3> points = line_positions(mesh, blocks, line, n);
    double s = 0;
    for (Index k = 1; k <= n; ++k) {
      s += (points[k] - points[k - 1]).norm();
      lengths_[k] += std::log(std::max(s, 1e-300)) / static_cast<double>(columns.lines.size());
    }
  }
  for (Index k = 1; k <= n; ++k) lengths_[k] = std::exp(lengths_[k]);
  sigma_.push_back(0);
  for (const double cell : graded_cells(lengths_, settings)) {
    sigma_.push_back(sigma_.back() + cell);
  }
  exact_ = std::min(static_cast<Index>(exact_cells(lengths_.back(), settings).size()), cells());
  while (exact_ < cells() && sigma_[exact_ + 1] - sigma_[exact_] < thin * lengths_[1]) ++exact_;
  const double reach = lengths_[std::min(n, blended)];
  end_ = static_cast<Index>(std::lower_bound(sigma_.begin(), sigma_.end(), reach) - sigma_.begin());
}

std::vector<double> MeanLine::carried(std::span<const double> own, double lean) const {
  std::vector<double> s(sigma_.size());
  std::size_t n = 0;
  for (std::size_t k = 1; k < s.size(); ++k) {
    while (n + 2 < lengths_.size() && lengths_[n + 1] < sigma_[k]) ++n;
    const double t = (sigma_[k] - lengths_[n]) / (lengths_[n + 1] - lengths_[n]);
    s[k] = own[n] + t * (own[n + 1] - own[n]);
  }
  s.back() = own.back();
  if (exact_ == 0) return s;
  // log rho falls to 0 with the logarithm of the length, smoothly and so slowly that the lengths keep
  // rising.
  const double rho = std::log(lean * sigma_[exact_] / s[exact_]);
  const double start = std::log(s[exact_]);
  const double range =
      std::min(std::max(std::log(s[end_]) - start, 3 * std::abs(rho)), std::log(s.back()) - start);
  for (Index k = 1; k < cells(); ++k) {
    const double x = range > 0 ? std::clamp((std::log(s[k]) - start) / range, 0.0, 1.0) : 1;
    s[k] = k <= exact_ ? lean * sigma_[k] : s[k] * std::exp(rho * (1 - x * x * (3 - 2 * x)));
  }
  return s;
}

}  // namespace flowcage
