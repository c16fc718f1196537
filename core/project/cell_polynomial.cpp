#include "core/project/cell_polynomial.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace flowcage {
namespace {

constexpr int most_points = 13;
const double pi = std::acos(-1.0);

/// Chebyshev points, and the matrix from values at them to Chebyshev coefficients.
struct Interpolation {
  explicit Interpolation(int n) : points(n), transform(n, n) {
    for (int k = 0; k < n; ++k) {
      points[k] = std::cos(pi * (k + 0.5) / n);
      for (int i = 0; i < n; ++i) {
        transform(i, k) = (i == 0 ? 1.0 : 2.0) / n * std::cos(pi * i * (k + 0.5) / n);
      }
    }
    // Extrema of the first polynomial left out: the ends, and the one nearest to the middle.
    checks = {-1, std::cos(pi * (n / 2) / n), 1};
  }
  std::vector<double> points;
  Eigen::MatrixXd transform;
  std::vector<double> checks;
};

const Interpolation& interpolation(int n) {
  static const std::array<Interpolation, 4> all{Interpolation(5), Interpolation(9), Interpolation(13),
                                                Interpolation(1)};
  return n == 5 ? all[0] : n == 9 ? all[1] : n == 13 ? all[2] : all[3];
}

/// Column k: the monomial coefficients of the Chebyshev polynomial T_k.
Eigen::MatrixXd monomials_of_chebyshev() {
  Eigen::MatrixXd m = Eigen::MatrixXd::Zero(most_points, most_points);
  m(0, 0) = 1;
  m(1, 1) = 1;
  for (int k = 2; k < most_points; ++k) {
    m.col(k) = -m.col(k - 2);
    for (int i = 0; i + 1 < most_points; ++i) m(i + 1, k) += 2 * m(i, k - 1);
  }
  return m;
}

/// The least count such that what is left out adds less than `least`. sizes: of the coefficients.
int kept(const std::vector<double>& sizes, double least) {
  auto count = static_cast<int>(sizes.size());
  double left_out = 0;
  while (count > 1 && left_out + sizes[count - 1] <= least) left_out += sizes[--count];
  return count;
}

CellPolynomials::Fitted interpolate(const GridSampler& sample, int n_s, int n_t, double tolerance) {
  static const Eigen::MatrixXd monomials = monomials_of_chebyshev();
  const Interpolation &along_s = interpolation(n_s), &along_t = interpolation(n_t);
  std::vector<double> t_points = along_t.points;
  if (n_t == 1) t_points = {0};
  std::vector<Vec3> values(static_cast<std::size_t>(n_s) * n_t);
  sample(along_s.points, t_points, values);
  std::array<Eigen::MatrixXd, 3> chebyshev;  // (i, j) of T_i(s) T_j(t)
  std::vector<double> sizes_s(n_s, 0.0), sizes_t(n_t, 0.0);
  for (int axis = 0; axis < 3; ++axis) {
    Eigen::MatrixXd at(n_s, n_t);
    for (int j = 0; j < n_t; ++j) {
      for (int i = 0; i < n_s; ++i) at(i, j) = values[j * n_s + i][axis];
    }
    chebyshev[axis] = along_s.transform * at * along_t.transform.transpose();
    for (int i = 0; i < n_s; ++i) sizes_s[i] += chebyshev[axis].row(i).cwiseAbs().sum();
    for (int j = 0; j < n_t; ++j) sizes_t[j] += chebyshev[axis].col(j).cwiseAbs().sum();
  }
  CellPolynomials::Fitted fitted;
  const int m = kept(sizes_s, 0.25 * tolerance), n = kept(sizes_t, 0.25 * tolerance);
  fitted.degree_s = m - 1;
  fitted.degree_t = n - 1;
  fitted.coefficients.resize(static_cast<std::size_t>(3) * m * n);
  for (int axis = 0; axis < 3; ++axis) {
    const Eigen::MatrixXd a = monomials.topLeftCorner(m, m) * chebyshev[axis].topLeftCorner(m, n) *
                              monomials.topLeftCorner(n, n).transpose();
    for (int j = 0; j < n; ++j) {
      for (int i = 0; i < m; ++i) fitted.coefficients[3 * (j * m + i) + axis] = a(i, j);
    }
  }
  return fitted;
}

/// Horner's rule on `width` numbers a row at once: values, first and half of the second derivatives by t.
template <int width>
void sum_rows(const double* rows, int count, double t, double* c0, double* c1, double* c2) {
  const double* row = rows + static_cast<std::ptrdiff_t>(count - 1) * width;
  for (int k = 0; k < width; ++k) {
    c0[k] = row[k];
    c1[k] = c2[k] = 0;
  }
  for (int j = count - 2; j >= 0; --j) {
    row -= width;
    for (int k = 0; k < width; ++k) {
      c2[k] = c2[k] * t + c1[k];
      c1[k] = c1[k] * t + c0[k];
      c0[k] = c0[k] * t + row[k];
    }
  }
}

template <int degree_s>
PatchCurvature evaluate_degree(const CellPolynomial& p, const Vec2& st) {
  constexpr int width = 3 * (degree_s + 1);
  std::array<double, width> c0, c1, c2;
  sum_rows<width>(p.coefficients, p.degree_t + 1, st.y(), c0.data(), c1.data(), c2.data());
  const double s = st.x();
  PatchCurvature at;
  for (int axis = 0; axis < 3; ++axis) {
    constexpr int last = 3 * degree_s;
    double x = c0[last + axis], x_s = 0, x_ss = 0, x_t = c1[last + axis], x_st = 0, x_tt = c2[last + axis];
    for (int k = last - 3 + axis; k >= 0; k -= 3) {
      x_ss = x_ss * s + x_s;
      x_s = x_s * s + x;
      x = x * s + c0[k];
      x_st = x_st * s + x_t;
      x_t = x_t * s + c1[k];
      x_tt = x_tt * s + c2[k];
    }
    at.position[axis] = x;
    at.du[axis] = x_s;
    at.duu[axis] = 2 * x_ss;
    at.dv[axis] = x_t;
    at.duv[axis] = x_st;
    at.dvv[axis] = 2 * x_tt;
  }
  return at;
}

}  // namespace

