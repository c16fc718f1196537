#include "core/project/box_tree.hpp"

#include <algorithm>
#include <random>

#include "core/project/trimmed_cells.hpp"
#include "core/target/bspline_patch.hpp"
#include "tests/catch.hpp"

using namespace flowcage;

TEST_CASE("the box tree visits exactly the boxes within reach, for points and for lines") {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<Box3> boxes;
  for (int i = 0; i < 700; ++i) {
    const double x = unit(random), y = unit(random), z = unit(random), s = 0.05 * unit(random);
    boxes.emplace_back(Vec3(x, y, z), Vec3(x + s, y + 2 * s, z));
    if (i % 50 == 0) boxes.insert(boxes.end(), 5, boxes.back());  // equal boxes
  }
  const BoxTree tree = build_box_tree(boxes);
  for (int trial = 0; trial < 50; ++trial) {
    const Vec3 p(unit(random), unit(random), unit(random));
    const Vec3 d =
        Vec3(unit(random) - 0.5, unit(random) - 0.5, trial % 5 == 0 ? 0 : unit(random)).normalized();
    std::vector<Index> near, along, exact_near, exact_along;
    visit_near(
        tree, p, [] { return 0.2; }, [&](Index i) { near.push_back(i); });
    visit_along(
        tree, p, d, [] { return 0.4; }, [&](Index i) { along.push_back(i); });
    for (Index i = 0; i < static_cast<Index>(boxes.size()); ++i) {
      if (boxes[i].exteriorDistance(p) <= 0.2) exact_near.push_back(i);
      BoxTree::Node node;
      for (int axis = 0; axis < 3; ++axis) {
        node.low[axis] = boxes[i].min()[axis];
        node.high[axis] = boxes[i].max()[axis];
      }
      const auto [low, high] = line_interval(node, p, d);
      if (low <= high && low <= 0.4 && high >= -0.4) exact_along.push_back(i);
    }
    std::sort(near.begin(), near.end());
    std::sort(along.begin(), along.end());
    // A leaf is visited as a whole: nothing within reach is missed, little beyond it is seen.
    CHECK(std::includes(near.begin(), near.end(), exact_near.begin(), exact_near.end()));
    CHECK(std::includes(along.begin(), along.end(), exact_along.begin(), exact_along.end()));
    CHECK(near.size() <= 2 * exact_near.size() + 20);
    CHECK(along.size() <= 2 * exact_along.size() + 20);
  }
}

TEST_CASE("cells of a trimmed plane: the area inside, points on both sides, points near the border") {
  auto plane = std::make_shared<BSplineSurface>();
  plane->degree_u = plane->degree_v = 1;
  plane->knots_u = {0, 0, 0.5, 1, 1};
  plane->knots_v = {0, 0, 1, 1};
  for (const double x : {0.0, 1.0, 2.0}) {
    for (const double y : {0.0, 1.0}) plane->poles.emplace_back(x, y, 0);
  }
  const BSplinePatch patch(plane, {Vec2(0, 0), Vec2(1, 1)});
  // A square hole [0.3, 0.6] x [0.2, 0.7] of the unit domain.
  const std::vector<Vec2> hole{{0.3, 0.2}, {0.6, 0.2}, {0.6, 0.7}, {0.3, 0.7}};
  TrimOutline outline;
  for (std::size_t i = 0; i < 4; ++i) outline.segments.push_back({hole[i], hole[(i + 1) % 4]});
  outline.reference = Vec2(0.9, 0.9);
  CellSettings settings;
  settings.max_size = 0.5;
  settings.max_trimmed_size = 0.1;
  TrimmedCells cells;
  append_cells(patch, 0, outline, settings, cells);
  std::mt19937 random(4);
  std::uniform_real_distribution<double> unit(0, 1);
  for (int trial = 0; trial < 2000; ++trial) {
    const Vec2 uv(unit(random), unit(random));
    const bool in_hole = uv.x() > 0.3 && uv.x() < 0.6 && uv.y() > 0.2 && uv.y() < 0.7;
    int held = 0;
    for (const PatchCell& cell : cells.cells) {
      if (!cell.box.contains(uv)) continue;
      ++held;
      CHECK(trim_side(cells, cell, patch.first(uv), uv, 0) ==
            (in_hole ? TrimSide::outside : TrimSide::inside));
    }
    if (!in_hole) CHECK(held == 1);
  }
  for (const PatchCell& cell : cells.cells) {
    const Vec2 uv(0.3, 0.45);
    if (!cell.box.contains(uv)) continue;
    CHECK(trim_side(cells, cell, patch.first(uv), uv, 1e-6) == TrimSide::near_border);
    CHECK(trim_side(cells, cell, patch.first(uv), uv + Vec2(1e-4, 0), 1e-6) == TrimSide::outside);
    CHECK(trim_side(cells, cell, patch.first(uv), uv - Vec2(1e-4, 0), 1e-6) == TrimSide::inside);
  }
}

TEST_CASE("cells follow the parametrisation's speed, not the inverse of its angle") {
  // (u + shear w, w, 0) with w = v + 3 v^2: the speed along v grows to the sevenfold.
  const auto count = [](double shear) {
    auto plane = std::make_shared<BSplineSurface>();
    plane->degree_u = 1;
    plane->degree_v = 2;
    plane->knots_u = {0, 0, 1, 1};
    plane->knots_v = {0, 0, 0, 1, 1, 1};
    for (const double x : {0.0, 4.0}) {
      for (const double w : {0.0, 0.5, 4.0}) plane->poles.emplace_back(x + shear * w, w, 0);
    }
    const BSplinePatch patch(plane, {Vec2(0, 0), Vec2(1, 1)});
    CellSettings settings;
    settings.max_size = settings.max_trimmed_size = 4;
    TrimmedCells cells;
    append_cells(patch, 0, {}, settings, cells);
    return cells.cells.size();
  };
  CHECK(count(0) < 40);
  CHECK(count(2) < 1000);
}
