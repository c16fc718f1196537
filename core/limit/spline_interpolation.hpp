#pragma once
#include <span>
#include <vector>

#include "core/base/types.hpp"

namespace flowcage {

/// Interpolation by cubic B-splines at the Greville abscissae, which reproduces splines: one banded
/// factorisation for any number of right sides. Without pivoting, which totally positive matrices do not need
/// (de Boor & Pinkus 1977).
class CubicInterpolation {
 public:
  /// Flat knots, the first and last four times each, inner ones at most twice.
  explicit CubicInterpolation(std::vector<double> knots);

  const std::vector<double>& knots() const { return knots_; }
  const std::vector<double>& sites() const { return sites_; }  ///< ascending; the first and last are the ends
  /// Values at the sites to control points, in place; the k-th is values[k * stride].
  void solve(Vec3* values, std::ptrdiff_t stride) const;

 private:
  std::vector<double> knots_, sites_;
  std::vector<double> band_;  // row r: columns r - 3 .. r + 3; L below the diagonal, U from it on
};

}  // namespace flowcage
