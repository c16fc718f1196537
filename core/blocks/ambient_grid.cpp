#include "core/blocks/ambient_grid.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "core/base/error.hpp"
#include "core/blocks/ambient_body.hpp"
#include "core/blocks/ambient_frame.hpp"
#include "core/blocks/ambient_map.hpp"
#include "core/blocks/cage_of_blocks.hpp"
#include "core/blocks/chart_borders.hpp"
#include "core/blocks/grid_lines.hpp"
#include "core/blocks/pillow.hpp"
#include "core/blocks/region_labels.hpp"
#include "core/blocks/surface_charts.hpp"
#include "core/blocks/voxel_grid.hpp"
#include "core/blocks/wall_features.hpp"
#include "core/project/find_creases.hpp"

namespace flowcage {
namespace {

/// Body cells: those that lie in the body by half. What no fluid from outside reaches counts as body.
void fill_body(VoxelGrid& grid, const std::vector<double>& fraction, const AmbientSettings& settings,
               AmbientReport& report) {
  grid.body.assign(fraction.size(), 0);
  for (std::size_t c = 0; c < fraction.size(); ++c) grid.body[c] = fraction[c] >= 0.5 ? 1 : 0;
  report.turned_voxels = repair_manifold(grid, fraction);
  for (const Index n : non_manifold_nodes(grid)) {
    const Vec3 p = grid.point(
        {n % grid.nodes(0), n / grid.nodes(0) % grid.nodes(1), n / (grid.nodes(0) * grid.nodes(1))});
    report.findings.push_back(
        {"manifold",
         fmt::format("parts of the body's voxels touch only along an edge or at a point at {}", place(p)),
         p});
  }
  if (settings.internal) return;
  const VoxelParts fluid = voxel_parts(grid, 0);
  for (std::size_t c = 0; c < fraction.size(); ++c) {
    if (fluid.part[c] > 0) grid.body[c] = 1;  // part 0 holds the first cell, in a corner of the box
  }
  if (fluid.count > 1) {
    report.findings.push_back(
        {"cavity", fmt::format("{} closed cavities of the body are filled", fluid.count - 1), {}});
  }
}

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

std::array<std::vector<LineAnchor>, 3> line_anchors(const SurfaceCharts& charts, const AmbientMap& map,
                                                    const std::vector<KnifeLine>& knives) {
  std::array<std::vector<LineAnchor>, 3> anchors;
  for (std::size_t c = 0; c < charts.charts.size(); ++c) {
    const SurfaceCharts::Chart& chart = charts.charts[c];
    anchors[chart.axis].push_back({map.chart_value[c], chart.area, chart.sign});
  }
  for (std::size_t l = 0; l < knives.size(); ++l) {
    for (int axis = 0; axis < 3; ++axis) {
      // Not across the knife: the two sides have lines there.
      if ((knives[l].axes >> axis & 1) != 0 && axis != knives[l].across) {
        anchors[axis].push_back({map.line_value[l][axis], knives[l].length * knives[l].length, 0});
      }
    }
  }
  return anchors;
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

std::array<Index, 4> sorted(std::array<Index, 4> q) {
  std::sort(q.begin(), q.end());
  return q;
}

/// Numbers the finished draft, with the cage's patches and creases on its wall.
void assemble(BlockDraft draft, const AmbientFrame& frame, AmbientBlocks& result, const WallCage& wall) {
  std::vector<HexComplex::Patch> patches;
  for (const std::string& name : result.cage.patch_names) {
    patches.push_back({name.empty() ? "wall" : name, PatchType::wall});
  }
  std::array<Index, 3> outer{no_index, no_index, no_index};
  std::vector<Index> patch(draft.boundary.size(), no_index);
  for (std::size_t f = 0; f < wall.face_boundary.size(); ++f) {
    patch[wall.face_boundary[f]] = result.cage.face_patch[f];
  }
  for (std::size_t b = 0; b < draft.boundary.size(); ++b) {
    if (patch[b] != no_index) continue;
    const PatchType type = frame.sides[draft.boundary[b].patch - 1].type;
    Index& number = outer[type == PatchType::symmetry ? 1 : 0];
    if (number == no_index) {
      number = static_cast<Index>(patches.size());
      patches.push_back({type == PatchType::symmetry ? "symmetry" : "farfield", type});
    }
    patch[b] = number;
  }
  // The box's edges are sharp although both sides are one patch.
  std::map<std::array<Index, 2>, Index> side;
  std::vector<SharpEdge> sharp;
  for (std::size_t b = 0; b < draft.boundary.size(); ++b) {
    for (int n = 0; n < 4; ++n) {
      const Index p = draft.boundary[b].corners[n], q = draft.boundary[b].corners[(n + 1) % 4];
      const auto [it, fresh] =
          side.try_emplace(std::array{std::min(p, q), std::max(p, q)}, draft.boundary[b].patch);
      if (!fresh && it->second != draft.boundary[b].patch) sharp.push_back({p, q});
    }
    draft.boundary[b].patch = patch[b];
  }
  for (const Cage::Crease& c : result.cage.creases) {
    sharp.push_back({wall.vertex_corner[c.a], wall.vertex_corner[c.b], c.sharpness});
  }
  result.complex = build_hex_complex(std::move(draft.points), std::move(draft.hexes), std::move(patches),
                                     draft.boundary, sharp);
  HexComplex& complex = result.complex;
  for (const Cage::Corner& c : result.cage.corners) {
    complex.corner_sharpness[wall.vertex_corner[c.vertex]] = c.sharpness;
  }
  std::map<std::array<Index, 4>, Index> quad;
  for (Index q = 0; q < static_cast<Index>(complex.quads.size()); ++q) {
    if (complex.quad_patch[q] != no_index) quad.emplace(sorted(complex.quads[q]), q);
  }
  result.vertex_corner = wall.vertex_corner;
  for (const Index b : wall.face_boundary)
    result.face_quad.push_back(quad.at(sorted(draft.boundary[b].corners)));
}

}  // namespace

AmbientBlocks make_ambient_blocks(const TargetSurface& target, const AmbientSettings& settings,
                                  Progress& progress) {
  AmbientBlocks result;
  AmbientReport& report = result.report;
  progress.step("blocks", 0);
  const AmbientFrame frame = ambient_frame(target, settings);
  const MapSettings map_settings;
  const AmbientBody body = ambient_body(target, map_spacing(frame, map_settings));
  report.size = frame.size;
  const double least = 0.1 * std::min({frame.size[0], frame.size[1], frame.size[2]});
  const SurfaceCharts charts = surface_charts(target, least * least);
  const std::vector<KnifeLine> knives = knife_lines(target, charts);
  const AmbientMap map = settings.map ? solve_ambient_map(body, charts, frame, knives, map_settings, progress)
                                      : identity_map(charts, knives);
  report.charts = static_cast<Index>(charts.charts.size());

  for (std::size_t c = 0; c < charts.charts.size(); ++c) { const auto& h = charts.charts[c]; if (h.area > 1e-2) fmt::print(stderr, "XDBG chart {} {}{} area {:.4g} diam {:.3g} group {} place {} value {:.4g}\n", c, h.sign>0?'+':'-', "xyz"[h.axis], h.area, h.diameter, h.group, place(h.place), map.chart_value[c]); }
  for (std::size_t c = 0; c < knives.size(); ++c) fmt::print(stderr, "DBG knife {} axes {} values {:.4g} {:.4g} {:.4g}\n", c, knives[c].axes, map.line_value[c][0], map.line_value[c][1], map.line_value[c][2]);
  { std::vector<double> w(charts.charts.size(),0), e(w),mx(w); for (Index t=0;t<(Index)body.triangles.size();++t){ const auto& v=body.triangles[t]; if (body.parent[t]<0) continue; const Index c=charts.chart[body.parent[t]]; const double ar=(body.points[v[1]]-body.points[v[0]]).cross(body.points[v[2]]-body.points[v[0]]).norm(); const double d=map((body.points[v[0]]+body.points[v[1]]+body.points[v[2]])/3)[charts.charts[c].axis]-map.chart_value[c]; w[c]+=ar; e[c]+=ar*d*d; mx[c]=std::max(mx[c],std::abs(d));} for (std::size_t c=0;c<w.size();++c) if (charts.charts[c].area>1e-2) fmt::print(stderr,"DBG flat {} rms {:.3f} max {:.3f}\n", c, std::sqrt(e[c]/w[c])/frame.size[charts.charts[c].axis],mx[c]/frame.size[charts.charts[c].axis]); }
  VoxelGrid grid;
  grid.lines = grid_lines(frame, line_anchors(charts, map, knives), settings.growth);
  report.lines = grid.lines;
  progress.step("blocks: voxels", 0.3);
  std::vector<Vec3> mapped;
  for (const Vec3& p : body.points) mapped.push_back(map(p));
  const std::array<std::vector<double>, 3> seen = body_fractions(grid, mapped, body.triangles);
  std::vector<double> fraction(seen[0].size());
  for (std::size_t c = 0; c < fraction.size(); ++c) fraction[c] = std::max({seen[0][c], seen[1][c], seen[2][c]});
  fill_body(grid, fraction, settings, report);
  std::vector<Index> node;
  BlockDraft draft = draft_of_voxels(grid, settings.internal ? 1 : 0, node);
  if (draft.hexes.empty()) {
    throw Error(ErrorKind::gate, "automatic blocks: no cell of the grid lies in the fluid",
                "give a smaller --cage-size");
  }
  // The wall of the bare draft, in the mapped box: what labels are made from. Pillows keep it.
  std::vector<char> is_wall;
  for (const BoundaryQuad& q : draft.boundary) is_wall.push_back(q.patch == 0 ? 1 : 0);
  WallCage wall = cage_of_blocks(draft, is_wall, !settings.internal);
  progress.step("blocks: labels", 0.5);
  result.cage = std::move(wall.cage);
  if (settings.labels) {
    std::vector<Index> triangle_chart;
    for (const Index t : body.parent) triangle_chart.push_back(t == no_index ? no_index : charts.chart[t]);
    const double size = std::max({frame.size[0], frame.size[1], frame.size[2]});
    const ChartBorders borders = chart_borders(target.tessellation(), charts, 0.02 * size, map);
    LabelSettings labelling;
    labelling.size = size;
    const std::vector<Index> label = label_quads(result.cage, 1, mapped, body.triangles, triangle_chart, charts,
                                                 borders, labelling);
    WallFeatures features = wall_features({result.cage, label, body, mapped, triangle_chart}, target, charts, borders);
    report.chains = features.chains;
    report.chains_matched = features.chains_followed;
    report.findings.insert(report.findings.end(), features.findings.begin(), features.findings.end());
    result.cage.creases = std::move(features.creases);
    result.cage.corners = std::move(features.corners);
    result.cage.points = std::move(features.places);
    result.face_chart = label;
  }
  for (Vec3& p : draft.points) p = map.inverse(p, p);
  if (!settings.labels) {
    for (std::size_t v = 0; v < wall.vertex_corner.size(); ++v) result.cage.points[v] = draft.points[wall.vertex_corner[v]];
    FoundCreases found = find_creases(result.cage, target);
    report.chains = found.sharp_chains;
    report.chains_matched = found.followed;
    result.cage = std::move(found.cage);
  }
  if (settings.wall_layer) {
    draft = pillow(draft, std::vector<char>(draft.hexes.size(), 1),
                   [](const BoundaryQuad& q) { return q.patch == 0; })
                .draft;
  }
  assemble(std::move(draft), frame, result, wall);
  return result;
}

}  // namespace flowcage
