#include "core/refit/cgls.hpp"

#include <cassert>
#include <cmath>

#include "core/base/parallel.hpp"

namespace flowcage {
namespace {

constexpr Offset grain = 1024;

double squared_norm(std::span<const Vec3> x) {
  return parallel_reduce(
      static_cast<Offset>(x.size()), grain, 0.0,
      [&](Offset begin, Offset end) {
        double sum = 0;
        for (Offset i = begin; i < end; ++i) sum += x[i].squaredNorm();
        return sum;
      },
      [](double a, double b) { return a + b; });
}

/// W = a^2 d d^T + b^2 (I - d d^T) of each row.
class Weights {
 public:
  explicit Weights(const RowMetric& metric)
      : directions_(metric.directions),
        along_(metric.along * metric.along),
        across_(metric.across * metric.across) {}

  Vec3 times(Offset row, const Vec3& x) const {
    if (directions_.empty() || directions_[row].isZero(0)) return x;
    const Vec3& d = directions_[row];
    return across_ * x + (along_ - across_) * d.dot(x) * d;
  }

 private:
  const std::vector<Vec3>& directions_;
  double along_, across_;
};

/// Turns rows x into W x; the sum of x . W x.
double weigh(const Weights& weights, std::vector<Vec3>& rows) {
  return parallel_reduce(
      static_cast<Offset>(rows.size()), grain, 0.0,
      [&](Offset begin, Offset end) {
        double sum = 0;
        for (Offset i = begin; i < end; ++i) {
          const Vec3 weighed = weights.times(i, rows[i]);
          sum += weighed.dot(rows[i]);
          rows[i] = weighed;
        }
        return sum;
      },
      [](double x, double y) { return x + y; });
}

/// b - A x.
std::vector<Vec3> residual(const LeastSquaresMatrix& matrix, std::span<const Vec3> right_side,
                           std::span<const Vec3> x) {
  std::vector<Vec3> r = apply_stencils(matrix.rows, x);
  for (std::size_t i = 0; i < r.size(); ++i) r[i] = right_side[i] - r[i];
  return r;
}

}  // namespace

StencilTable transpose_of(const StencilTable& table) {
  StencilTable t;
  t.control_vertex_count = table.size();
  t.offsets.assign(static_cast<std::size_t>(table.control_vertex_count) + 1, 0);
  for (const Index c : table.indices) ++t.offsets[c + 1];
  for (std::size_t c = 1; c < t.offsets.size(); ++c) t.offsets[c] += t.offsets[c - 1];
  t.indices.resize(table.indices.size());
  t.weights.resize(table.weights.size());
  t.mirrors = table.mirrors;
  t.of_vectors = true;
  for (int axis = 0; axis < 3; ++axis) t.mirrored_weights[axis].resize(table.mirrored_weights[axis].size());
  std::vector<Offset> next(t.offsets.begin(), t.offsets.end() - 1);
  for (Index r = 0; r < table.size(); ++r) {
    for (Offset k = table.offsets[r]; k < table.offsets[r + 1]; ++k) {
      const Offset at = next[table.indices[k]]++;
      t.indices[at] = r;
      t.weights[at] = table.weights[k];
      for (int axis = 0; axis < 3; ++axis) {
        if (t.mirrors.on[axis]) t.mirrored_weights[axis][at] = table.mirrored_weights[axis][k];
      }
    }
  }
  return t;
}

LeastSquaresMatrix prepare_least_squares(StencilTable rows) {
  LeastSquaresMatrix m;
  m.transpose = transpose_of(rows);
  m.rows = std::move(rows);
  m.column_norms.assign(static_cast<std::size_t>(m.transpose.size()), 0.0);
  for (Index c = 0; c < m.transpose.size(); ++c) {
    double sum = 0;
    for (Offset k = m.transpose.offsets[c]; k < m.transpose.offsets[c + 1]; ++k) {
      sum += m.transpose.weights[k] * m.transpose.weights[k];
    }
    m.column_norms[c] = std::sqrt(sum);
  }
  return m;
}

// Notation: A x is apply_stencils and, of differences, apply_to_vectors; the unknown is y with x = start + S
// y, S = 1/column norm. r = W (b - A x), g = S A^T r - d^2 S^2 y (the negative gradient), p the search
// direction, q = W A S p.
CglsResult solve_cgls(const LeastSquaresMatrix& matrix, std::span<const Vec3> right_side,
                      std::span<const Vec3> start, const CglsSettings& settings, const RowMetric& metric) {
  const Index columns = matrix.rows.control_vertex_count;
  assert(static_cast<Index>(right_side.size()) == matrix.rows.size());
  assert(static_cast<Index>(start.size()) == columns);
  CglsResult result;
  result.solution.assign(start.begin(), start.end());

  std::vector<double> scale(static_cast<std::size_t>(columns), 1.0);
  for (Index c = 0; c < columns; ++c) {
    if (matrix.column_norms[c] > 0) scale[c] = 1 / matrix.column_norms[c];
  }
  const double damping2 = settings.damping * settings.damping;

  const Weights weights(metric);
  std::vector<Vec3> r = residual(matrix, right_side, start);
  // A gradient below the rounding of its own terms is noise: steps along it would wander off without bound.
  const double terms = squared_norm(right_side) + squared_norm(apply_stencils(matrix.rows, start));
  weigh(weights, r);

  std::vector<Vec3> y(static_cast<std::size_t>(columns), Vec3::Zero());
  const auto negative_gradient = [&] {
    std::vector<Vec3> g = apply_to_vectors(matrix.transpose, r);
    for (Index c = 0; c < columns; ++c) g[c] = scale[c] * (g[c] - damping2 * scale[c] * y[c]);
    return g;
  };

  std::vector<Vec3> g = negative_gradient();
  std::vector<Vec3> p = g;
  double gamma = squared_norm(g);
  const double stop = std::max(settings.tolerance * settings.tolerance * gamma, 1e-31 * terms);
  std::vector<Vec3> step(static_cast<std::size_t>(columns));
  while (result.iterations < settings.max_iterations && gamma > stop) {
    for (Index c = 0; c < columns; ++c) step[c] = scale[c] * p[c];
    std::vector<Vec3> q = apply_to_vectors(matrix.rows, step);
    const double curvature = weigh(weights, q) + damping2 * squared_norm(step);
    // The largest eigenvalue is of order 1 (unit columns): a direction like this is in the null space.
    if (!(curvature > 1e-20 * squared_norm(p)) || !std::isfinite(curvature)) break;
    const double alpha = gamma / curvature;
    for (Index c = 0; c < columns; ++c) y[c] += alpha * p[c];
    parallel_for(static_cast<Offset>(r.size()), grain, [&](Offset begin, Offset end) {
      for (Offset i = begin; i < end; ++i) r[i] -= alpha * q[i];
    });
    g = negative_gradient();
    const double previous = gamma;
    gamma = squared_norm(g);
    const double beta = gamma / previous;
    for (Index c = 0; c < columns; ++c) p[c] = g[c] + beta * p[c];
    ++result.iterations;
  }
  for (Index c = 0; c < columns; ++c) result.solution[c] += scale[c] * y[c];
  r = residual(matrix, right_side, result.solution);
  result.residual_norm = std::sqrt(weigh(weights, r));
  return result;
}

}  // namespace flowcage
