#include "core/target/bezier_net.hpp"

#include <algorithm>
#include <limits>

#include "core/target/bspline_basis.hpp"

namespace flowcage {
namespace {

/// Bernstein polynomials and their derivatives at t; only first .. last are not zero.
struct BernsteinRows {
  std::array<BasisRow, 3> rows{};
  int first = 0, last = 0;

  BernsteinRows(int degree, double t) {
    const int ends = degree + 1;
    std::vector<double> knots(static_cast<std::size_t>(2 * ends), 0.0);
    std::fill(knots.begin() + ends, knots.end(), 1.0);
    bspline_basis(knots, degree, degree, t, rows);
    // At an end only as many poles count as there are derivatives.
    first = t == 1 ? std::max(0, degree - 2) : 0;
    last = t == 0 ? std::min(degree, 2) : degree;
  }
};

PatchCurvature evaluate(const BezierNet& net, const BernsteinRows& s, const BernsteinRows& t) {
  using Vec4 = Eigen::Vector4d;
  Vec4 sum[3][3];
  for (auto& row : sum) std::fill(std::begin(row), std::end(row), Vec4::Zero());
  for (int i = s.first; i <= s.last; ++i) {
    Vec4 along_t[3] = {Vec4::Zero(), Vec4::Zero(), Vec4::Zero()};
    for (int j = t.first; j <= t.last; ++j) {
      const Vec4& pole = net.pole(i, j);
      for (int d = 0; d < 3; ++d) along_t[d] += t.rows[d][j] * pole;
    }
    for (int a = 0; a < 3; ++a) {
      for (int d = 0; a + d < 3; ++d) sum[a][d] += s.rows[a][i] * along_t[d];
    }
  }
  return quotient({sum[0][0], sum[1][0], sum[0][1], sum[2][0], sum[1][1], sum[0][2]});
}

}  // namespace

PatchCurvature quotient(const HomogeneousPoint& at) {
  PatchCurvature c;
  const double w = at.value[3];
  c.position = at.value.head<3>() / w;
  c.du = (at.u.head<3>() - at.u[3] * c.position) / w;
  c.dv = (at.v.head<3>() - at.v[3] * c.position) / w;
  c.duu = (at.uu.head<3>() - 2 * at.u[3] * c.du - at.uu[3] * c.position) / w;
  c.duv = (at.uv.head<3>() - at.u[3] * c.dv - at.v[3] * c.du - at.uv[3] * c.position) / w;
  c.dvv = (at.vv.head<3>() - 2 * at.v[3] * c.dv - at.vv[3] * c.position) / w;
  return c;
}

std::array<BezierNet, 2> halves(const BezierNet& net, int axis) {
  std::array<BezierNet, 2> result{net, net};
  BezierNet &low = result[0], &high = result[1];
  const int count_s = net.degree_s + 1, count_t = net.degree_t + 1;
  const int rows = axis == 0 ? count_t : count_s, degree = axis == 0 ? net.degree_s : net.degree_t;
  const int step = axis == 0 ? count_t : 1, next_row = axis == 0 ? 1 : count_t;
  for (int row = 0; row < rows; ++row) {
    Eigen::Vector4d *l = low.poles.data() + row * next_row, *h = high.poles.data() + row * next_row;
    for (int d = 1; d <= degree; ++d) {
      for (int i = 0; i <= degree - d; ++i) h[i * step] = 0.5 * (h[i * step] + h[(i + 1) * step]);
      l[d * step] = h[0];
    }
  }
  return result;
}

Vec2 bend(const BezierNet& net) {
  const int m = net.degree_s, n = net.degree_t;
  for (const Eigen::Vector4d& pole : net.poles) {
    if (!(pole[3] > 0)) return Vec2::Constant(std::numeric_limits<double>::infinity());
  }
  std::vector<Vec3> points;
  for (int i = 0; i <= m; ++i) {
    for (int j = 0; j <= n; ++j) points.push_back(net.point(i, j));
  }
  const auto point = [&](int i, int j) -> const Vec3& { return points[i * (n + 1) + j]; };
  // S is a convex combination of the projected poles; a pole differs from the bilinear net's, which lies in
  // the corners' hull, by at most the bend of its row and that of a side.
  Vec2 largest = Vec2::Zero();
  for (int i = 0; i <= m; ++i) {
    for (int j = 0; j <= n; ++j) {
      const double a = static_cast<double>(i) / m, b = static_cast<double>(j) / n;
      largest.x() =
          std::max(largest.x(), (point(i, j) - (1 - a) * point(0, j) - a * point(m, j)).squaredNorm());
      largest.y() =
          std::max(largest.y(), (point(i, j) - (1 - b) * point(i, 0) - b * point(i, n)).squaredNorm());
    }
  }
  return largest.cwiseSqrt();
}

std::array<PatchCurvature, 9> nine_samples(const BezierNet& net) {
  const std::array<BernsteinRows, 3> s{BernsteinRows(net.degree_s, 0), BernsteinRows(net.degree_s, 0.5),
                                       BernsteinRows(net.degree_s, 1)};
  const std::array<BernsteinRows, 3> t{BernsteinRows(net.degree_t, 0), BernsteinRows(net.degree_t, 0.5),
                                       BernsteinRows(net.degree_t, 1)};
  std::array<PatchCurvature, 9> result;
  for (int k = 0; k < 9; ++k) result[k] = evaluate(net, s[k / 3], t[k % 3]);
  return result;
}

PatchCurvature middle_of(const BezierNet& net) {
  return evaluate(net, BernsteinRows(net.degree_s, 0.5), BernsteinRows(net.degree_t, 0.5));
}

}  // namespace flowcage
