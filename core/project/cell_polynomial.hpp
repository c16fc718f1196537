#pragma once
#include <functional>
#include <span>
#include <vector>

#include "core/project/closest_on_curve.hpp"
#include "core/target/parametric_patch.hpp"

namespace flowcage {

/// A tensor polynomial over [-1, 1]^2 (degree_t == 0: a curve over [-1, 1]) in the monomials s^i t^j.
/// Coefficients by rows j, each of degree_s + 1 points: x y z at [3 (j (degree_s + 1) + i)]. Does not own
/// them.
struct CellPolynomial {
  int degree_s = -1;  ///< -1: there is none
  int degree_t = 0;
  const double* coefficients = nullptr;
  bool empty() const { return degree_s < 0; }
};

/// Polynomials in one array; [number] is a view that holds until the next append.
class CellPolynomials {
 public:
  struct Fitted {
    int degree_s = -1, degree_t = 0;
    std::vector<double> coefficients;
  };
  void append(const Fitted& fitted);
  CellPolynomial operator[](std::size_t number) const {
    const Place& p = places_[number];
    return {p.degree_s, p.degree_t, coefficients_.data() + p.first};
  }

 private:
  struct Place {
    Offset first = 0;
    int degree_s = -1, degree_t = 0;
  };
  std::vector<Place> places_;
  std::vector<double> coefficients_;
};

/// Positions at all pairs of s and t, position of (s[i], t[j]) at [j * s.size() + i].
using GridSampler =
    std::function<void(std::span<const double> s, std::span<const double> t, std::span<Vec3> positions)>;

enum class CellKind : std::uint8_t { surface, curve };

/// Interpolates at 5, 9 and then 13 Chebyshev points a direction (a curve: at t = 0 alone), leaves out what
/// adds less than the tolerance, and accepts the polynomial if it agrees within the tolerance at points where
/// the interpolation's error is largest. Empty if none does.
CellPolynomials::Fitted fit_cell_polynomial(const GridSampler& sample, CellKind kind, double tolerance);

/// Position and derivatives by s and t at (s, t), by Horner's rule.
PatchCurvature evaluate(const CellPolynomial& polynomial, const Vec2& st);

/// A polynomial as a patch, for closest_point.
class PolynomialPatch final : public ParametricPatch {
 public:
  explicit PolynomialPatch(const CellPolynomial& polynomial) : polynomial_(polynomial) {}
  PatchPoint first(const Vec2& st) const override;
  PatchCurvature second(const Vec2& st) const override { return evaluate(polynomial_, st); }
  Eigen::AlignedBox2d domain() const override { return {Vec2(-1, -1), Vec2(1, 1)}; }
  bool periodic_u() const override { return false; }
  bool periodic_v() const override { return false; }

 private:
  CellPolynomial polynomial_;
};

/// The same for a curve, for closest_on_curve.
class PolynomialCurve final : public ParametricCurve {
 public:
  explicit PolynomialCurve(const CellPolynomial& polynomial) : polynomial_(polynomial) {}
  CurveDerivatives second(double s) const override;
  std::array<double, 2> domain() const override { return {-1, 1}; }

 private:
  CellPolynomial polynomial_;
};

}  // namespace flowcage