void CellPolynomials::append(const Fitted& fitted) {
  places_.push_back({static_cast<Offset>(coefficients_.size()), fitted.degree_s, fitted.degree_t});
  coefficients_.insert(coefficients_.end(), fitted.coefficients.begin(), fitted.coefficients.end());
}

CellPolynomials::Fitted fit_cell_polynomial(const GridSampler& sample, CellKind kind, double tolerance) {
  for (const int n : {5, 9, most_points}) {
    const CellPolynomials::Fitted fitted = interpolate(sample, n, kind == CellKind::curve ? 1 : n, tolerance);
    const CellPolynomial p{fitted.degree_s, fitted.degree_t, fitted.coefficients.data()};
    const std::vector<double>& s = interpolation(n).checks;
    const std::vector<double> t = kind == CellKind::curve ? std::vector<double>{0} : s;
    std::vector<Vec3> exact(s.size() * t.size());
    sample(s, t, exact);
    bool agrees = true;
    for (std::size_t k = 0; k < exact.size() && agrees; ++k) {
      const Vec2 at(s[k % s.size()], t[k / s.size()]);
      agrees = (evaluate(p, at).position - exact[k]).norm() <= tolerance;
    }
    if (agrees) return fitted;
  }
  return {};
}

PatchCurvature evaluate(const CellPolynomial& p, const Vec2& st) {
  switch (p.degree_s) {
    case 0:
      return evaluate_degree<0>(p, st);
    case 1:
      return evaluate_degree<1>(p, st);
    case 2:
      return evaluate_degree<2>(p, st);
    case 3:
      return evaluate_degree<3>(p, st);
    case 4:
      return evaluate_degree<4>(p, st);
    case 5:
      return evaluate_degree<5>(p, st);
    case 6:
      return evaluate_degree<6>(p, st);
    case 7:
      return evaluate_degree<7>(p, st);
    case 8:
      return evaluate_degree<8>(p, st);
    case 9:
      return evaluate_degree<9>(p, st);
    case 10:
      return evaluate_degree<10>(p, st);
    case 11:
      return evaluate_degree<11>(p, st);
    default:
      return evaluate_degree<12>(p, st);
  }
}

PatchPoint PolynomialPatch::first(const Vec2& st) const {
  const PatchCurvature at = second(st);
  return {at.position, at.du, at.dv};
}

CurveDerivatives PolynomialCurve::second(double s) const {
  const PatchCurvature at = evaluate(polynomial_, Vec2(s, 0));
  return {at.position, at.du, at.duu};
}

}  // namespace flowcage
