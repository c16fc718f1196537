#pragma once
#include <algorithm>
#include <array>
#include <span>
#include <vector>

#include "core/project/box_tree.hpp"

namespace flowcage {

/// An item's extent: it lies within `slack` of the hull of four points.
struct HullItem {
  std::array<Vec3, 4> points;
  double slack = 0;
};

/// A tree of oriented boxes, four children a node, for nearest-point searches: a box that is turned with the
/// surface is as thin as the surface is flat, where an axis-aligned one is as thick as it is wide. Numbers
/// are single precision about `origin`, rounded outward; visit_nearest adds a margin for its own rounding.
struct OrientedTree {
  static constexpr Index no_child = std::numeric_limits<Index>::max();
  /// Child k's box: |axis[a] . (x - center)| <= half[a] for a = 0, 1, 2. Stored [component][k].
  struct alignas(64) Node {
    float center[3][4], axis[9][4], half[3][4];
    Index child[4];  ///< a node; ~item; no_child
  };
  Vec3 origin = Vec3::Zero();
  double size = 0;  ///< no point of a box is farther from the origin
  std::vector<Node> nodes;
};

/// From a binary tree over the same items: its nodes, three joined to one of four children.
OrientedTree build_oriented_tree(const BoxTree& tree, std::span<const HullItem> items);

/// Calls visit(item) for the items whose box is at most reach() away from the point (some that are a little
/// farther too), mostly nearer boxes first; reach() may shrink between calls. Precondition: a finite point.
/// From many sizes away single precision separates little: visit_near is better there.
template <typename Reach, typename Visit>
void visit_nearest(const OrientedTree& tree, const Vec3& point, const Reach& reach, const Visit& visit) {
  if (tree.nodes.empty()) return;
  const Vec3 local = point - tree.origin;
  const auto x = static_cast<float>(std::clamp(local.x(), -1e18, 1e18));
  const auto y = static_cast<float>(std::clamp(local.y(), -1e18, 1e18));
  const auto z = static_cast<float>(std::clamp(local.z(), -1e18, 1e18));
  const double margin = 1e-6 * (local.cwiseAbs().sum() + tree.size);
  const auto limit = [&] {
    const auto r = static_cast<float>(std::min(reach() + margin, 1e18));
    return r * r;
  };
  struct Entry {
    float squared;
    Index child;
  };
  std::array<Entry, 320> stack;
  int top = 0;
  stack[top++] = {0, 0};
  while (top > 0) {
    const Entry entry = stack[--top];
    const float most = limit();
    if (entry.squared > most) continue;
    if (entry.child < 0) {
      visit(~entry.child);
      continue;
    }
    const OrientedTree::Node& n = tree.nodes[entry.child];
    std::array<float, 4> squared;
    for (int k = 0; k < 4; ++k) {
      const float dx = x - n.center[0][k], dy = y - n.center[1][k], dz = z - n.center[2][k];
      float sum = 0;
      for (int a = 0; a < 3; ++a) {
        const float along = n.axis[3 * a][k] * dx + n.axis[3 * a + 1][k] * dy + n.axis[3 * a + 2][k] * dz;
        const float out = std::max(std::abs(along) - n.half[a][k], 0.0F);
        sum += out * out;
      }
      squared[k] = sum;
    }
    // Farther ones first, so that the nearest is on top.
    const int bottom = top;
    for (int k = 0; k < 4; ++k) {
      if (n.child[k] == OrientedTree::no_child || squared[k] > most) continue;
      int place = top++;
      for (; place > bottom && stack[place - 1].squared < squared[k]; --place)
        stack[place] = stack[place - 1];
      stack[place] = {squared[k], n.child[k]};
    }
  }
}

}  // namespace flowcage
