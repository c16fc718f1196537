#include "core/project/box_tree.hpp"

#include <algorithm>
#include <limits>
#include <numeric>

namespace flowcage {
namespace {

constexpr int bins = 16;
constexpr Index leaf_size = 2;
constexpr int max_depth = 80;  // the traversal's stack holds one entry a level more than that

double half_area(const Box3& box) {
  if (box.isEmpty()) return 0;
  const Vec3 s = box.sizes();
  return s.x() * s.y() + s.y() * s.z() + s.z() * s.x();
}

class Builder {
 public:
  Builder(std::span<const Box3> boxes, BoxTree& tree) : boxes_(boxes), tree_(tree) {}

  void build(Index node, Index begin, Index end, int depth) {
    Box3 box, centers;
    for (Index i = begin; i < end; ++i) {
      box.extend(boxes_[tree_.order[i]]);
      centers.extend(boxes_[tree_.order[i]].center());
    }
    for (int axis = 0; axis < 3; ++axis) {
      tree_.nodes[node].low[axis] = box.min()[axis];
      tree_.nodes[node].high[axis] = box.max()[axis];
    }
    if (end - begin <= leaf_size || depth == max_depth) {
      tree_.nodes[node].first = begin;
      tree_.nodes[node].count = end - begin;
      return;
    }
    const Index middle = split(begin, end, centers);
    const auto left = static_cast<Index>(tree_.nodes.size());
    tree_.nodes[node].first = left;
    tree_.nodes.resize(tree_.nodes.size() + 2);
    build(left, begin, middle, depth + 1);
    build(left + 1, middle, end, depth + 1);
  }

 private:
  /// The best of bins - 1 planes on each axis; the median where no plane separates.
  Index split(Index begin, Index end, const Box3& centers) {
    double best_cost = std::numeric_limits<double>::infinity();
    int best_axis = -1, best_bin = 0;
    for (int axis = 0; axis < 3; ++axis) {
      if (!(centers.sizes()[axis] > 0)) continue;
      std::array<Box3, bins> box;
      std::array<Index, bins> count{};
      for (Index i = begin; i < end; ++i) {
        const int b = bin(tree_.order[i], axis, centers);
        box[b].extend(boxes_[tree_.order[i]]);
        ++count[b];
      }
      std::array<double, bins> right_cost{};
      Box3 right;
      Index n = 0;
      for (int b = bins - 1; b > 0; --b) {
        right.extend(box[b]);
        n += count[b];
        right_cost[b] = n * half_area(right);
      }
      Box3 left;
      n = 0;
      for (int b = 1; b < bins; ++b) {
        left.extend(box[b - 1]);
        n += count[b - 1];
        const double cost = n * half_area(left) + right_cost[b];
        if (n > 0 && n < end - begin && cost < best_cost) {
          best_cost = cost;
          best_axis = axis;
          best_bin = b;
        }
      }
    }
    if (best_axis < 0) return begin + (end - begin) / 2;
    const auto first = tree_.order.begin() + begin, last = tree_.order.begin() + end;
    return static_cast<Index>(
        std::stable_partition(first, last,
                              [&](Index item) { return bin(item, best_axis, centers) < best_bin; }) -
        tree_.order.begin());
  }

  int bin(Index item, int axis, const Box3& centers) const {
    const double fraction = (boxes_[item].center()[axis] - centers.min()[axis]) / centers.sizes()[axis];
    return std::clamp(static_cast<int>(fraction * bins), 0, bins - 1);
  }

  std::span<const Box3> boxes_;
  BoxTree& tree_;
};

}  // namespace

BoxTree build_box_tree(std::span<const Box3> boxes) {
  BoxTree tree;
  if (boxes.empty()) return tree;
  tree.order.resize(boxes.size());
  std::iota(tree.order.begin(), tree.order.end(), 0);
  tree.nodes.resize(1);
  Builder(boxes, tree).build(0, 0, static_cast<Index>(boxes.size()), 0);
  return tree;
}

}  // namespace flowcage
