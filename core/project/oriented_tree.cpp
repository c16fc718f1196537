#include "core/project/oriented_tree.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>

namespace flowcage {
namespace {

struct OrientedBox {
  Eigen::Matrix3d axes;  // rows
  Vec3 low, high;        // along the axes
  double half_area() const {
    const Vec3 s = high - low;
    return s.x() * s.y() + s.y() * s.z() + s.z() * s.x();
  }
};

class Builder {
 public:
  Builder(const BoxTree& tree, std::span<const HullItem> items, OrientedTree& result)
      : tree_(tree), items_(items), result_(result), ranges_(tree.nodes.size()) {
    find_ranges(0);
  }

  /// Some of tree.order, and the binary tree's node of just these.
  struct Part {
    Index begin = 0, end = 0, node = no_index;
    Index count() const { return end - begin; }
  };

  Part root() const { return ranges_[0]; }

  void build(Index number, const Part& whole) {
    std::array<Part, 4> parts{whole};
    int count = 1;
    while (count < 4) {  // halves the part of most items
      const auto largest =
          std::max_element(parts.begin(), parts.begin() + count,
                           [](const Part& a, const Part& b) { return a.count() < b.count(); });
      if (largest->count() < 2) break;
      const auto [left, right] = halves(*largest);
      *largest = left;
      parts[count++] = right;
    }
    for (int k = 0; k < 4; ++k) {
      if (k >= count) {
        result_.nodes[number].child[k] = OrientedTree::no_child;
        continue;
      }
      store_box(number, k, box_of(parts[k]));
      if (parts[k].count() == 1) {
        result_.nodes[number].child[k] = ~tree_.order[parts[k].begin];
        continue;
      }
      const auto child = static_cast<Index>(result_.nodes.size());
      result_.nodes.emplace_back();
      result_.nodes[number].child[k] = child;
      build(child, parts[k]);
    }
  }

 private:
  void find_ranges(Index node) {
    const BoxTree::Node& n = tree_.nodes[node];
    if (n.count > 0) {
      ranges_[node] = {n.first, n.first + n.count, node};
      return;
    }
    find_ranges(n.first);
    find_ranges(n.first + 1);
    ranges_[node] = {ranges_[n.first].begin, ranges_[n.first + 1].end, node};
  }

  std::array<Part, 2> halves(const Part& part) const {
    if (part.node != no_index && tree_.nodes[part.node].count == 0) {
      const Index left = tree_.nodes[part.node].first;
      return {ranges_[left], ranges_[left + 1]};
    }
    const Index middle = part.begin + part.count() / 2;
    return {Part{part.begin, middle, no_index}, Part{middle, part.end, no_index}};
  }

  OrientedBox box_along(const Eigen::Matrix3d& axes, const Part& part) const {
    OrientedBox box{axes, Vec3::Constant(1e300), Vec3::Constant(-1e300)};
    for (Index i = part.begin; i < part.end; ++i) {
      const HullItem& item = items_[tree_.order[i]];
      const Vec3 slack = Vec3::Constant(item.slack);
      for (const Vec3& p : item.points) {
        const Vec3 along = axes * (p - result_.origin);
        box.low = box.low.cwiseMin(along - slack);
        box.high = box.high.cwiseMax(along + slack);
      }
    }
    return box;
  }

  /// Along the principal axes of the points, or the coordinates' where that is smaller.
  OrientedBox box_of(const Part& part) const {
    Vec3 mean = Vec3::Zero();
    for (Index i = part.begin; i < part.end; ++i) {
      for (const Vec3& p : items_[tree_.order[i]].points) mean += p - result_.origin;
    }
    mean /= 4.0 * part.count();
    Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
    for (Index i = part.begin; i < part.end; ++i) {
      for (const Vec3& p : items_[tree_.order[i]].points) {
        const Vec3 d = p - result_.origin - mean;
        spread += d * d.transpose();
      }
    }
    OrientedBox best = box_along(Eigen::Matrix3d::Identity(), part);
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> principal(spread);
    if (principal.info() == Eigen::Success) {
      const OrientedBox turned = box_along(principal.eigenvectors().transpose(), part);
      if (turned.half_area() < best.half_area()) best = turned;
    }
    return best;
  }

  void store_box(Index number, int k, const OrientedBox& box) {
    OrientedTree::Node& node = result_.nodes[number];
    const Vec3 middle = 0.5 * (box.low + box.high), center = box.axes.transpose() * middle;
    for (int a = 0; a < 3; ++a) {
      node.center[a][k] = static_cast<float>(center[a]);
      for (int b = 0; b < 3; ++b) node.axis[3 * a + b][k] = static_cast<float>(box.axes(a, b));
      node.half[a][k] = static_cast<float>(0.5 * (box.high[a] - box.low[a]));
    }
  }

  const BoxTree& tree_;
  std::span<const HullItem> items_;
  OrientedTree& result_;
  std::vector<Part> ranges_;
};

}  // namespace

OrientedTree build_oriented_tree(const BoxTree& tree, std::span<const HullItem> items) {
  OrientedTree result;
  if (items.empty()) return result;
  Box3 box;
  for (const HullItem& item : items) {
    const Vec3 slack = Vec3::Constant(item.slack);
    for (const Vec3& p : item.points) box.extend(p - slack).extend(p + slack);
  }
  result.origin = box.center();
  result.size = 0.5 * box.diagonal().norm();
  result.nodes.emplace_back();
  Builder builder(tree, items, result);
  builder.build(0, builder.root());
  return result;
}

}  // namespace flowcage
