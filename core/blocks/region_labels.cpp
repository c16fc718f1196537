#include "core/blocks/region_labels.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "core/blocks/closest_triangle.hpp"
#include "core/blocks/label_expansion.hpp"
#include "core/project/box_tree.hpp"

namespace flowcage {
namespace {

constexpr double reach = 2;  // sizes: charts farther away than that are no choice

}  // namespace

std::vector<Index> label_quads(const Cage& wall, double sign, std::span<const Vec3> points,
                               std::span<const std::array<Index, 3>> triangles,
                               std::span<const Index> triangle_chart, const SurfaceCharts& charts,
                               const ChartBorders& borders, const LabelSettings& settings) {
  std::vector<Box3> boxes;
  for (const auto& t : triangles) {
    Box3 box(points[t[0]]);
    box.extend(points[t[1]]);
    box.extend(points[t[2]]);
    boxes.push_back(box);
  }
  const BoxTree tree = build_box_tree(boxes);
  LabelProblem problem;
  problem.label_count = static_cast<Index>(charts.charts.size());
  std::vector<Index> start;
  for (Index f = 0; f < wall.faces.size(); ++f) {
    std::array<Vec3, 4> c;
    for (int n = 0; n < 4; ++n) c[n] = wall.points[wall.faces[f][n]];
    const Vec3 centre = (c[0] + c[1] + c[2] + c[3]) / 4;
    const Vec3 normal = sign * (c[2] - c[0]).cross(c[3] - c[1]).normalized();
    std::map<Index, double> cost;
    for (int n = 0; n < 4; ++n) {
      const Vec3 p = (c[n] + centre) / 2;
      std::map<Index, double> nearest;
      visit_near(
          tree, p, [&] { return reach * settings.size; },
          [&](Index t) {
            if (triangle_chart[t] == no_index) return;
            const auto& v = triangles[t];
            const double d = (closest_on_triangle(p, points[v[0]], points[v[1]], points[v[2]]) - p).norm();
            const auto [it, fresh] = nearest.try_emplace(triangle_chart[t], d);
            if (!fresh) it->second = std::min(it->second, d);
          });
      for (const auto& [chart, d] : nearest) {
        const auto [it, fresh] = cost.try_emplace(chart, reach);
        it->second += (std::min(d / settings.size, reach) - reach) / 4;
      }
    }
    std::vector<LabelProblem::Choice> row;
    for (const auto& [chart, distance] : cost) {
      const SurfaceCharts::Chart& k = charts.charts[chart];
      row.push_back({chart, distance + settings.normal * (1 - k.sign * normal[k.axis])});
    }
    const auto best = std::min_element(row.begin(), row.end(),
                                       [](const auto& a, const auto& b) { return a.cost < b.cost; });
    start.push_back(best == row.end() ? 0 : best->label);
    problem.choices.push_row(row);
  }

  std::map<std::array<Index, 2>, Index> open;
  std::vector<Vec3> middle;
  for (Index f = 0; f < wall.faces.size(); ++f) {
    for (int n = 0; n < 4; ++n) {
      const Index a = wall.faces[f][n], b = wall.faces[f][(n + 1) % 4];
      const auto [it, fresh] = open.try_emplace({std::min(a, b), std::max(a, b)}, f);
      if (fresh) continue;
      problem.neighbours.push_back({it->second, f});
      middle.push_back((wall.points[a] + wall.points[b]) / 2);
    }
  }
  std::map<std::array<Index, 3>, double> known;  // pair of quads, two charts
  problem.pair_cost = [&](Index pair, Index a, Index b) {
    const std::array<Index, 2> key{std::min(a, b), std::max(a, b)};
    const auto found = borders.between.find(key);
    if (found == borders.between.end()) return settings.strange;
    const auto [it, fresh] = known.try_emplace({pair, key[0], key[1]}, 0.0);
    if (fresh) {
      double squared = 1e300;
      for (const BorderPoint& p : found->second) {
        squared = std::min(squared, (p.mapped - middle[pair]).squaredNorm());
      }
      it->second = settings.border + settings.off_border * std::min(std::sqrt(squared) / settings.size, 2.0);
    }
    return it->second;
  };
  return expand_labels(problem, std::move(start));
}

}  // namespace flowcage
