#include "core/project/tip_vertices.hpp"

#include <algorithm>
#include <tuple>

namespace flowcage {

std::vector<Index> tip_vertices(const SurfaceLevel& level, std::span<const Vec3> points,
                                std::span<const Vec3> tips) {
  constexpr double reach = 0.5;
  struct Pair {
    double distance;  // in mean edge lengths
    Index tip, vertex;
  };
  std::vector<Pair> pairs;
  for (Index v = 0; v < level.vertex_count() && !tips.empty(); ++v) {
    double mean = 0;
    for (const Index e : level.vertex_edges[v]) {
      const auto& [a, b] = level.edge_vertices[e];
      mean += (points[a] - points[b]).norm() / static_cast<double>(level.vertex_edges[v].size());
    }
    for (Index t = 0; t < static_cast<Index>(tips.size()); ++t) {
      const double distance = (points[v] - tips[t]).norm();
      if (distance < reach * mean) pairs.push_back({distance / mean, t, v});
    }
  }
  std::sort(pairs.begin(), pairs.end(), [](const Pair& a, const Pair& b) {
    return std::tie(a.distance, a.tip, a.vertex) < std::tie(b.distance, b.tip, b.vertex);
  });
  std::vector<Index> found(tips.size(), no_index);
  for (const Pair& pair : pairs) {
    const bool taken = std::find(found.begin(), found.end(), pair.vertex) != found.end();
    if (found[pair.tip] == no_index && !taken) found[pair.tip] = pair.vertex;
  }
  return found;
}

}  // namespace flowcage
