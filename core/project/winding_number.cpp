#include "core/project/winding_number.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "core/base/parallel.hpp"

namespace flowcage {
namespace {

using Moments = WindingTree::Moments;
using Products = Eigen::Matrix<double, 6, 1>;  // xx, yy, zz, xy, xz, yz

Products products(const Vec3& d) {
  Products p;
  p << d.x() * d.x(), d.y() * d.y(), d.z() * d.z(), d.x() * d.y(), d.x() * d.z(), d.y() * d.z();
  return p;
}

/// The products of a + b that hold both: 2 sym(a b^T).
Products mixed(const Vec3& a, const Vec3& b) {
  Products p;
  p << 2 * a.x() * b.x(), 2 * a.y() * b.y(), 2 * a.z() * b.z(), a.x() * b.y() + a.y() * b.x(),
      a.x() * b.z() + a.z() * b.x(), a.y() * b.z() + a.z() * b.y();
  return p;
}

Vec3 area_vector(const std::array<Vec3, 3>& t) {
  return 0.5 * (t[1] - t[0]).cross(t[2] - t[0]);
}

/// Exact: the integral of d d^T over a triangle is area / 12 (sum of v v^T + s s^T), s = the sum of v.
Moments of_triangles(std::span<const std::array<Vec3, 3>> triangles) {
  Moments m;
  m.first.setZero();
  m.second.setZero();
  double weight = 0;
  Vec3 plain = Vec3::Zero();
  for (const auto& t : triangles) {
    const Vec3 centroid = (t[0] + t[1] + t[2]) / 3;
    const double area = area_vector(t).norm();
    m.centre += area * centroid;
    weight += area;
    plain += centroid;
  }
  m.centre = weight > 0 ? Vec3(m.centre / weight) : Vec3(plain / static_cast<double>(triangles.size()));
  for (const auto& t : triangles) {
    const Vec3 n = area_vector(t), s = t[0] + t[1] + t[2] - 3 * m.centre;
    Products inner = products(s);
    for (const Vec3& v : t) {
      const Vec3 d = v - m.centre;
      inner += products(d);
      m.radius = std::max(m.radius, d.norm());
    }
    m.area += n;
    m.first += n * (s / 3).transpose();
    m.second += n * (inner / 12).transpose();
  }
  return m;
}

/// Both children's moments about their common centroid. `weight`: sum of the triangles' areas.
Moments joined(const Moments& a, double weight_a, const Moments& b, double weight_b) {
  Moments m;
  const double weight = weight_a + weight_b;
  m.centre = weight > 0 ? Vec3((weight_a * a.centre + weight_b * b.centre) / weight)
                        : Vec3(0.5 * (a.centre + b.centre));
  m.first.setZero();
  m.second.setZero();
  for (const Moments* part : {&a, &b}) {
    const Vec3 shift = part->centre - m.centre;
    m.radius = std::max(m.radius, shift.norm() + part->radius);
    m.area += part->area;
    m.first += part->first + part->area * shift.transpose();
    m.second += part->second + part->area * products(shift).transpose();
    // 2 sym(x shift^T), integrated: row i of `first` is the integral of n_i x.
    for (int i = 0; i < 3; ++i) m.second.row(i) += mixed(part->first.row(i), shift).transpose();
  }
  return m;
}

/// Derivatives of G(x) = -1 / (4 pi |x - p|) at the centre, contracted with the moments: with r = centre - p,
/// G_i = r_i / R^3, G_ij = d_ij / R^3 - 3 r_i r_j / R^5,
/// G_ijk = -3 (d_ij r_k + d_ik r_j + d_jk r_i) / R^5 + 15 r_i r_j r_k / R^7, all over 4 pi.
double expansion(const Moments& m, const Vec3& r) {
  const double square = r.squaredNorm(), inverse = 1 / square;
  const double cube = inverse / std::sqrt(square);
  double sum = m.area.dot(r) + m.first.trace() - 3 * inverse * r.dot(m.first * r);
  const auto& s = m.second;
  const double trace = s.leftCols<3>().rowwise().sum().dot(r);
  const Vec3 divergence(s(0, 0) + s(1, 3) + s(2, 4), s(0, 3) + s(1, 1) + s(2, 5),
                        s(0, 4) + s(1, 5) + s(2, 2));
  Products pr = products(r);
  pr.tail<3>() *= 2;
  sum += 0.5 * inverse * (-3 * (trace + 2 * divergence.dot(r)) + 15 * inverse * r.dot(s * pr));
  return sum * cube;
}

}  // namespace

double solid_angle(const Vec3& a, const Vec3& b, const Vec3& c) {
  const double la = a.norm(), lb = b.norm(), lc = c.norm();
  return 2 * std::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
}

WindingTree build_winding_tree(std::span<const Vec3> points,
                               std::span<const std::array<Index, 3>> triangles) {
  WindingTree tree;
  std::vector<Box3> boxes(triangles.size());
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    for (const Index v : triangles[t]) boxes[t].extend(points[v]);
  }
  tree.boxes = build_box_tree(boxes);
  tree.triangles.reserve(triangles.size());
  for (const Index item : tree.boxes.order) {
    const auto& t = triangles[item];
    tree.triangles.push_back({points[t[0]], points[t[1]], points[t[2]]});
  }
  const std::size_t nodes = tree.boxes.nodes.size();
  tree.moments.resize(nodes);
  std::vector<double> weight(nodes, 0);
  for (std::size_t n = nodes; n-- > 0;) {  // children are numbered after their parent
    const BoxTree::Node& node = tree.boxes.nodes[n];
    if (node.count > 0) {
      const std::span held(tree.triangles.data() + node.first, static_cast<std::size_t>(node.count));
      for (const auto& t : held) weight[n] += area_vector(t).norm();
      tree.moments[n] = of_triangles(held);
    } else {
      const Index left = node.first, right = node.first + 1;
      weight[n] = weight[left] + weight[right];
      tree.moments[n] = joined(tree.moments[left], weight[left], tree.moments[right], weight[right]);
    }
  }
  return tree;
}

