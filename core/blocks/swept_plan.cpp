#include "core/blocks/swept_plan.hpp"

#include <algorithm>

namespace flowcage {
namespace {

std::vector<std::vector<Index>> plug_polygons(const SweptPlan& plan) {
  const Index front = plan.front;
  const Index rear = plan.rear;
  std::vector<std::vector<Index>> plug{
      {1, 2, front, rear}, {rear, front, 4, 5}, {2, 3, front}, {front, 3, 4}};
  switch (plan.trailing) {
    case TrailingEdge::sharp:
      plug.push_back({0, 1, rear, 5});
      break;
    case TrailingEdge::round:
      plug.push_back({0, 1, rear});
      plug.push_back({0, rear, 5});
      break;
    case TrailingEdge::blunt:
      plug.push_back({0, 1, rear, 7});
      plug.push_back({7, rear, 5, 6});
      break;
  }
  return plug;
}

}  // namespace

SweptPlan make_swept_plan(TrailingEdge trailing) {
  SweptPlan plan;
  plan.trailing = trailing;
  const bool blunt = trailing == TrailingEdge::blunt;
  plan.ring = blunt ? 8 : 6;
  plan.front = plan.ring;
  plan.rear = plan.ring + 1;
  plan.coarse = plan.count = plan.ring + 2;
  plan.plug = plug_polygons(plan);
  for (const auto& polygon : plan.plug) {
    for (std::size_t n = 0; n < polygon.size(); ++n) {
      const Index a = polygon[n];
      const Index b = polygon[(n + 1) % polygon.size()];
      if (plan.middle.try_emplace({std::min(a, b), std::max(a, b)}, plan.count).second) ++plan.count;
    }
  }
  for (const auto& polygon : plan.plug) {
    plan.centre.push_back(plan.count++);
    const std::size_t n = polygon.size();
    for (std::size_t i = 0; i < n; ++i) {
      plan.fine_plug.push_back({polygon[i], plan.middle_of(polygon[i], polygon[(i + 1) % n]),
                                plan.centre.back(), plan.middle_of(polygon[(i + n - 1) % n], polygon[i])});
    }
  }
  // The ring with its middles; the last entry is the lower trailing edge.
  std::vector<Index> ring;
  for (Index i = 0; i < 6; ++i) {
    const Index next = blunt ? i + 1 : (i + 1) % 6;
    ring.push_back(i);
    ring.push_back(plan.middle_of(i, next));
  }
  ring.push_back(blunt ? 6 : 0);
  for (std::size_t n = 0; n < ring.size(); ++n) plan.side.push_back(plan.count++);
  plan.back_upper = plan.count++;
  std::vector<Index> base{0};
  if (blunt) base = {0, plan.middle_of(0, 7), 7, plan.middle_of(6, 7), 6};
  for (std::size_t n = 0; n < base.size(); ++n) plan.wake.push_back(plan.count++);
  plan.back_lower = plan.count++;

  for (std::size_t n = 0; n + 1 < ring.size(); ++n) {
    plan.wall.push_back({ring[n], ring[n + 1]});
    plan.outer.push_back({plan.side[n], plan.side[n + 1]});
    plan.outside.push_back({ring[n + 1], ring[n], plan.side[n], plan.side[n + 1]});
  }
  plan.outside.push_back({0, plan.wake.front(), plan.back_upper, plan.side.front()});
  plan.outside.push_back({ring.back(), plan.side.back(), plan.back_lower, plan.wake.back()});
  plan.outer.push_back({plan.side.front(), plan.back_upper});
  plan.outer.push_back({plan.back_upper, plan.wake.front()});
  plan.outer.push_back({plan.wake.back(), plan.back_lower});
  plan.outer.push_back({plan.back_lower, plan.side.back()});
  for (std::size_t n = 0; n + 1 < base.size(); ++n) {
    plan.wall.push_back({base[n], base[n + 1]});
    plan.outer.push_back({plan.wake[n], plan.wake[n + 1]});
    plan.outside.push_back({base[n], base[n + 1], plan.wake[n + 1], plan.wake[n]});
  }
  return plan;
}

}  // namespace flowcage
