#pragma once
#include <span>
#include <vector>

#include "core/mesh/stencil_table.hpp"

namespace flowcage {

/// A sparse matrix prepared for least squares: the rows, their transpose as rows of its own (so that A^T y is
/// a gather, parallel and in a fixed order), and the columns' norms.
struct LeastSquaresMatrix {
  StencilTable rows;                 ///< A: #rows by #columns
  StencilTable transpose;            ///< A^T: #columns by #rows
  std::vector<double> column_norms;  ///< #columns, Euclidean, of `weights`
};

/// The transpose: row c holds (r, a_rc) with r ascending; at mirror planes axis by axis, for
/// apply_to_vectors.
StencilTable transpose_of(const StencilTable& table);
LeastSquaresMatrix prepare_least_squares(StencilTable rows);

/// How the three coordinates of a row's residual r count: |r|^2 (no directions), or, with a unit vector d, as
/// (a d.r)^2 + b^2 |r - d (d.r)|^2. With d the normal, a = 1 and b < 1 that is the tangent distance of Wang,
/// Pottmann & Liu (2006) to a surface; with d the tangent, a < 1 and b = 1 that to a curve.
struct RowMetric {
  std::vector<Vec3> directions;  ///< #rows, or empty; a zero direction: that row counts as |r|^2
  double along = 1, across = 1;  ///< a, b
};

struct CglsSettings {
  int max_iterations = 60;
  double tolerance = 1e-6;  ///< stop when the gradient's norm fell by this factor
  double damping = 0;       ///< d: adds d^2 |x - start|^2, which also makes singular systems well-posed
};

struct CglsResult {
  std::vector<Vec3> solution;  ///< #columns
  int iterations = 0;
  double residual_norm = 0;  ///< |A x - b| in the metric
};

/// Minimises |A x - b|^2 + d^2 |x - start|^2 over #columns points at once by conjugate gradients for least
/// squares (Hestenes & Stiefel 1952; Bjoerck, Numerical Methods for Least Squares Problems, alg. 7.4.1) with
/// column scaling, from a warm start. On a singular system without damping: the solution nearest to `start`
/// (in the scaled norm). At mirror planes A has rows of its own for each coordinate; a coordinate that no row
/// holds (normal to the plane, of a vertex in it) keeps its start. The same bits on any number of threads.
/// Precondition: sizes agree.
CglsResult solve_cgls(const LeastSquaresMatrix& matrix, std::span<const Vec3> right_side,
                      std::span<const Vec3> start, const CglsSettings& settings,
                      const RowMetric& metric = {});

}  // namespace flowcage
