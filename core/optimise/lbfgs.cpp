#include "core/optimise/lbfgs.hpp"

#include <cmath>
#include <deque>
#include <limits>

#include "core/base/parallel.hpp"

namespace flowcage {
namespace {

constexpr Offset grain = 16384;
using Vector = std::vector<Vec3>;

double dot(const Vector& a, const Vector& b) {
  const auto body = [&](Offset begin, Offset end) {
    double sum = 0;
    for (Offset n = begin; n < end; ++n) sum += a[n].dot(b[n]);
    return sum;
  };
  return parallel_reduce(static_cast<Offset>(a.size()), grain, 0.0, body,
                         [](double s, double t) { return s + t; });
}

/// y = x + t d
void add(const Vector& x, double t, const Vector& d, Vector& y) {
  y.resize(x.size());
  parallel_for(static_cast<Offset>(x.size()), grain, [&](Offset begin, Offset end) {
    for (Offset n = begin; n < end; ++n) y[n] = x[n] + t * d[n];
  });
}

struct Pair {
  Vector s, y;
  double inverse_sy;
};

/// Minus the two-loop recursion's product of the inverse second derivative and the gradient.
Vector direction(const std::deque<Pair>& pairs, const Vector& gradient,
                 const LbfgsPreconditioner& preconditioner, double scale) {
  Vector q = gradient;
  std::vector<double> alpha(pairs.size());
  for (std::size_t i = pairs.size(); i-- > 0;) {
    alpha[i] = pairs[i].inverse_sy * dot(pairs[i].s, q);
    add(q, -alpha[i], pairs[i].y, q);
  }
  preconditioner(q);
  for (Vec3& v : q) v *= scale;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const double beta = pairs[i].inverse_sy * dot(pairs[i].y, q);
    add(q, alpha[i] - beta, pairs[i].s, q);
  }
  for (Vec3& v : q) v = -v;
  return q;
}

/// s.y over y.(preconditioner y): fits the preconditioner's size to the newest pair.
double fitted_scale(const Pair& pair, const LbfgsPreconditioner& preconditioner) {
  Vector py = pair.y;
  preconditioner(py);
  const double norm = dot(pair.y, py);
  return norm > 0 ? 1 / (pair.inverse_sy * norm) : 1.0;
}

}  // namespace

LbfgsResult minimise_lbfgs(const LbfgsFunction& function, const LbfgsPreconditioner& preconditioner,
                           const LbfgsSettings& settings, std::vector<Vec3>& x) {
  constexpr double sufficient_decrease = 1e-4;
  constexpr double curvature = 0.9;
  LbfgsResult out;
  Vector gradient(x.size()), trial, trial_gradient(x.size());
  out.value = function(x, gradient);
  out.evaluations = 1;
  std::deque<Pair> pairs;
  std::deque<double> history{out.value};
  double scale = 1;
  while (out.iterations < settings.max_iterations) {
    Vector d = direction(pairs, gradient, preconditioner, scale);
    double slope = dot(d, gradient);
    if (!(slope < 0)) {
      if (pairs.empty()) break;  // stationary
      pairs.clear();
      continue;
    }
    double low = 0;
    double high = std::numeric_limits<double>::infinity();
    double t = 1;
    double best_t =
        0;  // of the points with enough decrease, when the search ends without the Wolfe conditions
    double value = out.value;
    bool wolfe = false;
    for (int n = 0; n < settings.max_line_search && !wolfe; ++n) {
      add(x, t, d, trial);
      const double trial_value = function(trial, trial_gradient);
      ++out.evaluations;
      if (!(trial_value <= out.value + sufficient_decrease * t * slope)) {
        high = t;
      } else {
        best_t = t;
        value = trial_value;
        if (dot(d, trial_gradient) < curvature * slope) {
          low = t;
        } else {
          wolfe = true;
        }
      }
      if (!wolfe) t = std::isinf(high) ? 2 * low : 0.5 * (low + high);
    }
    if (best_t == 0) {
      if (pairs.empty()) break;  // no descent to within rounding
      pairs.clear();
      scale = 1;
      continue;
    }
    if (!wolfe) {
      add(x, best_t, d, trial);
      value = function(trial, trial_gradient);
      ++out.evaluations;
    }
    Pair pair;
    add(trial, -1, x, pair.s);
    add(trial_gradient, -1, gradient, pair.y);
    const double sy = dot(pair.s, pair.y);
    if (sy > 0) {
      pair.inverse_sy = 1 / sy;
      if (std::isfinite(pair.inverse_sy)) {
        scale = fitted_scale(pair, preconditioner);
        pairs.push_back(std::move(pair));
        if (pairs.size() > static_cast<std::size_t>(settings.memory)) pairs.pop_front();
      }
    }
    x.swap(trial);
    gradient.swap(trial_gradient);
    out.value = value;
    ++out.iterations;
    history.push_back(value);
    if (history.size() > 6) history.pop_front();
    if (history.size() == 6 && history.front() - value <= settings.relative_decrease * std::abs(value)) break;
  }
  return out;
}

}  // namespace flowcage
