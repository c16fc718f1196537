#pragma once
#include <Eigen/Core>
#include <array>
#include <vector>

#include "core/target/parametric_patch.hpp"

namespace flowcage {

/// A rational surface over one box of its parameters in Bezier form, by fractions (s, t) of the box in [0,
/// 1]^2. poles[i * (degree_t + 1) + j], i along s: (w x, w y, w z, w); w = 1 where the surface is polynomial.
struct BezierNet {
  int degree_s = 1, degree_t = 1;
  std::vector<Eigen::Vector4d> poles;
  const Eigen::Vector4d& pole(int i, int j) const { return poles[i * (degree_t + 1) + j]; }
  Vec3 point(int i, int j) const { return pole(i, j).head<3>() / pole(i, j)[3]; }
};

/// A sum of homogeneous poles (w x, w y, w z, w) and its derivatives.
struct HomogeneousPoint {
  Eigen::Vector4d value, u, v, uu, uv, vv;
};

/// Of the surface A / w (The NURBS Book, 4.20).
PatchCurvature quotient(const HomogeneousPoint& at);

/// The nets over the lower and the upper half along axis 0 (s) or 1 (t), by de Casteljau's algorithm.
std::array<BezierNet, 2> halves(const BezierNet& net, int axis);

/// Every point of the surface is within the sum of the two numbers of the convex hull of the four corners:
/// what bends along s and what bends along t (convex-hull property); infinite if a weight is not positive.
Vec2 bend(const BezierNet& net);

/// Position and derivatives by s and t at the nine pairs of 0, 1/2 and 1; (s, t) = (a / 2, b / 2) at [3 a +
/// b].
std::array<PatchCurvature, 9> nine_samples(const BezierNet& net);

/// The same in the middle alone.
PatchCurvature middle_of(const BezierNet& net);

}  // namespace flowcage
