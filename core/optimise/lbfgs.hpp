#pragma once
#include <functional>
#include <span>
#include <vector>

#include "core/base/types.hpp"

namespace flowcage {

struct LbfgsSettings {
  int max_iterations = 100;
  int memory = 8;                   ///< pairs of steps and gradient differences that are kept
  double relative_decrease = 1e-4;  ///< stop when 5 iterations lowered the value by less than this share
  int max_line_search = 24;         ///< evaluations in one line search
};

struct LbfgsResult {
  double value = 0;
  int iterations = 0;
  int evaluations = 0;
};

/// Value at `x` and, into `gradient`, its derivative. An infinite or NaN value means that x is not allowed.
using LbfgsFunction = std::function<double(std::span<const Vec3> x, std::span<Vec3> gradient)>;
/// Applies a symmetric positive (semi)definite matrix close to the inverse of the second derivative, in
/// place.
using LbfgsPreconditioner = std::function<void(std::span<Vec3> vector)>;

/// Minimises from `x` on, which is left at the best point found: never higher than at the start.
/// L-BFGS (Nocedal & Wright, Numerical Optimization, algorithm 7.4) with a weak Wolfe line search by
/// bisection (Lewis & Overton, Math. Program. 141, 2013), which holds for functions that are infinite in
/// places. Precondition: the value at the start is finite. The same bits for any number of threads.
LbfgsResult minimise_lbfgs(const LbfgsFunction& function, const LbfgsPreconditioner& preconditioner,
                           const LbfgsSettings& settings, std::vector<Vec3>& x);

}  // namespace flowcage
