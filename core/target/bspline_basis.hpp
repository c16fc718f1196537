#pragma once
#include <algorithm>
#include <array>
#include <span>
#include <vector>

namespace flowcage {

/// One number for each basis function that is not zero on a knot span: span - degree .. span.
using BasisRow = std::array<double, 31>;  // degrees up to 30

// In the header because projection spends its time here.

/// The last knot index k in [first, last] with knots[k] <= t whose span is not empty; first if t lies before.
inline int find_knot_span(const std::vector<double>& knots, double t, int first, int last) {
  const auto begin = knots.begin() + first + 1, end = knots.begin() + last + 1;
  int span = static_cast<int>(std::upper_bound(begin, end, t) - knots.begin()) - 1;
  while (span > first && knots[span] == knots[span + 1]) --span;
  return span;
}

/// Values, first and second derivatives (as many as there are rows, at least one) of a span's basis functions
/// at t: the recurrence of Cox and de Boor (The NURBS Book, A2.2, A2.3), whose rows of degree - 2 and degree
/// - 1 give the derivatives. Preconditions: degree in [1, 30], the span is not empty.
inline void bspline_basis(const std::vector<double>& knots, int degree, int span, double t,
                          std::span<BasisRow> rows) {
  BasisRow& value = rows[0];
  BasisRow lower{}, lowest{};  // of degree - 1 and degree - 2
  value[0] = 1;
  const double* k = knots.data() + span;
  for (int d = 1; d <= degree; ++d) {
    if (d == degree - 1) lowest = value;
    if (d == degree) lower = value;
    double carry = 0;
    for (int i = 0; i < d; ++i) {
      const double left = k[1 + i - d], right = k[1 + i];
      const double part = value[i] / (right - left);
      value[i] = carry + (right - t) * part;
      carry = (t - left) * part;
    }
    value[d] = carry;
  }
  // N'_{i,p} = p (N_{i,p-1} / (t_{i+p} - t_i) - N_{i+1,p-1} / (t_{i+p+1} - t_{i+1}))
  const auto differentiate = [&](const BasisRow& from, int d, BasisRow& to) {
    double carry = 0;
    for (int i = 0; i < d; ++i) {
      const double part = d * from[i] / (k[1 + i] - k[1 + i - d]);
      to[i] = carry - part;
      carry = part;
    }
    to[d] = carry;
  };
  if (rows.size() > 1) differentiate(lower, degree, rows[1]);
  if (rows.size() > 2) {
    if (degree >= 2) {
      BasisRow slope{};
      differentiate(lowest, degree - 1, slope);
      differentiate(slope, degree, rows[2]);
    } else {
      rows[2][0] = rows[2][1] = 0;
    }
  }
}

}  // namespace flowcage
