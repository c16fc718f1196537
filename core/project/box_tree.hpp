#pragma once
#include <array>
#include <cmath>
#include <span>
#include <vector>

#include "core/base/types.hpp"

namespace flowcage {

/// A binary tree of axis-aligned boxes over items (surface cells, curve pieces), split by the surface-area
/// heuristic. Node 0 is the root. order[] lists the items so that each leaf's are neighbours.
struct BoxTree {
  struct Node {
    std::array<double, 3> low, high;
    Index first = 0;  ///< leaf: into order; inner: the left child (the right one follows it)
    Index count = 0;  ///< 0: inner
  };
  std::vector<Node> nodes;
  std::vector<Index> order;
};

BoxTree build_box_tree(std::span<const Box3> boxes);

/// Squared distance of a point from a node's box.
inline double squared_distance(const BoxTree::Node& node, const Vec3& p) {
  double sum = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const double below = node.low[axis] - p[axis], above = p[axis] - node.high[axis];
    const double d = below > above ? below : above;
    if (d > 0) sum += d * d;
  }
  return sum;
}

/// Calls visit(item) for the items whose box is at most reach() away from the point, nearer boxes first;
/// reach() may shrink between calls.
template <typename Reach, typename Visit>
void visit_near(const BoxTree& tree, const Vec3& point, const Reach& reach, const Visit& visit) {
  if (tree.nodes.empty()) return;
  struct Entry {
    double squared;
    Index node;
  };
  std::array<Entry, 96> stack;
  int top = 0;
  stack[top++] = {squared_distance(tree.nodes[0], point), 0};
  while (top > 0) {
    const Entry entry = stack[--top];
    const double r = reach();
    if (entry.squared > r * r) continue;
    const BoxTree::Node& node = tree.nodes[entry.node];
    if (node.count > 0) {
      for (Index i = 0; i < node.count; ++i) visit(tree.order[node.first + i]);
      continue;
    }
    const Entry left{squared_distance(tree.nodes[node.first], point), node.first};
    const Entry right{squared_distance(tree.nodes[node.first + 1], point), node.first + 1};
    const bool left_first = left.squared <= right.squared;
    stack[top++] = left_first ? right : left;
    stack[top++] = left_first ? left : right;
  }
}

/// The interval of t in which origin + t direction is inside of the box; empty if first > second.
inline std::array<double, 2> line_interval(const BoxTree::Node& node, const Vec3& origin,
                                           const Vec3& direction) {
  double low = -1e300, high = 1e300;
  for (int axis = 0; axis < 3; ++axis) {
    const double a = node.low[axis] - origin[axis], b = node.high[axis] - origin[axis];
    if (direction[axis] == 0) {
      if (a > 0 || b < 0) return {1, 0};
      continue;
    }
    double enter = a / direction[axis], leave = b / direction[axis];
    if (enter > leave) std::swap(enter, leave);
    if (enter > low) low = enter;
    if (leave < high) high = leave;
  }
  return {low, high};
}

/// Calls visit(item) for the items whose box meets the line within |t| <= reach(), those of smaller |t|
/// first.
template <typename Reach, typename Visit>
void visit_along(const BoxTree& tree, const Vec3& origin, const Vec3& direction, const Reach& reach,
                 const Visit& visit) {
  if (tree.nodes.empty()) return;
  struct Entry {
    double distance;
    Index node;
  };
  const auto entry_of = [&](Index node) {
    const auto [low, high] = line_interval(tree.nodes[node], origin, direction);
    if (low > high) return Entry{1e300, node};
    return Entry{low > 0 ? low : high < 0 ? -high : 0.0, node};
  };
  std::array<Entry, 96> stack;
  int top = 0;
  stack[top++] = entry_of(0);
  while (top > 0) {
    const Entry entry = stack[--top];
    if (!(entry.distance <= reach()) || entry.distance == 1e300) continue;
    const BoxTree::Node& node = tree.nodes[entry.node];
    if (node.count > 0) {
      for (Index i = 0; i < node.count; ++i) visit(tree.order[node.first + i]);
      continue;
    }
    const Entry left = entry_of(node.first), right = entry_of(node.first + 1);
    const bool left_first = left.distance <= right.distance;
    stack[top++] = left_first ? right : left;
    stack[top++] = left_first ? left : right;
  }
}

}  // namespace flowcage
