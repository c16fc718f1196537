#include "core/quality/jacobian.hpp"

#include <cmath>

#include "core/base/parallel.hpp"
#include "core/mesh/visit_cells.hpp"

namespace flowcage {
namespace {

// The ends of the three edges that leave each corner, in right-handed order.
constexpr std::array<std::array<int, 3>, 8> corner_edges{
    {{1, 3, 4}, {2, 0, 5}, {3, 1, 6}, {0, 2, 7}, {7, 5, 0}, {4, 6, 1}, {5, 7, 2}, {6, 4, 3}}};

double triple(const Vec3& a, const Vec3& b, const Vec3& c) {
  return a.dot(b.cross(c));
}

double scaled(const Vec3& a, const Vec3& b, const Vec3& c) {
  const double la = a.norm(), lb = b.norm(), lc = c.norm();
  if (la == 0 || lb == 0 || lc == 0) return 0;
  const double value = triple(a / la, b / lb, c / lc);
  return std::isfinite(value) ? std::clamp(value, -1.0, 1.0) : -1.0;
}

}  // namespace

std::array<double, 8> corner_jacobians(const HexCorners& hex) {
  std::array<double, 8> jacobians{};
  for (int i = 0; i < 8; ++i) {
    const auto& [a, b, c] = corner_edges[i];
    jacobians[i] = triple(hex[a] - hex[i], hex[b] - hex[i], hex[c] - hex[i]);
  }
  return jacobians;
}

double scaled_jacobian(const HexCorners& hex) {
  const Vec3 x = (hex[1] - hex[0]) + (hex[2] - hex[3]) + (hex[5] - hex[4]) + (hex[6] - hex[7]);
  const Vec3 y = (hex[3] - hex[0]) + (hex[2] - hex[1]) + (hex[7] - hex[4]) + (hex[6] - hex[5]);
  const Vec3 z = (hex[4] - hex[0]) + (hex[5] - hex[1]) + (hex[6] - hex[2]) + (hex[7] - hex[3]);
  double least = scaled(x, y, z);
  for (int i = 0; i < 8; ++i) {
    const auto& [a, b, c] = corner_edges[i];
    least = std::min(least, scaled(hex[a] - hex[i], hex[b] - hex[i], hex[c] - hex[i]));
  }
  return least;
}

bool is_inverted(const HexCorners& hex) {
  for (const double jacobian : corner_jacobians(hex)) {
    if (!(jacobian > 0)) return true;
  }
  return false;
}

std::vector<float> scaled_jacobians(const HexView& mesh) {
  std::vector<float> values(static_cast<std::size_t>(mesh.cell_count()));
  parallel_for(mesh.cell_count(), cell_grain, [&](Offset begin, Offset end) {
    visit_cells(mesh, begin, end, [&](Offset cell, const HexPoints& points) {
      values[cell] = static_cast<float>(scaled_jacobian(corners_of(mesh, points)));
    });
  });
  return values;
}

}  // namespace flowcage
