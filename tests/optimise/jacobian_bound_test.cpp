#include "core/optimise/jacobian_bound.hpp"

#include <random>

#include "tests/catch.hpp"

using namespace flowcage;

namespace {

HexCornerPoints unit_cube() {
  HexCornerPoints p;
  for (int c = 0; c < 8; ++c) p[c] = Vec3(hex_corner_ijk[c][0], hex_corner_ijk[c][1], hex_corner_ijk[c][2]);
  return p;
}

/// det J of the trilinear map, from its definition.
double jacobian_at(const HexCornerPoints& p, const Vec3& t) {
  Eigen::Matrix3d j = Eigen::Matrix3d::Zero();
  for (int c = 0; c < 8; ++c) {
    for (int a = 0; a < 3; ++a) {
      double shape = hex_corner_ijk[c][a] == 1 ? 1 : -1;
      for (int b = 0; b < 3; ++b) {
        if (b != a) shape *= hex_corner_ijk[c][b] == 1 ? t[b] : 1 - t[b];
      }
      j.col(a) += shape * p[c];
    }
  }
  return j.determinant();
}

HexCornerPoints shaken_cube(double size, std::mt19937& random) {
  HexCornerPoints p = unit_cube();
  for (Vec3& x : p) {
    for (int a = 0; a < 3; ++a) x[a] += size * (2.0 * static_cast<double>(random()) / 4294967295.0 - 1.0);
  }
  return p;
}

}  // namespace

TEST_CASE("jacobian bound: an affine hex has 27 equal coefficients, its volume") {
  HexCornerPoints p = unit_cube();
  Eigen::Matrix3d a;
  a << 2, 0.3, 0, 0.1, 3, 0.2, 0, 0.5, 0.25;
  for (Vec3& x : p) x = a * x + Vec3(5, -7, 1);
  for (const double b : jacobian_bernstein(p)) CHECK(b == Approx(a.determinant()).epsilon(1e-13));
  CHECK(jacobian_lower_bound(p) == Approx(a.determinant()).epsilon(1e-12));
  CHECK(jacobian_lower_bound(p) < a.determinant());
  CHECK(jacobian_sign(p) == JacobianSign::positive);
}

TEST_CASE("jacobian bound: the coefficients are those of det J") {
  std::mt19937 random(3);
  for (int n = 0; n < 50; ++n) {
    const HexCornerPoints p = shaken_cube(0.6, random);
    const std::array<double, 27> b = jacobian_bernstein(p);
    const Vec3 t(0.2, 0.55, 0.9);
    double sum = 0;
    for (int m = 0; m < 27; ++m) {
      const std::array<int, 3> degree{m % 3, m / 3 % 3, m / 9};
      double value = b[m];
      for (int a = 0; a < 3; ++a) {
        const int d = degree[a];
        value *= (d == 1 ? 2 : 1) * std::pow(t[a], d) * std::pow(1 - t[a], 2 - d);
      }
      sum += value;
    }
    CHECK(sum == Approx(jacobian_at(p, t)).margin(1e-13));
  }
}

TEST_CASE("jacobian bound: below every sample, and closer with each split") {
  std::mt19937 random(4);
  int positive = 0;
  int hidden = 0;  // positive at the corners, negative inside
  for (int n = 0; n < 400; ++n) {
    const HexCornerPoints p = shaken_cube(0.55, random);
    double least = 1e9;
    for (int s = 0; s < 9 * 9 * 9; ++s) {
      const std::array<int, 3> at{s % 9, s / 9 % 9, s / 81};
      least = std::min(least, jacobian_at(p, Vec3(at[0], at[1], at[2]) / 8.0));
    }
    CHECK(jacobian_lower_bound(p) <= least);
    const double sharp = jacobian_lower_bound(p, 60);
    CHECK(sharp <= least);
    CHECK(sharp >= jacobian_lower_bound(p));
    CHECK(sharp == Approx(least).margin(0.05));
    const JacobianSign sign = jacobian_sign(p);
    if (least < 0) CHECK(sign == JacobianSign::not_positive);
    if (sharp > 0) CHECK(sign == JacobianSign::positive);
    positive += sign == JacobianSign::positive ? 1 : 0;
    hidden += sign == JacobianSign::not_positive && min_scaled_jacobian(p) > 0 ? 1 : 0;
  }
  CHECK(positive > 20);
  CHECK(hidden > 0);
}

