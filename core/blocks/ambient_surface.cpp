#include "core/blocks/ambient_surface.hpp"

#include <algorithm>

namespace flowcage {
namespace {

/// Knife edges: sharp chains whose two sides face opposite ways along one axis.
std::vector<KnifeLine> knife_lines(const TargetSurface& target, const SurfaceCharts& charts) {
  const std::vector<FeatureChain>& chains = target.features().chains;
  std::vector<std::array<double, 3>> opposite(chains.size(), {0, 0, 0});
  const Tessellation& cad = target.tessellation();
  for (std::size_t t = 0; t < cad.triangles.size(); ++t) {
    for (int i = 0; i < 3; ++i) {
      const Index c = charts.chain[t][i], n = charts.across[t][i];
      if (c == no_index || n == no_index) continue;
      const SurfaceCharts::Chart& a = charts.charts[charts.chart[t]];
      const SurfaceCharts::Chart& b = charts.charts[charts.chart[n]];
      if (a.axis != b.axis || a.sign == b.sign) continue;
      opposite[c][a.axis] +=
          (cad.points[cad.triangles[t][(i + 1) % 3]] - cad.points[cad.triangles[t][i]]).norm() / 2;
    }
  }
  std::vector<KnifeLine> knives;
  for (Index c = 0; c < static_cast<Index>(chains.size()); ++c) {
    const int across =
        static_cast<int>(std::max_element(opposite[c].begin(), opposite[c].end()) - opposite[c].begin());
    if (opposite[c][across] < 0.5 * chains[c].length || chains[c].start == chains[c].end) continue;
    int along = 0;
    Vec3 chord = (chains[c].polyline.back() - chains[c].polyline.front()).cwiseAbs();
    chord[across] = -1;
    chord.maxCoeff(&along);
    KnifeLine knife;
    constexpr int samples = 64;
    for (int n = 0; n < samples; ++n) {
      knife.points.push_back(target.chain_point(c, chains[c].length * (n + 0.5) / samples).position);
    }
    knife.length = chains[c].length;
    knife.axes = 7 & ~(1 << along);
    knife.across = across;
    knives.push_back(std::move(knife));
  }
  return knives;
}

AmbientMap identity_map(const SurfaceCharts& charts, const std::vector<KnifeLine>& knives) {
  AmbientMap map;
  for (const SurfaceCharts::Chart& chart : charts.charts) map.chart_value.push_back(chart.place[chart.axis]);
  for (const KnifeLine& knife : knives) {
    Vec3 mean = Vec3::Zero();
    for (const Vec3& p : knife.points) mean += p / static_cast<double>(knife.points.size());
    map.line_value.push_back({mean[0], mean[1], mean[2]});
  }
  return map;
}

/// Volume that closed triangles enclose (divergence theorem).
double enclosed_volume(const AmbientBody& body) {
  double volume = 0;
  for (const auto& t : body.triangles) {
    volume += body.points[t[0]].dot(body.points[t[1]].cross(body.points[t[2]])) / 6;
  }
  return volume;
}

}  // namespace

AmbientSurface ambient_surface(const TargetSurface& target, const AmbientSettings& settings,
                               Progress& progress) {
  AmbientSurface surface;
  surface.frame = ambient_frame(target, settings);
  const MapSettings map_settings;
  surface.body = ambient_body(target, map_spacing(surface.frame, map_settings));
  surface.volume = enclosed_volume(surface.body);
  const auto [least_size, size] =
      std::minmax({surface.frame.size[0], surface.frame.size[1], surface.frame.size[2]});
  constexpr double crumb = 0.1;  // sizes: charts smaller than its square join their neighbours
  surface.charts = surface_charts(target, crumb * crumb * least_size * least_size);
  surface.knives = knife_lines(target, surface.charts);
  surface.map = settings.map ? solve_ambient_map(surface.body, surface.charts, surface.frame, surface.knives,
                                                 map_settings, progress)
                             : identity_map(surface.charts, surface.knives);
  constexpr double border_spacing = 0.02;  // sizes
  surface.borders = chart_borders(target.tessellation(), surface.charts, border_spacing * size, surface.map);
  for (const Vec3& p : surface.body.points) surface.mapped.push_back(surface.map(p));
  for (const Index t : surface.body.parent) {
    surface.triangle_chart.push_back(t == no_index ? no_index : surface.charts.chart[t]);
  }
  return surface;
}

}  // namespace flowcage
