#include "core/limit/spectral_powers.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/Jacobi>
#include <Eigen/LU>
#include <algorithm>
#include <numeric>

namespace flowcage {
namespace {

using Complex = std::complex<double>;

// Numbers of clusters: eigenvalues linked by small distances share one.
std::vector<int> cluster(const Eigen::VectorXcd& values) {
  const auto count = static_cast<int>(values.size());
  std::vector<int> id(static_cast<std::size_t>(count));
  std::iota(id.begin(), id.end(), 0);
  for (int i = 0; i < count; ++i) {
    for (int j = 0; j < i; ++j) {
      // A Jordan block of size k scatters its eigenvalue by about eps^(1/k); the smallest that is not 0 is
      // 1/64.
      const double near = 0.01 * std::max(std::abs(values[i]), std::abs(values[j])) + 1e-3;
      if (id[i] != id[j] && std::abs(values[i] - values[j]) < near) {
        std::replace(id.begin(), id.end(), std::max(id[i], id[j]), std::min(id[i], id[j]));
      }
    }
  }
  return id;
}

// Exchanges the neighbouring eigenvalues k and k + 1 of the Schur form U T U^H.
void swap_eigenvalues(Eigen::MatrixXcd& t, Eigen::MatrixXcd& u, Eigen::Index k) {
  Eigen::JacobiRotation<Complex> rotation;
  rotation.makeGivens(t(k, k + 1), t(k + 1, k + 1) - t(k, k));
  t.applyOnTheLeft(k, k + 1, rotation.adjoint());
  t.applyOnTheRight(k, k + 1, rotation);
  u.applyOnTheRight(k, k + 1, rotation);
  t(k + 1, k) = 0;
}

}  // namespace

SpectralPowers::SpectralPowers(const Eigen::MatrixXd& a) {
  const Eigen::ComplexSchur<Eigen::MatrixXcd> schur(a.cast<Complex>());
  Eigen::MatrixXcd t = schur.matrixT().triangularView<Eigen::Upper>(), u = schur.matrixU();
  std::vector<int> id = cluster(t.diagonal());
  for (std::size_t end = id.size(); end > 1; --end) {  // bubble sort
    for (std::size_t k = 0; k + 1 < end; ++k) {
      if (id[k] <= id[k + 1]) continue;
      std::swap(id[k], id[k + 1]);
      swap_eigenvalues(t, u, static_cast<Eigen::Index>(k));
    }
  }
  for (std::size_t k = 0; k < id.size();) {
    std::size_t end = k;
    while (end < id.size() && id[end] == id[k]) ++end;
    const auto first = static_cast<Eigen::Index>(k), size = static_cast<Eigen::Index>(end - k);
    blocks_.push_back({first, t.block(first, first, size, size)});
    k = end;
  }

  // W is unit block triangular with T W = W D: T_bb W_bc - W_bc T_cc = -(T_bc + sum of T_ba W_ac).
  Eigen::MatrixXcd w = Eigen::MatrixXcd::Identity(t.rows(), t.cols());
  for (std::size_t c = 0; c < blocks_.size(); ++c) {
    const auto& column = blocks_[c];
    const auto columns = column.matrix.cols();
    for (std::size_t b = c; b-- > 0;) {
      const auto& row = blocks_[b];
      const auto rows = row.matrix.rows();
      const auto between = row.first + rows;
      Eigen::MatrixXcd right = -t.block(row.first, between, rows, column.first + columns - between) *
                               w.block(between, column.first, column.first + columns - between, columns);
      for (Eigen::Index j = 0; j < columns; ++j) {
        for (Eigen::Index i = 0; i < j; ++i) {
          right.col(j) += w.block(row.first, column.first + i, rows, 1) * column.matrix(i, j);
        }
        const Eigen::MatrixXcd shifted =
            row.matrix - column.matrix(j, j) * Eigen::MatrixXcd::Identity(rows, rows);
        w.block(row.first, column.first + j, rows, 1) =
            shifted.triangularView<Eigen::Upper>().solve(right.col(j));
      }
    }
  }
  basis_ = u * w;
  dual_ = w.triangularView<Eigen::Upper>().solve(u.adjoint());
}

Eigen::MatrixXd SpectralPowers::multiply(const Eigen::MatrixXd& rows, const Power& power) const {
  Eigen::MatrixXcd coefficients = rows.cast<Complex>() * basis_;
  for (const Block& block : blocks_) {
    auto part = coefficients.middleCols(block.first, block.matrix.cols());
    if (power.skip_one && std::abs(block.matrix(0, 0) - 1.0) < 1e-6) {
      part.setZero();
    } else if (block.matrix.cols() == 1) {
      part *= std::pow(power.scale * block.matrix(0, 0), power.exponent);
    } else {
      for (int k = 0; k < power.exponent; ++k) part = (part * (power.scale * block.matrix)).eval();
    }
  }
  return (coefficients * dual_).real();
}

}  // namespace flowcage
