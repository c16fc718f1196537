#include "core/curve/curved_bound.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>

#include "core/base/parallel.hpp"

namespace flowcage {
namespace {

constexpr double epsilon = std::numeric_limits<double>::epsilon();
constexpr Offset grain = 256;

double binomial(int n, int k) {
  double value = 1;
  for (int i = 1; i <= k; ++i) value = value * (n - k + i) / i;
  return value;
}

/// A tensor polynomial by coefficients, i fastest; `size` is the degree plus one along each axis. Scaled:
/// each Bernstein coefficient is multiplied by its three binomials, so that a product of polynomials is the
/// plain convolution.
template <typename Value>
struct Scaled {
  std::array<int, 3> size{};
  std::vector<Value> value;
};

/// Calls visit(entry, {i, j, k}).
template <typename Visit>
void for_entries(const std::array<int, 3>& size, const Visit& visit) {
  std::size_t n = 0;
  std::array<int, 3> x{};
  for (x[2] = 0; x[2] < size[2]; ++x[2]) {
    for (x[1] = 0; x[1] < size[1]; ++x[1]) {
      for (x[0] = 0; x[0] < size[0]; ++x[0]) visit(n++, x);
    }
  }
}

double weight(const std::array<int, 3>& size, const std::array<int, 3>& x) {
  double w = 1;
  for (int d = 0; d < 3; ++d) w *= binomial(size[d] - 1, x[d]);
  return w;
}

template <typename Out, typename A, typename B, typename Product>
Scaled<Out> product(const Scaled<A>& a, const Scaled<B>& b, const Out& zero, const Product& multiply) {
  Scaled<Out> out;
  for (int d = 0; d < 3; ++d) out.size[d] = a.size[d] + b.size[d] - 1;
  out.value.assign(static_cast<std::size_t>(out.size[0]) * static_cast<std::size_t>(out.size[1]) *
                       static_cast<std::size_t>(out.size[2]),
                   zero);
  for_entries(a.size, [&](std::size_t na, const std::array<int, 3>& x) {
    for_entries(b.size, [&](std::size_t nb, const std::array<int, 3>& y) {
      const int at = x[0] + y[0] + out.size[0] * (x[1] + y[1] + out.size[1] * (x[2] + y[2]));
      out.value[static_cast<std::size_t>(at)] += multiply(a.value[na], b.value[nb]);
    });
  });
  return out;
}

/// From values at i / order to Bernstein coefficients, in one variable.
Eigen::MatrixXd bernstein_of_nodes(int order) {
  Eigen::MatrixXd values(order + 1, order + 1);
  for (int i = 0; i <= order; ++i) {
    const double t = static_cast<double>(i) / order;
    for (int j = 0; j <= order; ++j) {
      values(i, j) = binomial(order, j) * std::pow(t, j) * std::pow(1 - t, order - j);
    }
  }
  return values.inverse();
}

const Eigen::MatrixXd& bernstein_matrix(int order) {
  static const std::array<Eigen::MatrixXd, 5> matrices{Eigen::MatrixXd(), bernstein_of_nodes(1),
                                                       bernstein_of_nodes(2), bernstein_of_nodes(3),
                                                       bernstein_of_nodes(4)};
  return matrices[static_cast<std::size_t>(order)];
}

/// Control points of the cell, relative to its first node: rounding follows the cell's size.
std::vector<Vec3> control_points(std::span<const Vec3> nodes, int order) {
  const Eigen::MatrixXd& to_bernstein = bernstein_matrix(order);
  const int n = order + 1;
  std::vector<Vec3> points(nodes.size());
  std::transform(nodes.begin(), nodes.end(), points.begin(),
                 [&](const Vec3& p) { return Vec3(p - nodes[0]); });
  for (const int step : {1, n, n * n}) {
    std::vector<Vec3> next(points.size(), Vec3::Zero());
    for (int at = 0; at < static_cast<int>(points.size()); ++at) {
      const int x = at / step % n, base = at - x * step;
      for (int j = 0; j < n; ++j) next[at] += to_bernstein(x, j) * points[base + j * step];
    }
    points = std::move(next);
  }
  return points;
}

/// The column of J along axis d, of degree order - 1 along it.
Scaled<Vec3> derivative(const std::vector<Vec3>& control, int order, int d) {
  Scaled<Vec3> out;
  out.size = {order + 1, order + 1, order + 1};
  out.size[d] = order;
  const int n = order + 1;
  const std::array<int, 3> step{1, n, n * n};
  for_entries(out.size, [&](std::size_t, const std::array<int, 3>& x) {
    const int at = x[0] + n * (x[1] + n * x[2]);
    out.value.push_back(order * (control[at + step[d]] - control[at]) * weight(out.size, x));
  });
  return out;
}

struct Bernstein {
  std::vector<double> coefficients;
  double error = 0;  ///< bound of the rounding error of any of them
};

Bernstein bernstein_of(std::span<const Vec3> nodes, int order) {
  const std::vector<Vec3> control = control_points(nodes, order);
  std::array<Scaled<Vec3>, 3> column;
  std::array<double, 3> longest{};
  for (int d = 0; d < 3; ++d) {
    column[d] = derivative(control, order, d);
    for_entries(column[d].size, [&](std::size_t n, const std::array<int, 3>& x) {
      longest[d] = std::max(longest[d], column[d].value[n].norm() / weight(column[d].size, x));
    });
  }
  const auto normal = product(column[1], column[2], Vec3(Vec3::Zero()),
                              [](const Vec3& a, const Vec3& b) { return Vec3(a.cross(b)); });
  Scaled<double> det = product(column[0], normal, 0.0, [](const Vec3& a, const Vec3& b) { return a.dot(b); });
  for_entries(det.size,
              [&](std::size_t n, const std::array<int, 3>& x) { det.value[n] /= weight(det.size, x); });

  // Each coefficient is a mean, with positive weights, of triple products: at most a few hundred roundings of
  // the product of the longest columns. The columns themselves are differences of control points, which carry
  // roundings of the cell's size times the norm of the matrix above (below 100 for order 4, all axes).
  double extent = 0;
  for (const Vec3& p : control) extent = std::max(extent, p.norm());
  const double of_columns = 200 * order * epsilon * extent;
  const auto [a, b, c] = longest;
  return {std::move(det.value), 1024 * epsilon * a * b * c + of_columns * (a * b + b * c + a * c)};
}

double least(const std::vector<double>& b) {
  return *std::min_element(b.begin(), b.end());
}

/// Least value of det J among the eight ends.
double least_end(const std::vector<double>& b, int n) {
  double out = std::numeric_limits<double>::infinity();
  for (int c = 0; c < 8; ++c) {
    const int at = (n - 1) * ((c & 1) + n * ((c >> 1 & 1) + n * (c >> 2)));
    out = std::min(out, b[static_cast<std::size_t>(at)]);
  }
  return out;
}

/// De Casteljau at 1/2 along one axis; side 0 keeps the lower half.
std::vector<double> half(const std::vector<double>& b, int n, int axis, int side) {
  std::vector<double> out = b;
  const int step = axis == 0 ? 1 : axis == 1 ? n : n * n;
  std::vector<double> line(static_cast<std::size_t>(n));
  for (int at = 0; at < n * n * n; ++at) {
    if (at / step % n != 0) continue;
    for (int i = 0; i < n; ++i) line[i] = b[at + i * step];
    for (int round = 0; round < n; ++round) {
      out[at + (side == 0 ? round : n - 1 - round) * step] = side == 0 ? line[0] : line[n - 1 - round];
      for (int i = 0; i + 1 < n - round; ++i) line[i] = (line[i] + line[i + 1]) / 2;
    }
  }
  return out;
}

}  // namespace

std::vector<double> curved_jacobian_bernstein(std::span<const Vec3> nodes, int order) {
  return bernstein_of(nodes, order).coefficients;
}

JacobianSign curved_jacobian_sign(std::span<const Vec3> nodes, int order, int max_splits) {
  if (!std::all_of(nodes.begin(), nodes.end(), [](const Vec3& p) { return p.allFinite(); })) {
    return JacobianSign::not_positive;
  }
  const int n = 3 * order;
  Bernstein whole = bernstein_of(nodes, order);
  const double error = whole.error;
  const auto larger = [](const std::vector<double>& a, const std::vector<double>& b) {
    return least(a) > least(b);
  };
  std::priority_queue<std::vector<double>, std::vector<std::vector<double>>, decltype(larger)> parts(larger);
  if (least_end(whole.coefficients, n) <= -error) return JacobianSign::not_positive;
  parts.push(std::move(whole.coefficients));
  for (int split = 0; split <= max_splits; ++split) {
    if (least(parts.top()) > error) return JacobianSign::positive;
    if (split == max_splits) break;
    const std::vector<double> worst = parts.top();
    parts.pop();
    for (int c = 0; c < 8; ++c) {
      parts.push(half(half(half(worst, n, 0, c & 1), n, 1, c >> 1 & 1), n, 2, c >> 2));
      if (least_end(parts.top(), n) <= -error) return JacobianSign::not_positive;
    }
  }
  return JacobianSign::undecided;
}

CurvedValidity measure_curved_validity(const CurvedMesh& mesh) {
  const auto points = mesh.nodes.points();
  const auto join = [](CurvedValidity a, const CurvedValidity& b) {
    a.not_positive += b.not_positive;
    a.undecided += b.undecided;
    if (b.min_ratio < a.min_ratio) {
      a.min_ratio = b.min_ratio;
      a.worst_cell = b.worst_cell;
      a.worst_place = b.worst_place;
    }
    return a;
  };
  return parallel_reduce(
      mesh.cell_count(), grain, CurvedValidity{},
      [&](Offset begin, Offset end) {
        CurvedValidity part;
        std::vector<Index> numbers(static_cast<std::size_t>(mesh.nodes_per_cell()));
        std::vector<Vec3> nodes(numbers.size());
        for (Offset cell = begin; cell < end; ++cell) {
          mesh.read_cell(cell, numbers);
          Vec3 middle = Vec3::Zero();
          for (std::size_t n = 0; n < nodes.size(); ++n) {
            nodes[n] = points[numbers[n]];
            middle += nodes[n];
          }
          const auto coefficients = curved_jacobian_bernstein(nodes, mesh.order);
          const auto [low, high] = std::minmax_element(coefficients.begin(), coefficients.end());
          const double ratio = *high > 0 ? *low / *high : -1;
          const JacobianSign sign = curved_jacobian_sign(nodes, mesh.order);
          CurvedValidity own;
          own.not_positive = sign == JacobianSign::not_positive ? 1 : 0;
          own.undecided = sign == JacobianSign::undecided ? 1 : 0;
          own.min_ratio = ratio;
          own.worst_cell = cell;
          own.worst_place = middle / static_cast<double>(nodes.size());
          part = join(part, own);
        }
        return part;
      },
      join);
}

}  // namespace flowcage
