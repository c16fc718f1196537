#include "core/blocks/ambient_grid.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

#include "core/base/error.hpp"
#include "core/blocks/ambient_surface.hpp"
#include "core/blocks/assemble_blocks.hpp"
#include "core/blocks/grid_lines.hpp"
#include "core/blocks/pillow.hpp"
#include "core/blocks/region_labels.hpp"
#include "core/blocks/wall_features.hpp"
#include "core/mesh/surface_level.hpp"

namespace flowcage {
namespace {

using Anchors = std::array<std::vector<LineAnchor>, 3>;

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

Anchors line_anchors(const AmbientSurface& s) {
  Anchors anchors;
  for (std::size_t c = 0; c < s.charts.charts.size(); ++c) {
    const SurfaceCharts::Chart& chart = s.charts.charts[c];
    anchors[chart.axis].push_back({s.map.chart_value[c], chart.area, chart.sign});
  }
  for (std::size_t l = 0; l < s.knives.size(); ++l) {
    for (int axis = 0; axis < 3; ++axis) {
      // Not across the knife: the two sides have lines there.
      if ((s.knives[l].axes >> axis & 1) != 0 && axis != s.knives[l].across) {
        anchors[axis].push_back({s.map.line_value[l][axis], s.knives[l].length * s.knives[l].length, 0});
      }
    }
  }
  Box3 box;
  for (const Vec3& p : s.mapped) box.extend(p);
  for (int axis = 0; axis < 3; ++axis) {  // nothing faces along it
    if (!anchors[axis].empty()) continue;
    anchors[axis] = {{box.min()[axis], 1, -1}, {box.max()[axis], 1, 1}};
  }
  return anchors;
}

/// Lines at the ends of what was lost, where it is not too thin for a line on either side.
void add_anchors(const AmbientSurface& s, const std::vector<Index>& lost_groups, Anchors& anchors) {
  constexpr double thinnest = 0.02;  // sizes
  for (const Index g : lost_groups) {
    Box3 box;
    for (std::size_t t = 0; t < s.triangle_chart.size(); ++t) {
      if (s.triangle_chart[t] == no_index || s.charts.charts[s.triangle_chart[t]].group != g) continue;
      for (const Index v : s.body.triangles[t]) box.extend(s.mapped[v]);
    }
    for (int axis = 0; axis < 3; ++axis) {
      const double low = box.min()[axis], high = box.max()[axis];
      if (high - low < thinnest * s.frame.size[axis]) continue;
      const double weight = 1e-6;  // gives way to charts nearby
      anchors[axis].push_back({low, weight, -1});
      anchors[axis].push_back({high, weight, 1});
    }
  }
}

/// Patches of the cage by the CAD's names, in the order of their first face.
void name_patches(const TargetSurface& target, std::span<const Index> face_region, Cage& cage) {
  cage.patch_names.clear();
  cage.face_patch.clear();
  for (const Index face : face_region) {
    const std::string name = target.face_name(face);
    const auto found = std::find(cage.patch_names.begin(), cage.patch_names.end(), name);
    cage.face_patch.push_back(static_cast<Index>(found - cage.patch_names.begin()));
    if (found == cage.patch_names.end()) cage.patch_names.push_back(name);
  }
}

/// Connected parts and Euler characteristic of closed triangles; nothing where an edge has not two of them.
std::optional<std::array<Index, 2>> topology_of_triangles(const Tessellation& cad) {
  std::vector<std::array<Index, 2>> edges;
  std::vector<Index> root(cad.points.size());
  for (std::size_t v = 0; v < root.size(); ++v) root[v] = static_cast<Index>(v);
  const auto find = [&](Index v) {
    while (root[v] != v) v = root[v] = root[root[v]];
    return v;
  };
  std::set<Index> used;
  for (const auto& t : cad.triangles) {
    for (int i = 0; i < 3; ++i) {
      const Index a = t[i], b = t[(i + 1) % 3];
      edges.push_back({std::min(a, b), std::max(a, b)});
      root[find(a)] = find(b);
      used.insert(a);
    }
  }
  std::sort(edges.begin(), edges.end());
  for (std::size_t n = 0; n < edges.size(); n += 2) {
    const bool two = n + 1 < edges.size() && edges[n] == edges[n + 1] &&
                     (n + 2 >= edges.size() || edges[n + 2] != edges[n]);
    if (!two) return std::nullopt;
  }
  Index parts = 0;
  for (const Index v : used) parts += find(v) == v ? 1 : 0;
  const auto euler = static_cast<Index>(used.size()) - static_cast<Index>(edges.size() / 2) +
                     static_cast<Index>(cad.triangles.size());
  return std::array<Index, 2>{parts, euler};
}

void check_topology(const TargetSurface& target, const Cage& cage, AmbientReport& report) {
  const Topology made = topology_of(build_surface_level(cage));
  const std::optional<std::array<Index, 2>> cad = topology_of_triangles(target.tessellation());
  report.genus = made.genus;
  report.topology_checked = cad.has_value();
  if (!cad) return;
  const Vec3 middle = target.bounds().center();
  if (made.components != (*cad)[0]) {
    report.findings.push_back(
        {"components",
         fmt::format("the CAD's surface has {} connected parts, the cage {}", (*cad)[0], made.components),
         middle});
  } else if (made.euler != (*cad)[1]) {
    report.findings.push_back(
        {"euler",
         fmt::format("the CAD's surface has Euler characteristic {} (genus {}), the cage {}", (*cad)[1],
                     (*cad)[0] - (*cad)[1] / 2, made.euler),
         middle});
  }
}

/// One grid over the surface.
struct Trial {
  double size_factor = 1;
  double merge = 0.3;  ///< sizes: anchors nearer together become one line
  std::vector<Index> lost_groups;
};

AmbientBlocks try_grid(const AmbientSurface& surface, const TargetSurface& target,
                       const AmbientSettings& settings, const Trial& trial, Progress& progress,
                       std::vector<Index>& lost_groups) {
  AmbientBlocks result;
  AmbientReport& report = result.report;
  AmbientFrame frame = surface.frame;
  for (double& size : frame.size) size *= trial.size_factor;
  report.size = frame.size;
  report.charts = static_cast<Index>(surface.charts.charts.size());
  Anchors anchors = line_anchors(surface);
  add_anchors(surface, trial.lost_groups, anchors);
  VoxelGrid grid;
  grid.lines = grid_lines(frame, anchors, settings.growth, trial.merge);
  report.lines = grid.lines;
  const double cells = static_cast<double>(grid.cells(0)) * grid.cells(1) * grid.cells(2);
  if (cells > settings.max_blocks) {
    throw Error(ErrorKind::gate,
                fmt::format("automatic blocks: {:.0f} blocks would be needed, the limit is {}", cells,
                            settings.max_blocks),
                "give a larger --cage-size");
  }
  progress.step("blocks: voxels", 0);
  const std::array<std::vector<double>, 3> seen =
      body_fractions(grid, surface.mapped, surface.body.triangles);
  std::vector<double> fraction(seen[0].size());
  for (std::size_t c = 0; c < fraction.size(); ++c)
    fraction[c] = std::max({seen[0][c], seen[1][c], seen[2][c]});
  fill_body(grid, fraction, settings, report);
  std::vector<Index> node;
  BlockDraft draft = draft_of_voxels(grid, settings.internal ? 1 : 0, node);
  // The wall of the bare draft, in the mapped box: what labels are made from. A pillow keeps its points.
  std::vector<char> is_wall;
  for (const BoundaryQuad& q : draft.boundary) is_wall.push_back(q.patch == 0 ? 1 : 0);
  WallCage wall = cage_of_blocks(draft, is_wall, settings.internal != (surface.volume > 0));
  if (draft.hexes.empty() || wall.face_boundary.empty()) {
    throw Error(ErrorKind::gate, "automatic blocks: no cell of the grid lies inside of the CAD",
                "give a smaller --cage-size; flowcage inspect shows whether the CAD encloses something");
  }
  progress.step("blocks: labels", 0);
  result.cage = std::move(wall.cage);
  LabelSettings labelling;
  labelling.size = std::max({frame.size[0], frame.size[1], frame.size[2]});
  const std::vector<Index> label =
      label_quads(result.cage, 1, surface.mapped, surface.body.triangles, surface.triangle_chart,
                  surface.charts, surface.borders, labelling);
  for (Vec3& p : draft.points) p = surface.map.inverse(p, p);
  std::vector<Vec3> pulled_back;
  for (const Index v : wall.vertex_corner) pulled_back.push_back(draft.points[v]);
  WallFeatures features =
      wall_features({result.cage, label, surface.body, surface.mapped, surface.triangle_chart, pulled_back},
                    target, surface.charts, surface.borders);
  lost_groups = std::move(features.lost_groups);
  report.chains = features.chains;
  report.chains_matched = features.chains_followed;
  report.findings.insert(report.findings.end(), features.findings.begin(), features.findings.end());
  result.cage.creases = std::move(features.creases);
  result.cage.corners = std::move(features.corners);
  result.cage.points = std::move(features.places);
  result.face_region = std::move(features.face_region);
  name_patches(target, result.face_region, result.cage);
  if (settings.wall_layer) {
    draft = pillow(draft, std::vector<char>(draft.hexes.size(), 1), [](const BoundaryQuad& q) {
              return q.patch == 0;
            }).draft;
  }
  const bool manifold = std::none_of(report.findings.begin(), report.findings.end(),
                                     [](const AmbientFinding& f) { return f.check == "manifold"; });
  if (manifold) {
    assemble_blocks(std::move(draft), frame, result, wall);
    check_topology(target, result.cage, report);
  }
  return result;
}

}  // namespace

AmbientBlocks make_ambient_blocks(const TargetSurface& target, const AmbientSettings& settings,
                                  Progress& progress) {
  progress.step("blocks", 0);
  std::optional<AmbientBlocks> best;
  std::optional<Error> failure;
  AmbientSettings step_settings = settings;
  const auto usable = [](const AmbientBlocks& b) { return !b.complex.hexes.empty(); };
  const auto score = [&](const AmbientBlocks& b) { return std::pair(!usable(b), b.report.findings.size()); };
  for (const bool map : {true, false}) {
    if (map && !settings.map) continue;
    step_settings.map = map;
    const AmbientSurface surface = ambient_surface(target, step_settings, progress);
    Trial trial;
    // The ladder: as asked; lines at the ends of lost regions; smaller cells; then all of that without a map.
    for (int step = 0; step < (map ? 4 : 2); ++step) {
      std::vector<Index> lost;
      try {
        AmbientBlocks made = try_grid(surface, target, step_settings, trial, progress, lost);
        made.report.steps = fmt::format(
            "{}{}{}", map ? "map" : "no map", trial.lost_groups.empty() ? "" : ", lines at lost regions",
            trial.size_factor < 1 ? fmt::format(", cells {:.2f}", trial.size_factor) : "");
        if (usable(made) && made.report.findings.empty()) return made;
        if (!best || score(made) < score(*best)) best = std::move(made);
      } catch (const Error& error) {
        if (error.kind() != ErrorKind::gate) throw;
        if (!failure) failure = error;
      }
      constexpr double finer = 1.4, close = 0.05;
      if (step == 0 && !lost.empty()) {
        trial.lost_groups = lost;
        trial.merge = close;
      } else {
        trial.size_factor /= finer;
      }
    }
  }
  if (!best) throw *failure;
  if (!usable(*best)) {
    const AmbientFinding& first = best->report.findings.front();
    throw Error(ErrorKind::gate, "automatic blocks: " + first.what,
                "give another --cage-size, or draw a cage (docs/cages.md)");
  }
  return *best;
}

}  // namespace flowcage