double winding_number(const WindingTree& tree, const Vec3& p, double beta) {
  if (tree.boxes.nodes.empty()) return 0;
  std::array<Index, 96> stack;  // deeper than a box tree is
  int top = 0;
  stack[top++] = 0;
  double sum = 0;
  while (top > 0) {
    const Index n = stack[--top];
    const Moments& moments = tree.moments[n];
    const BoxTree::Node& node = tree.boxes.nodes[n];
    const Vec3 r = moments.centre - p;
    const double reach = beta * moments.radius;
    if (r.squaredNorm() > reach * reach) {
      sum += expansion(moments, r);
    } else if (node.count > 0) {
      for (Index i = node.first; i < node.first + node.count; ++i) {
        const auto& [a, b, c] = tree.triangles[i];
        sum += solid_angle(a - p, b - p, c - p);
      }
    } else {
      stack[top++] = node.first + 1;
      stack[top++] = node.first;
    }
  }
  return sum / (4 * std::numbers::pi);
}

void close_rims(std::vector<Vec3>& points, std::vector<std::array<Index, 3>>& triangles) {
  // +1 for each triangle that runs from the lower to the higher number, -1 the other way: a rim is the rest.
  std::map<std::array<Index, 2>, int> balance;
  for (const auto& t : triangles) {
    for (int k = 0; k < 3; ++k) {
      const Index a = t[k], b = t[(k + 1) % 3];
      balance[{std::min(a, b), std::max(a, b)}] += a < b ? 1 : -1;
    }
  }
  std::erase_if(balance, [](const auto& edge) { return edge.second == 0; });
  std::map<Index, Index> parent;
  const auto root = [&](Index v) {
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
  };
  for (const auto& [edge, count] : balance) {
    for (const Index v : edge) parent.emplace(v, v);
    const Index a = root(edge[0]), b = root(edge[1]);
    parent[std::max(a, b)] = std::min(a, b);
  }
  struct Rim {
    Vec3 sum = Vec3::Zero();
    int edges = 0;
    Index centre = no_index;
  };
  std::map<Index, Rim> rims;
  for (const auto& [edge, count] : balance) {
    Rim& rim = rims[root(edge[0])];
    rim.sum += 0.5 * (points[edge[0]] + points[edge[1]]);
    ++rim.edges;
  }
  for (auto& [first, rim] : rims) {
    rim.centre = static_cast<Index>(points.size());
    points.emplace_back(rim.sum / rim.edges);
  }
  for (const auto& [edge, count] : balance) {
    const Index centre = rims[root(edge[0])].centre;
    const bool up = count > 0;  // the fan runs against it
    for (int i = 0; i < std::abs(count); ++i) {
      triangles.push_back({edge[up ? 1 : 0], edge[up ? 0 : 1], centre});
    }
  }
}

void winding_numbers(const WindingTree& tree, std::span<const Vec3> points, double beta,
                     std::span<double> results) {
  constexpr Offset grain = 256;
  parallel_for(static_cast<Offset>(points.size()), grain, [&](Offset begin, Offset end) {
    for (Offset i = begin; i < end; ++i) results[i] = winding_number(tree, points[i], beta);
  });
}

}  // namespace flowcage
