#include "core/blocks/chart_borders.hpp"

#include <algorithm>
#include <cmath>

namespace flowcage {

ChartBorders chart_borders(const Tessellation& cad, const SurfaceCharts& charts, double spacing,
                           const std::function<Vec3(const Vec3&)>& map) {
  ChartBorders result;
  std::vector<std::vector<Index>> at(cad.points.size());
  for (Index t = 0; t < static_cast<Index>(cad.triangles.size()); ++t) {
    for (const Index v : cad.triangles[t]) at[v].push_back(charts.chart[t]);
    for (int i = 0; i < 3; ++i) {
      const Index n = charts.across[t][i];
      if (n < t || charts.chart[n] == charts.chart[t]) continue;  // no_index is less, too
      const Vec3 &a = cad.points[cad.triangles[t][i]], &b = cad.points[cad.triangles[t][(i + 1) % 3]];
      const int parts = std::max(1, static_cast<int>(std::ceil((b - a).norm() / spacing)));
      const auto [low, high] = std::minmax(charts.chart[t], charts.chart[n]);
      std::vector<BorderPoint>& points = result.between[{low, high}];
      for (int p = 0; p < parts; ++p) {
        const Vec3 x = a + (b - a) * (p + 0.5) / parts;
        points.push_back({x, map(x), charts.chain[t][i]});
      }
    }
  }
  for (std::size_t v = 0; v < at.size(); ++v) {
    std::sort(at[v].begin(), at[v].end());
    at[v].erase(std::unique(at[v].begin(), at[v].end()), at[v].end());
    if (at[v].size() > 2) result.corners.push_back({at[v], cad.points[v], map(cad.points[v])});
  }
  return result;
}

}  // namespace flowcage
