#pragma once
#include <Eigen/Core>
#include <complex>
#include <vector>

namespace flowcage {

/// Powers of a fixed square matrix A through its eigenbasis, defective matrices included.
///
/// Stam 1998 writes A = X D X^-1 with D diagonal. Subdivision matrices of creases and of valence 3 have
/// Jordan blocks, for which no such X exists, so D is block diagonal here: one block for each cluster of
/// eigenvalues that agree to about 1 %, a single number nearly always. Method: complex Schur form, clusters
/// moved together by unitary swaps, coupling between clusters removed by Sylvester equations (Bavely &
/// Stewart 1979; Golub & Van Loan, Matrix Computations, section 7.6). Well conditioned because clusters are
/// apart.
class SpectralPowers {
 public:
  explicit SpectralPowers(const Eigen::MatrixXd& a);

  /// rows (scale A)^power. Rows known to have no part in the eigenvalue 1 (they sum to 0) lose the rounding
  /// errors that would stay there forever if `skip_one`.
  struct Power {
    int exponent = 0;
    double scale = 1;
    bool skip_one = false;
  };
  Eigen::MatrixXd multiply(const Eigen::MatrixXd& rows, const Power& power) const;

 private:
  struct Block {
    Eigen::Index first = 0;
    Eigen::MatrixXcd matrix;
  };
  std::vector<Block> blocks_;
  Eigen::MatrixXcd basis_, dual_;  // A = basis_ D dual_
};

}  // namespace flowcage
