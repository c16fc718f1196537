#include "core/project/cell_start.hpp"

#include <algorithm>
#include <cmath>

namespace flowcage {
namespace {

struct TrianglePoint {
  Vec3 barycentric;
  double squared;
};

/// Nearest point of a triangle (Ericson, Real-Time Collision Detection, 5.1.5).
TrianglePoint closest_on_triangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, ac = c - a, ap = p - a;
  const auto at = [&](double v, double w) {
    return TrianglePoint{Vec3(1 - v - w, v, w), (ap - v * ab - w * ac).squaredNorm()};
  };
  const double d1 = ab.dot(ap), d2 = ac.dot(ap);
  if (d1 <= 0 && d2 <= 0) return at(0, 0);
  const Vec3 bp = p - b;
  const double d3 = ab.dot(bp), d4 = ac.dot(bp);
  if (d3 >= 0 && d4 <= d3) return at(1, 0);
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return at(d1 - d3 > 0 ? d1 / (d1 - d3) : 0, 0);
  const Vec3 cp = p - c;
  const double d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d6 >= 0 && d5 <= d6) return at(0, 1);
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return at(0, d2 - d6 > 0 ? d2 / (d2 - d6) : 0);
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
    const double sum = (d4 - d3) + (d5 - d6);
    const double w = sum > 0 ? (d4 - d3) / sum : 0;
    return at(1 - w, w);
  }
  const double denominator = va + vb + vc;
  if (!(denominator > 0)) return at(0, 0);
  return at(vb / denominator, vc / denominator);
}

}  // namespace

CellStart cell_start(const PatchCell& cell, const Vec3& query) {
  const TrianglePoint lower = closest_on_triangle(query, cell.p00, cell.p10, cell.p11);
  const TrianglePoint upper = closest_on_triangle(query, cell.p00, cell.p11, cell.p01);
  Vec2 fraction;
  double squared = 0;
  if (lower.squared <= upper.squared) {
    fraction = {lower.barycentric[1] + lower.barycentric[2], lower.barycentric[2]};
    squared = lower.squared;
  } else {
    fraction = {upper.barycentric[1], upper.barycentric[1] + upper.barycentric[2]};
    squared = upper.squared;
  }
  return {fraction, std::sqrt(squared)};
}

}  // namespace flowcage
