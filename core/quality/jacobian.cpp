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

// The twelve edges as (from, to), and per corner the three that leave it, in the order of corner_edges, with
// the product of their signs.
constexpr std::array<std::array<int, 2>, 12> edges{
    {{0, 1}, {3, 2}, {4, 5}, {7, 6}, {0, 3}, {1, 2}, {4, 7}, {5, 6}, {0, 4}, {1, 5}, {2, 6}, {3, 7}}};
struct CornerTriple {
  std::array<int, 3> edge;
  double sign;
};
constexpr std::array<CornerTriple, 8> corner_triples{{{{0, 4, 8}, 1},
                                                      {{5, 0, 9}, -1},
                                                      {{1, 5, 10}, 1},
                                                      {{4, 1, 11}, -1},
                                                      {{6, 2, 8}, -1},
                                                      {{2, 7, 9}, 1},
                                                      {{7, 3, 10}, -1},
                                                      {{3, 6, 11}, 1}}};

// A Jacobian over the product of the edges' lengths.
double scaled(double jacobian, double lengths) {
  if (lengths == 0) return 0;
  const double value = jacobian / lengths;
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

JacobianVerdict judge_jacobians(const HexCorners& hex) {
  // In units of the hex's size, so that products of lengths neither overflow nor vanish.
  const double size = (hex[6] - hex[0]).cwiseAbs().maxCoeff() + (hex[7] - hex[1]).cwiseAbs().maxCoeff();
  const double unit = size > 0 && std::isfinite(size) ? 1 / size : 1;
  std::array<Vec3, 12> edge;
  std::array<double, 12> length;
  for (int e = 0; e < 12; ++e) {
    edge[e] = (hex[edges[e][1]] - hex[edges[e][0]]) * unit;
    length[e] = edge[e].norm();
  }
  const Vec3 x = edge[0] + edge[1] + edge[2] + edge[3];
  const Vec3 y = edge[4] + edge[5] + edge[6] + edge[7];
  const Vec3 z = edge[8] + edge[9] + edge[10] + edge[11];
  JacobianVerdict verdict{scaled(triple(x, y, z), x.norm() * y.norm() * z.norm()), false};
  for (const auto& [corner, sign] : corner_triples) {
    const auto& [a, b, c] = corner;
    const double jacobian = sign * triple(edge[a], edge[b], edge[c]);
    const double value = scaled(jacobian, length[a] * length[b] * length[c]);
    verdict.scaled_jacobian = std::min(verdict.scaled_jacobian, value);
    if (!(jacobian > 0)) verdict.inverted = true;
  }
  return verdict;
}

double scaled_jacobian(const HexCorners& hex) {
  return judge_jacobians(hex).scaled_jacobian;
}

bool is_inverted(const HexCorners& hex) {
  return judge_jacobians(hex).inverted;
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
