#include "core/project/oriented_tree.hpp"

#include <algorithm>
#include <cmath>
#include <random>

#include "tests/catch.hpp"

using namespace flowcage;

TEST_CASE("the oriented tree visits every item within reach, and few others") {
  // Small squares on a sphere far from the origin.
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(-1, 1);
  const Vec3 center(300, -200, 100);
  std::vector<HullItem> items;
  std::vector<Box3> boxes;
  while (items.size() < 2000) {
    const Vec3 n = Vec3(unit(random), unit(random), unit(random)).normalized();
    const Vec3 a = n.unitOrthogonal() * 0.02, b = n.cross(a);
    HullItem item{{center + n - a, center + n + a, center + n - b, center + n + b}, 1e-4};
    if (items.size() % 100 == 0) items.push_back(item);  // equal items
    items.push_back(item);
  }
  for (const HullItem& item : items) {
    Box3 box;
    for (const Vec3& p : item.points) box.extend(p);
    boxes.emplace_back(box.min() - Vec3::Constant(item.slack), box.max() + Vec3::Constant(item.slack));
  }
  const OrientedTree tree = build_oriented_tree(build_box_tree(boxes), items);
  std::size_t visited = 0, needed = 0;
  for (int trial = 0; trial < 60; ++trial) {
    const Vec3 p = center + std::pow(10.0, trial % 3) * Vec3(unit(random), unit(random), unit(random));
    const double reach = std::abs((p - center).norm() - 1) + 0.002;
    std::vector<Index> seen;
    visit_nearest(
        tree, p, [&] { return reach; }, [&](Index i) { seen.push_back(i); });
    std::sort(seen.begin(), seen.end());
    CHECK(std::adjacent_find(seen.begin(), seen.end()) == seen.end());
    visited += seen.size();
    for (Index i = 0; i < static_cast<Index>(items.size()); ++i) {
      double nearest = 1e300;
      for (const Vec3& q : items[i].points) nearest = std::min(nearest, (p - q).norm() - items[i].slack);
      if (nearest > reach) continue;
      ++needed;
      CHECK(std::binary_search(seen.begin(), seen.end(), i));
    }
  }
  CHECK(needed > 200);
  CHECK(visited < 4 * needed);
}

TEST_CASE("nothing is missed from very far away; no items, no visits") {
  std::vector<HullItem> items;
  std::vector<Box3> boxes;
  for (int i = 0; i < 50; ++i) {
    const Vec3 p(0.02 * i, 0, 0);
    items.push_back({{p, p + Vec3(0.01, 0, 0), p, p + Vec3(0, 0.01, 0)}, 0});
    boxes.emplace_back(p, p + Vec3(0.01, 0.01, 0));
  }
  const OrientedTree tree = build_oriented_tree(build_box_tree(boxes), items);
  for (const double far : {1e4, 1e10, 1e30}) {
    bool last = false;
    const double reach = far - 0.99 + 1e-15 * far;
    visit_nearest(
        tree, Vec3(far, 0, 0), [&] { return reach; }, [&](Index i) { last = last || i == 49; });
    CHECK(last);
  }
  int visits = 0;
  visit_nearest(
      OrientedTree{}, Vec3(0, 0, 0), [] { return 1.0; }, [&](Index) { ++visits; });
  CHECK(visits == 0);
}
