#include "core/target/bspline_patch.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/target/bspline_basis.hpp"

namespace flowcage {
namespace {

/// Rows b of weights on the span's poles so that pole b of the Bezier form over [low, high] is their sum: the
/// blossom at (low, ..., low, high, ..., high).
void bezier_rows(const std::vector<double>& knots, int degree, int span, const Vec2& low_high,
                 std::vector<double>& rows) {
  const int n = degree + 1;
  rows.assign(static_cast<std::size_t>(n) * n, 0.0);
  std::vector<double> work(static_cast<std::size_t>(n) * n);
  const double* k = knots.data() + span;
  for (int b = 0; b < n; ++b) {
    std::fill(work.begin(), work.end(), 0.0);
    for (int i = 0; i < n; ++i) work[i * n + i] = 1;
    for (int r = 1; r <= degree; ++r) {
      const double t = r <= degree - b ? low_high.x() : low_high.y();
      for (int i = degree; i >= r; --i) {
        const double left = k[i - degree], right = k[1 + i - r];
        const double alpha = (t - left) / (right - left);
        for (int c = 0; c < n; ++c) {
          work[i * n + c] = (1 - alpha) * work[(i - 1) * n + c] + alpha * work[i * n + c];
        }
      }
    }
    std::copy_n(work.begin() + degree * n, n, rows.begin() + b * n);
  }
}

}  // namespace

BSplinePatch::BSplinePatch(std::shared_ptr<const BSplineSurface> surface, const Eigen::AlignedBox2d& window)
    : surface_(std::move(surface)), window_(window) {
  const BSplineSurface& s = *surface_;
  const bool rational = !s.weights.empty();
  for (std::size_t p = 0; p < s.poles.size(); ++p) {
    const double w = rational ? s.weights[p] : 1.0;
    for (int axis = 0; axis < 3; ++axis) net_.push_back(w * s.poles[p][axis]);
    if (rational) net_.push_back(w);
  }
  const auto spans = [](const std::vector<double>& knots, int degree, double low, double high, int& first,
                        int& last) {
    first = degree;
    last = static_cast<int>(knots.size()) - degree - 2;
    while (first < last && knots[first + 1] <= low) ++first;
    while (last > first && knots[last] >= high) --last;
  };
  spans(s.knots_u, s.degree_u, window.min().x(), window.max().x(), first_span_[0], last_span_[0]);
  spans(s.knots_v, s.degree_v, window.min().y(), window.max().y(), first_span_[1], last_span_[1]);
}

PatchPoint BSplinePatch::first(const Vec2& uv) const {
  const PatchCurvature all = second(uv);
  return {all.position, all.du, all.dv};
}

PatchCurvature BSplinePatch::second(const Vec2& uv) const {
  const BSplineSurface& s = *surface_;
  const int p = s.degree_u, q = s.degree_v, count_v = s.count_v();
  const int span_u = find_knot_span(s.knots_u, uv.x(), first_span_[0], last_span_[0]);
  const int span_v = find_knot_span(s.knots_v, uv.y(), first_span_[1], last_span_[1]);
  std::array<BasisRow, 3> bu, bv;
  bspline_basis(s.knots_u, p, span_u, uv.x(), bu);
  bspline_basis(s.knots_v, q, span_v, uv.y(), bv);
  if (s.weights.empty()) {
    Vec3 r = Vec3::Zero(), u = r, v = r, uu = r, uv_ = r, vv = r;
    for (int i = 0; i <= p; ++i) {
      Vec3 c0 = Vec3::Zero(), c1 = c0, c2 = c0;
      const double* pole = net_.data() + 3 * ((span_u - p + i) * count_v + span_v - q);
      for (int j = 0; j <= q; ++j, pole += 3) {
        const Vec3 x(pole[0], pole[1], pole[2]);
        c0 += bv[0][j] * x;
        c1 += bv[1][j] * x;
        c2 += bv[2][j] * x;
      }
      r += bu[0][i] * c0;
      u += bu[1][i] * c0;
      uu += bu[2][i] * c0;
      v += bu[0][i] * c1;
      uv_ += bu[1][i] * c1;
      vv += bu[0][i] * c2;
    }
    return {r, u, v, uu, uv_, vv};
  }
  using Vec4 = Eigen::Vector4d;
  Vec4 r = Vec4::Zero(), u = r, v = r, uu = r, uv_ = r, vv = r;
  for (int i = 0; i <= p; ++i) {
    Vec4 c0 = Vec4::Zero(), c1 = c0, c2 = c0;
    const double* pole = net_.data() + 4 * ((span_u - p + i) * count_v + span_v - q);
    for (int j = 0; j <= q; ++j, pole += 4) {
      const Vec4 x(pole[0], pole[1], pole[2], pole[3]);
      c0 += bv[0][j] * x;
      c1 += bv[1][j] * x;
      c2 += bv[2][j] * x;
    }
    r += bu[0][i] * c0;
    u += bu[1][i] * c0;
    uu += bu[2][i] * c0;
    v += bu[0][i] * c1;
    uv_ += bu[1][i] * c1;
    vv += bu[0][i] * c2;
  }
  return quotient({r, u, v, uu, uv_, vv});
}

void BSplinePatch::positions(std::span<const double> u, std::span<const double> v,
                             std::span<Vec3> points) const {
  const BSplineSurface& s = *surface_;
  const int p = s.degree_u, q = s.degree_v, count_v = s.count_v(), dim = s.weights.empty() ? 3 : 4;
  std::vector<BasisRow> rows_v(v.size());
  std::vector<int> spans_v(v.size());
  for (std::size_t j = 0; j < v.size(); ++j) {
    spans_v[j] = find_knot_span(s.knots_v, v[j], first_span_[1], last_span_[1]);
    bspline_basis(s.knots_v, q, spans_v[j], v[j], std::span(&rows_v[j], 1));
  }
  // Along u first: a row of poles for each u, shared by all v.
  std::vector<Eigen::Vector4d> along(static_cast<std::size_t>(count_v));
  for (std::size_t i = 0; i < u.size(); ++i) {
    const int span_u = find_knot_span(s.knots_u, u[i], first_span_[0], last_span_[0]);
    BasisRow row_u;
    bspline_basis(s.knots_u, p, span_u, u[i], std::span(&row_u, 1));
    const auto [low, high] = std::minmax_element(spans_v.begin(), spans_v.end());
    for (int k = *low - q; k <= *high; ++k) {
      Eigen::Vector4d sum(0, 0, 0, 0);
      for (int a = 0; a <= p; ++a) {
        const double* pole = net_.data() + dim * ((span_u - p + a) * count_v + k);
        sum += row_u[a] * Eigen::Vector4d(pole[0], pole[1], pole[2], dim == 4 ? pole[3] : 1.0);
      }
      along[k] = sum;
    }
    for (std::size_t j = 0; j < v.size(); ++j) {
      Eigen::Vector4d sum(0, 0, 0, 0);
      for (int b = 0; b <= q; ++b) sum += rows_v[j][b] * along[spans_v[j] - q + b];
      points[j * u.size() + i] = dim == 4 ? Vec3(sum.head<3>() / sum[3]) : Vec3(sum.head<3>());
    }
  }
}

std::vector<double> BSplinePatch::breaks(int axis) const {
  const std::vector<double>& knots = axis == 0 ? surface_->knots_u : surface_->knots_v;
  std::vector<double> result{window_.min()[axis]};
  for (const double t : knots) {
    if (t > result.back() && t < window_.max()[axis]) result.push_back(t);
  }
  result.push_back(window_.max()[axis]);
  return result;
}

std::optional<BezierNet> BSplinePatch::bezier(const Eigen::AlignedBox2d& box) const {
  const BSplineSurface& s = *surface_;
  const int p = s.degree_u, q = s.degree_v, count_v = s.count_v(), dim = s.weights.empty() ? 3 : 4;
  const Vec2 middle = box.center();
  const int span_u = find_knot_span(s.knots_u, middle.x(), first_span_[0], last_span_[0]);
  const int span_v = find_knot_span(s.knots_v, middle.y(), first_span_[1], last_span_[1]);
  std::vector<double> ru, rv;
  bezier_rows(s.knots_u, p, span_u, Vec2(box.min().x(), box.max().x()), ru);
  bezier_rows(s.knots_v, q, span_v, Vec2(box.min().y(), box.max().y()), rv);
  const int nu = p + 1, nv = q + 1;
  std::vector<Eigen::Vector4d> half(static_cast<std::size_t>(nu) * nv, Eigen::Vector4d(0, 0, 0, 0));
  BezierNet net{p, q, half};
  for (int i = 0; i < nu; ++i) {
    for (int j = 0; j < nv; ++j) {
      for (int k = 0; k < nv; ++k) {
        const double* pole = net_.data() + dim * ((span_u - p + i) * count_v + span_v - q + k);
        half[i * nv + j] +=
            rv[j * nv + k] * Eigen::Vector4d(pole[0], pole[1], pole[2], dim == 4 ? pole[3] : 1.0);
      }
    }
  }
  for (int i = 0; i < nu; ++i) {
    for (int j = 0; j < nv; ++j) {
      for (int k = 0; k < nu; ++k) net.poles[i * nv + j] += ru[i * nu + k] * half[k * nv + j];
    }
  }
  return net;
}

Vec2 BSplinePatch::deviation(const Eigen::AlignedBox2d& box) const {
  return bend(*bezier(box));
}

}  // namespace flowcage
