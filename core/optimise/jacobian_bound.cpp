#include "core/optimise/jacobian_bound.hpp"

#include <queue>
#include <vector>

namespace flowcage {
namespace {

using Coefficients = std::array<double, 27>;

constexpr std::array<int, 3> stride{1, 3, 9};

/// The columns of J. Column a does not depend on coordinate a and is bilinear in the two others: four values,
/// at their ends, first axis fastest. So det J, trilinear in the columns, has degree 2 in each coordinate.
struct Columns {
  std::array<std::array<Vec3, 4>, 3> value;
};

Columns columns_of(const HexCornerPoints& p) {
  Columns out;
  for (int e = 0; e < 12; ++e) out.value[e / 4][e % 4] = p[hex_edges[e][1]] - p[hex_edges[e][0]];
  return out;
}

/// A bound of the rounding error of any coefficient, subdivision included: each term of the sums carries
/// about ten roundings of at most the product of the largest columns; up to eight terms are averaged.
double rounding_bound(const Columns& columns) {
  std::array<double, 3> size{};
  for (int a = 0; a < 3; ++a) {
    for (const Vec3& c : columns.value[a]) size[a] = std::max(size[a], c.norm());
  }
  return 64 * std::numeric_limits<double>::epsilon() * size[0] * size[1] * size[2];
}

double least(const Coefficients& b) {
  return *std::min_element(b.begin(), b.end());
}

/// Least of the coefficients that are values of det J: those at corners.
double least_value(const Coefficients& b) {
  double out = std::numeric_limits<double>::infinity();
  for (const int n : {0, 2, 6, 8, 18, 20, 24, 26}) out = std::min(out, b[n]);
  return out;
}

/// De Casteljau at 1/2 along one axis; side 0 keeps the lower half.
Coefficients half(const Coefficients& b, int axis, int side) {
  Coefficients out{};
  for (int n = 0; n < 27; ++n) {
    if ((n / stride[axis]) % 3 != 0) continue;
    const double b0 = b[n];
    const double b1 = b[n + stride[axis]];
    const double b2 = b[n + 2 * stride[axis]];
    const double middle = 0.25 * b0 + 0.5 * b1 + 0.25 * b2;
    out[n] = side == 0 ? b0 : middle;
    out[n + stride[axis]] = side == 0 ? 0.5 * (b0 + b1) : 0.5 * (b1 + b2);
    out[n + 2 * stride[axis]] = side == 0 ? middle : b2;
  }
  return out;
}

std::array<Coefficients, 8> eighths(const Coefficients& b) {
  std::array<Coefficients, 8> out;
  for (int n = 0; n < 8; ++n) out[n] = half(half(half(b, 0, n & 1), 1, (n >> 1) & 1), 2, n >> 2);
  return out;
}

struct LargerLeast {
  bool operator()(const Coefficients& a, const Coefficients& b) const { return least(a) > least(b); }
};
/// Parts of the cube, the one with the least coefficient on top.
using Parts = std::priority_queue<Coefficients, std::vector<Coefficients>, LargerLeast>;

void split_worst(Parts& parts) {
  const Coefficients worst = parts.top();
  parts.pop();
  for (const Coefficients& part : eighths(worst)) parts.push(part);
}

bool finite(const HexCornerPoints& p) {
  return std::all_of(p.begin(), p.end(), [](const Vec3& x) { return x.allFinite(); });
}

}  // namespace

std::array<double, 27> jacobian_bernstein(const HexCornerPoints& corners) {
  const Columns columns = columns_of(corners);
  // Column 0 depends on (j,k), column 1 on (i,k), column 2 on (i,j); each by two end bits.
  Coefficients sum{};
  for (int n0 = 0; n0 < 4; ++n0) {
    for (int n1 = 0; n1 < 4; ++n1) {
      const Vec3 normal = columns.value[0][n0].cross(columns.value[1][n1]);
      for (int n2 = 0; n2 < 4; ++n2) {
        const int i = (n1 & 1) + (n2 & 1);
        const int j = (n0 & 1) + (n2 >> 1);
        const int k = (n0 >> 1) + (n1 >> 1);
        sum[i + 3 * j + 9 * k] += normal.dot(columns.value[2][n2]);
      }
    }
  }
  // B1_a B1_b is B2_(a+b), halved where the factors sit at different ends (two terms share that coefficient).
  for (int n = 0; n < 27; ++n) {
    const int middle = (n % 3 == 1) + (n / 3 % 3 == 1) + (n / 9 == 1);
    sum[n] /= 1 << middle;
  }
  return sum;
}

double jacobian_lower_bound(const HexCornerPoints& corners, int splits) {
  if (!finite(corners)) return std::numeric_limits<double>::quiet_NaN();
  Parts parts;
  parts.push(jacobian_bernstein(corners));
  for (int n = 0; n < splits; ++n) {
    if (least(parts.top()) >= least_value(parts.top())) break;  // attained: the bound is the minimum
    split_worst(parts);
  }
  return least(parts.top()) - rounding_bound(columns_of(corners));
}

bool positive_near_affine(const HexCornerPoints& corners) {
  double affine = 1, largest = 1;
  std::array<Vec3, 3> mean;
  for (int a = 0; a < 3; ++a) {
    std::array<Vec3, 4> edge;
    for (int e = 0; e < 4; ++e) edge[e] = corners[hex_edges[4 * a + e][1]] - corners[hex_edges[4 * a + e][0]];
    mean[a] = ((edge[0] + edge[1]) + (edge[2] + edge[3])) / 4;
    double deviation = 0;
    for (const Vec3& e : edge) deviation = std::max(deviation, (e - mean[a]).squaredNorm());
    const double length = mean[a].norm();
    affine *= length;
    largest *= length + std::sqrt(deviation);
  }
  // Twice the bound of the Bernstein form, which this stands in for. A coordinate that is no number fails.
  const double rounding = 128 * std::numeric_limits<double>::epsilon() * largest;
  return mean[0].cross(mean[1]).dot(mean[2]) > largest - affine + rounding;
}

JacobianSign jacobian_sign(const HexCornerPoints& corners, int max_splits) {
  if (positive_near_affine(corners)) return JacobianSign::positive;
  if (!finite(corners)) return JacobianSign::not_positive;
  const double error = rounding_bound(columns_of(corners));
  const Coefficients whole = jacobian_bernstein(corners);
  if (least_value(whole) <= -error) return JacobianSign::not_positive;
  if (least(whole) > error) return JacobianSign::positive;
  Parts parts;
  parts.push(whole);
  for (int n = 0; n < max_splits; ++n) {
    if (least(parts.top()) > error) return JacobianSign::positive;
    if (least_value(parts.top()) <= error) break;  // no split lifts the bound above a value
    split_worst(parts);
    // The new parts' corners are new values of det J.
    if (least_value(parts.top()) <= -error) return JacobianSign::not_positive;
  }
  return least_value(parts.top()) <= -error ? JacobianSign::not_positive : JacobianSign::undecided;
}

}  // namespace flowcage