TEST_CASE("jacobian bound: degenerate and broken hexes") {
  HexCornerPoints flat = unit_cube();
  for (Vec3& x : flat) x[2] = 0;
  CHECK(jacobian_sign(flat) != JacobianSign::positive);
  CHECK(min_scaled_jacobian(flat) == 0);
  HexCornerPoints point;
  point.fill(Vec3(1, 2, 3));
  CHECK(jacobian_sign(point) != JacobianSign::positive);
  CHECK(min_scaled_jacobian(point) == 0);
  HexCornerPoints broken = unit_cube();
  broken[3][1] = std::numeric_limits<double>::quiet_NaN();
  CHECK(jacobian_sign(broken) == JacobianSign::not_positive);
  CHECK(std::isnan(jacobian_lower_bound(broken)));
  CHECK(std::isnan(min_scaled_jacobian(broken)));
}

TEST_CASE("scaled Jacobian: sine of the angle of a sheared cube, at any size") {
  for (const double size : {1e-150, 1e-6, 1.0, 1e4, 1e150}) {
    HexCornerPoints p = unit_cube();
    for (Vec3& x : p) x = size * Vec3(x[0] + x[1], x[1], x[2]);  // 45 degrees
    CHECK(min_scaled_jacobian(p) == Approx(std::sqrt(0.5)).epsilon(1e-12));
  }
}

TEST_CASE("jacobian bound: the cheap proof holds only where the full one does, and samples agree") {
  std::mt19937 random(5);
  const auto uniform = [&] { return static_cast<double>(random()) / 4294967295.0; };
  int cheap = 0;
  int only_full = 0;
  int near_zero = 0;
  for (int n = 0; n < 40000; ++n) {
    // Parallelepipeds of any stretch, some nearly flat, shaken a little or much.
    HexCornerPoints p = shaken_cube(std::pow(10, -6 * uniform()) * 0.6, random);
    Eigen::Matrix3d map;
    for (double& entry : map.reshaped()) entry = 2 * uniform() - 1;
    map.col(0) *= std::pow(10, -8 * uniform());
    if (n % 4 == 0) map.col(1) = map.col(2) + std::pow(10, -15 * uniform()) * map.col(1);
    const Vec3 shift = Vec3(3, -2, 7) * uniform();
    for (Vec3& x : p) x = map * x + shift;
    const bool proved = positive_near_affine(p);
    cheap += proved ? 1 : 0;
    // Any split count: the first coefficients decide already.
    if (proved) {
      REQUIRE(jacobian_lower_bound(p) > 0);
      REQUIRE(min_scaled_jacobian(p) > 0);
      for (int s = 0; s < 27; ++s) REQUIRE(jacobian_at(p, Vec3(s % 3, s / 3 % 3, s / 9) / 2.0) > 0);
    } else if (jacobian_lower_bound(p) > 0) {
      ++only_full;
    }
    near_zero += std::abs(min_scaled_jacobian(p)) < 1e-6 ? 1 : 0;
  }
  CHECK(cheap > 4000);
  CHECK(only_full > 500);
  CHECK(near_zero > 500);
  HexCornerPoints mirrored = unit_cube();
  for (Vec3& x : mirrored) x[1] = -x[1];
  CHECK_FALSE(positive_near_affine(mirrored));
  HexCornerPoints broken = unit_cube();
  broken[6][2] = std::numeric_limits<double>::infinity();
  CHECK_FALSE(positive_near_affine(broken));
}
