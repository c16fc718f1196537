#include "tests/blocks/swept_bodies.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <stdexcept>

#include "core/blocks/swept_base.hpp"
#include "core/limit/limit_stencils.hpp"
#include "core/optimise/untangle.hpp"
#include "core/subdivide/refine.hpp"
#include "core/volume/refine_volume.hpp"
#include "core/volume/start_swept.hpp"
#include "core/volume/wall_lines.hpp"
#include "occ_bridge/shapes.hpp"

namespace flowcage::test {
namespace {

HalfWing half_wing(double half_base, WingTip tip, bool closed_root) {
  HalfWing wing;
  wing.airfoil = naca_symmetric(0.12, half_base);
  wing.tip = tip;
  wing.closed_root = closed_root;
  return wing;
}

const std::vector<std::pair<std::string, std::function<Shape()>>>& bodies() {
  static const std::vector<std::pair<std::string, std::function<Shape()>>> all{
      {"wing_sharp", [] { return make_half_wing(half_wing(0, WingTip::flat, false)); }},
      {"wing_blunt", [] { return make_half_wing(half_wing(0.0025, WingTip::flat, false)); }},
      {"wing_rounded", [] { return make_half_wing(half_wing(0, WingTip::rounded, false)); }},
      {"onera_m6", [] { return make_onera_m6(); }},
      {"wing_closed_sharp", [] { return make_half_wing(half_wing(0, WingTip::flat, true)); }},
      {"wing_closed_blunt", [] { return make_half_wing(half_wing(0.0025, WingTip::flat, true)); }},
  };
  return all;
}

/// Points of the outer boundary slide in their plane where that is across an axis; the wall stays.
std::vector<PointFreedom> freedom(const BlockMesh& mesh) {
  std::vector<PointFreedom> out(mesh.points().size());
  for (const BoundaryPatch& patch : mesh.patches()) {
    for (const auto& quad : patch.quads) {
      unsigned axes = 0;
      for (unsigned a = 0; a < 3; ++a) {
        const double at = mesh.points()[quad[0]][a];
        if (std::all_of(quad.begin(), quad.end(), [&](Index p) { return mesh.points()[p][a] == at; })) {
          axes |= 1U << a;
        }
      }
      if (axes == 0 || patch.type == PatchType::wall) axes = PointFreedom::all_axes;
      for (const Index p : quad) out[p].frozen_axes |= static_cast<std::uint8_t>(axes);
    }
  }
  return out;
}

/// Cells on outward chords so that they grow by 1.4 at most after the refinements.
Index layers_at_start(const SweptBlocks& swept, std::span<const Vec3> wall, int refinements) {
  std::vector<double> edges;
  for (const auto& [a, b] : swept.blocks.wall.edge_vertices) {
    edges.push_back((wall[swept.cage_vertex[a]] - wall[swept.cage_vertex[b]]).norm());
  }
  std::nth_element(edges.begin(), edges.begin() + static_cast<long>(edges.size() / 2), edges.end());
  Box3 box;
  for (const Vec3& p : swept.blocks.complex->points) box.extend(p);
  const double cell = std::ldexp(edges[edges.size() / 2], -refinements);
  const double length = box.sizes().maxCoeff() / 2;
  for (Index layers = 2; layers < 16; ++layers) {
    if (cell * (std::pow(1.4, layers << refinements) - 1) / 0.4 >= length) return layers;
  }
  return 16;
}

void smooth(BlockMesh& mesh, Progress& progress) {
  UntangleSettings settings;
  settings.freedom = freedom(mesh);
  settings.max_cell_evaluations = 4e7;
  mesh.mutable_points() = untangle(mesh, settings, progress).points;
}

}  // namespace

std::vector<std::string> swept_body_names() {
  std::vector<std::string> names;
  for (const auto& [name, make] : bodies()) names.push_back(name);
  return names;
}

CadModel make_swept_body(const std::string& name) {
  Progress silent;
  for (const auto& [known, make] : bodies()) {
    if (known == name) return cad_model_of(make(), {}, silent);
  }
  throw std::invalid_argument("no such body: " + name);
}

CadModel read_swept_cad(const std::string& file) {
  Progress silent;
  return read_cad({&file, 1}, {}, silent);
}

SweptMesh mesh_swept_body(const CadModel& cad, const std::string& name, int levels, Progress& progress) {
  SweptBlocks swept = make_swept_blocks(cad, {}, name);
  FitSettings settings;
  settings.levels = std::max(levels, 1);
  SurfaceFit fit = fit_surface(swept.cage, cad, settings, progress);
  std::vector<Vec3> start = fit.levels[1].control_points;
  straighten_base(swept, swept.blocks.wall, fit.levels[1].topology, start);
  BlockMesh mesh = start_swept_volume(swept, start, layers_at_start(swept, start, settings.levels - 1));
  SurfaceLevel cut = swept.blocks.wall;
  const auto place = [&](int level, std::vector<Vec3> points) {
    straighten_base(swept, cut, fit.levels[level].topology, points);
    std::vector<Vec3> places;
    for (const Index v : cut_vertices(cut, fit.levels[level].topology)) places.push_back(points[v]);
    place_boundary(mesh, swept.blocks, cut, {places, {}});
  };
  const HexValidity at_start = hex_validity(mesh);
  smooth(mesh, progress);
  for (int level = 2; level <= settings.levels; ++level) {
    mesh = refine_volume(mesh);
    cut = build_child_level(cut);
    place(level, fit.levels[level].control_points);
    if (mesh.cell_count() < 100000) smooth(mesh, progress);
  }
  const FittedLevel& last = fit.levels.back();
  place(settings.levels, apply_stencils(limit_stencils(last.topology), last.control_points));
  RepairSettings repair;
  repair.optimise.freedom = freedom(mesh);
  const HexValidity before = hex_validity(mesh);
  if (before.inverted + before.uncertified > 0) {
    mesh.mutable_points() = repair_cells(mesh, repair, progress).points;
  }
  const HexValidity validity = hex_validity(mesh);
  return {std::move(swept), std::move(fit), std::move(mesh), at_start, validity};
}

}  // namespace flowcage::test
