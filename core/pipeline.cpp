#include "core/pipeline.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/stopwatch.hpp"
#include "core/limit/evaluate.hpp"
#include "core/limit/limit_stencils.hpp"
#include "core/mesh/coarsen_blocks.hpp"
#include "core/mesh/hex_adjacency.hpp"
#include "core/mesh/opening_names.hpp"
#include "core/optimise/smooth_blocks.hpp"
#include "core/subdivide/refine.hpp"
#include "core/volume/leaning_lines.hpp"
#include "core/volume/refine_volume.hpp"
#include "core/volume/wall_lines.hpp"
#include "core/volume/wall_normals.hpp"

namespace flowcage {
namespace {

// How far the surface may miss CAD that the fit should have covered, in tolerances: both are sampled.
constexpr double coverage_factor = 1.5;

Gate make_gate(std::string name, double limit, double value, std::string where,
               std::optional<Vec3> worst = {}) {
  Gate gate{std::move(name), limit, value, value <= limit, {}, worst};
  if (!gate.holds) gate.detail = std::move(where);
  return gate;
}

std::vector<Gate> surface_gates(const SurfaceFit& fit, double tolerance, double diagonal) {
  const Index folds = fit.levels.back().report.folds;
  return {
      make_gate("max_deviation", tolerance, fit.max_deviation,
                fmt::format("the fitted surface is {:.3g} m from the CAD near {}",
                            fit.max_deviation * diagonal, place(fit.worst_place)),
                fit.worst_place),
      make_gate("coverage_deviation", coverage_factor * tolerance, fit.coverage_deviation,
                fmt::format("CAD near {} is {:.3g} m from the fitted surface",
                            place(fit.worst_coverage_place), fit.coverage_deviation * diagonal),
                fit.worst_coverage_place),
      make_gate("surface_folds", 0, folds, fmt::format("{} faces of the fitted surface are folded", folds)),
  };
}

// Limit points of a level's vertices.
std::vector<Vec3> limit_points(const FittedLevel& level) {
  return apply_stencils(limit_stencils(level.topology), level.control_points);
}

// Vertices of the last level, put on the CAD where the fit knows their place.
std::vector<Vec3> snapped(const SurfaceFit& fit, std::vector<Vec3> points) {
  for (std::size_t v = 0; v < points.size(); ++v) {
    if (fit.vertex_targets[v].kind != VertexTarget::Kind::none) points[v] = fit.vertex_targets[v].position;
  }
  return points;
}

std::vector<double> distances_to(const TargetSurface& target, std::span<const Vec3> points) {
  std::vector<SurfacePoint> feet(points.size());
  target.closest_points(points, {}, feet);
  std::vector<double> distances(points.size());
  std::transform(feet.begin(), feet.end(), distances.begin(),
                 [](const SurfacePoint& f) { return f.distance; });
  return distances;
}

Cage as_cage(const SurfaceLevel& level, std::vector<Vec3> points, const Cage& like) {
  Cage mesh;
  mesh.points = std::move(points);
  mesh.faces = level.face_vertices;
  mesh.face_patch = level.face_patch;
  mesh.patch_names = like.patch_names;
  return mesh;
}

// Cells when the fit ends at a level, boundary layers included.
double cells_at_level(const BlockSource& source, const LayerSettings& layers, int last) {
  const BlockSource::Size size = source.size_at(last);
  if (!(layers.first_height > 0)) return size.cells;
  std::vector<double> lengths{0};
  for (const double cell : geometric_cells(size.line.length, size.line_cells, size.line.wall_cell, 1.5)) {
    lengths.push_back(lengths.back() + cell);
  }
  const auto graded = static_cast<double>(graded_cells(lengths, layers).size());
  const double lines =
      std::ldexp(static_cast<double>(source.blocks().wall.face_count()), 2 * (last - source.fit_level()));
  return size.cells + lines * (graded - size.line_cells);
}

// The level whose number of cells is nearest to the wish, in ratio.
int level_for_cells(const BlockSource& source, const VolumeSettings& settings) {
  constexpr int most_levels = 10;
  const auto distance = [&](int level) {
    return std::abs(
        std::log(cells_at_level(source, settings.layers, level) / static_cast<double>(settings.cells)));
  };
  int best = source.fit_level();
  double least = distance(best);
  for (int level = best + 1; level <= most_levels; ++level) {
    const double next = distance(level);
    if (next >= least) break;
    best = level;
    least = next;
  }
  return best;
}

struct ShapedMesh {
  BlockMesh mesh;
  SurfaceLevel cut;               ///< the blocks' wall refined to the last level
  std::vector<Index> fit_vertex;  ///< #V of cut: vertex of the fit's last level
};

// Places of the fit's vertices, carried to the wall of the blocks.
void place_wall(ShapedMesh& shaped, const BlockSource& source, const FittedLevel& level,
                std::vector<Vec3> points) {
  source.straighten(shaped.cut, level.topology, points);
  shaped.fit_vertex = source.fit_vertices(shaped.cut, level.topology);
  std::vector<Vec3> places;
  places.reserve(shaped.fit_vertex.size());
  for (const Index v : shaped.fit_vertex) places.push_back(points[v]);
  place_boundary(shaped.mesh, source.blocks(), shaped.cut, {places, {}});
}

// The blocks at the last level: refined in 3-D, the wall following the fitted control points at each level,
// finally limit points (on the CAD if asked) on the wall and the outer surface's own limit outside.
ShapedMesh shaped_blocks(const BlockSource& source, const VolumeSettings& settings, const SurfaceFit& fit,
                         Progress& progress) {
  const int first = source.fit_level();
  const int last = static_cast<int>(fit.levels.size()) - 1;
  ShapedMesh shaped{source.start(fit, last), source.blocks().wall, {}};
  BlockMesh& mesh = shaped.mesh;
  for (int level = first; level <= last; ++level) {
    progress.step("volume", static_cast<double>(level - first) / (last - first + 1));
    if (level > first) {
      mesh = refine_volume(mesh);
      shaped.cut = build_child_level(shaped.cut);
      place_wall(shaped, source, fit.levels[level], fit.levels[level].control_points);
      source.place_outer(mesh, shaped.cut, level - first, false);
      if (level == first + 1) source.spread(mesh, level, last);
    }
    if ((level > first || source.shape_start()) && mesh.cell_count() <= source.whole_mesh_cells()) {
      smooth_blocks(mesh, source.freedom(mesh), progress);
    } else {
      mend_blocks(
          mesh, [&] { return source.freedom(mesh); }, progress);
    }
  }
  std::vector<Vec3> wall = limit_points(fit.levels[last]);
  if (settings.snap) wall = snapped(fit, std::move(wall));
  place_wall(shaped, source, fit.levels[last], std::move(wall));
  source.place_outer(mesh, shaped.cut, last - first, true);
  return shaped;
}

struct GradedMesh {
  ShapedMesh shaped;
  LayerReport layers;
  NormalReport normals;
  CellProof validity;
};

// The shaped blocks with lines that leave the wall along its normals and, if asked, boundary layers on them.
GradedMesh graded_mesh(const BlockSource& source, const VolumeSettings& settings, const SurfaceFit& fit,
                       Progress& progress) {
  GradedMesh result{shaped_blocks(source, settings, fit, progress), {}, {}, {}};
  BlockMesh& mesh = result.shaped.mesh;
  progress.step("spacing", 0);
  result.normals = turn_lines_to_wall(mesh, source.blocks(), {});
  progress.step("spacing", 0.5);
  if (settings.layers.first_height > 0) {
    LayerSettings layers = settings.layers;
    layers.multiple = Index{1} << (settings.family - 1);
    mesh = insert_boundary_layers(mesh, source.blocks(), layers, result.layers);
  } else {
    shorten_leaning_lines(mesh, source.blocks());
  }
  result.validity = mend_blocks(
      mesh, [&] { return source.freedom(mesh); }, progress);
  return result;
}

std::vector<PatchSummary> summarise_patches(const BlockMesh& mesh, const WallBlocks& blocks,
                                            const SurfaceLevel& cut, std::span<const double> deviation,
                                            double diagonal) {
  const std::vector<WallLine> lines = wall_lines(blocks, cut);
  const std::vector<Index> wall = layer_points(mesh, blocks, lines, 0);
  const std::vector<Index> first = layer_points(mesh, blocks, lines, 1);
  std::vector<double> height(mesh.points().size(), 0);
  for (std::size_t v = 0; v < wall.size(); ++v) {
    height[wall[v]] = (mesh.points()[first[v]] - mesh.points()[wall[v]]).norm();
  }
  std::vector<PatchSummary> summaries;
  for (const BoundaryPatch& patch : mesh.patches()) {
    PatchSummary s{patch.name, patch.type, static_cast<Index>(patch.quads.size())};
    if (patch.type == PatchType::wall && s.faces > 0) {
      s.min_first_height = std::numeric_limits<double>::max();
      double squares = 0;
      for (const auto& quad : patch.quads) {
        for (Index p : quad) {
          s.max_deviation = std::max(s.max_deviation, deviation[p] / diagonal);
          squares += std::pow(deviation[p] / diagonal, 2) / 4;
          s.min_first_height = std::min(s.min_first_height, height[p]);
          s.max_first_height = std::max(s.max_first_height, height[p]);
        }
      }
      s.rms_deviation = std::sqrt(squares / s.faces);
    }
    summaries.push_back(std::move(s));
  }
  return summaries;
}

Gate inversion_gate(const QualityReport& quality) {
  const auto& worst = quality.scaled_jacobian.worst;
  return make_gate("inverted_cells", 0, static_cast<double>(quality.inverted_cells),
                   worst.empty()
                       ? ""
                       : fmt::format("{} of {} cells are inverted; the worst, cell {} of block {}, is at {} "
                                     "(scaled Jacobian {:.3g})",
                                     quality.inverted_cells, quality.cells, worst.front().cell,
                                     worst.front().block, place(worst.front().place), worst.front().value),
                   worst.empty() ? std::nullopt : std::optional(worst.front().place));
}

// Cells whose corners are right but whose inside is not proved.
Gate proof_gate(const CellProof& validity, const HexView& mesh) {
  Gate gate = make_gate("unproved_cells", 0, static_cast<double>(validity.uncertified), "");
  if (!gate.holds) {
    const LocatedCell cell = unproved_cells(mesh, 1).front();
    gate.place = cell.centre;
    gate.detail = fmt::format(
        "the Jacobian inside {} of {} cells cannot be proved positive; the first, cell {} of block {}, is at "
        "{}",
        validity.uncertified, mesh.cell_count(), cell.cell, mesh.block_of(cell.cell), place(cell.centre));
  }
  return gate;
}

// The coarser meshes of a nested family, the finest of them first.
std::vector<FamilyMember> coarser_members(const BlockMesh& fine, std::span<const double> deviation, int count,
                                          Progress& progress) {
  std::vector<FamilyMember> members;
  for (int n = 0; n < count; ++n) {
    const bool first = members.empty();
    CoarsenedBlocks coarse = coarsen_blocks(first ? fine : members.back().mesh);
    const std::span<const double> from =
        first ? deviation : std::span<const double>(members.back().deviation);
    std::vector<double> at_points;
    for (const Index p : coarse.fine_point) at_points.push_back(from[p]);
    QualityReport quality = measure_quality(coarse.mesh, build_hex_adjacency(coarse.mesh), {}, &progress);
    const CellProof validity = prove_cells(coarse.mesh);
    members.push_back({std::move(coarse.mesh), std::move(quality), validity, std::move(at_points)});
  }
  return members;
}

}  // namespace

bool all_hold(const std::vector<Gate>& gates) {
  return std::all_of(gates.begin(), gates.end(), [](const Gate& g) { return g.holds; });
}

SurfaceResult make_surface(const Cage& cage, const TargetSurface& target, const SurfaceSettings& settings,
                           Progress& progress) {
  FitSettings fit_settings = settings.fit;
  const auto at_level = [&](int level) {
    const double faces = level == 0
                             ? static_cast<double>(cage.faces.size())
                             : std::ldexp(static_cast<double>(cage.faces.values.size()), 2 * (level - 1));
    return Prediction{.faces = faces,
                      .samples = settings.sample > 0 ? std::ldexp(faces, 2 * settings.sample) : 0};
  };
  fit_settings.levels = affordable_levels(settings.fit, 0, cage.source, at_level).levels;
  SurfaceResult result;
  result.fit = fit_surface(cage, target, fit_settings, progress);
  const FittedLevel& last = result.fit.levels.back();
  std::vector<Vec3> limit;
  if (settings.sample > 0) {
    const SampledSurface sampled = sample_limit_surface(last.topology, last.control_points, settings.sample);
    result.mesh = as_cage(sampled.topology, sampled.points, cage);
    result.deviation = distances_to(target, result.mesh.points);
  } else {
    limit = limit_points(last);
    result.deviation = distances_to(target, limit);
    if (settings.snap) limit = snapped(result.fit, std::move(limit));
    result.mesh = as_cage(last.topology, std::move(limit), cage);
  }
  result.gates = surface_gates(result.fit, settings.tolerance, target.diagonal());
  return result;
}

VolumeResult make_volume(const BlockSource& source, const TargetSurface& target,
                         const VolumeSettings& settings, Progress& progress) {
  for (const std::string& warning : source.warnings()) progress.warn(warning);
  FitSettings fit_settings = settings.fit;
  fit_settings.least_levels = source.fit_level() + settings.family - 1;
  if (settings.cells > 0) {
    fit_settings.levels = level_for_cells(source, settings);
    fit_settings.tolerance = 0;  // a tolerance that is met earlier is no reason for fewer cells
  }
  const auto at_level = [&](int level) {
    const double faces =
        std::ldexp(static_cast<double>(source.blocks().wall.face_count()), 2 * (level - source.fit_level()));
    return Prediction{.faces = faces, .cells = cells_at_level(source, settings.layers, level)};
  };
  const Prediction prediction =
      affordable_levels(fit_settings, source.fit_level(), source.cage().source, at_level);
  fit_settings.levels = prediction.levels;
  if (settings.predicted) settings.predicted(prediction);

  if (fit_settings.levels < fit_settings.least_levels) {
    throw Error(
        ErrorKind::usage,
        fmt::format("--family {} needs {} levels for its coarsest mesh to be the blocks; there are {}",
                    settings.family, fit_settings.least_levels, fit_settings.levels),
        "ask for more --levels, or a smaller --family");
  }

  const Stopwatch fit_time;
  SurfaceFit fit = fit_surface(source.cage(), target, fit_settings, progress);
  const double fit_seconds = fit_time.seconds();
  source.check(fit, target);

  const Stopwatch volume_time;
  GradedMesh graded = graded_mesh(source, settings, fit, progress);
  BlockMesh& mesh = graded.shaped.mesh;

  progress.step("quality", 0);
  const SurfaceLevel& cut = graded.shaped.cut;
  const std::vector<double> wall_deviation = distances_to(target, limit_points(fit.levels.back()));
  const std::vector<Index> wall = layer_points(mesh, source.blocks(), wall_lines(source.blocks(), cut), 0);
  std::vector<double> deviation(mesh.points().size(), 0);
  for (std::size_t v = 0; v < wall.size(); ++v) {
    deviation[wall[v]] = wall_deviation[graded.shaped.fit_vertex[v]];
  }
  name_openings(mesh);
  const double diagonal = target.diagonal();
  TopologyBound bound = topology_bound(mesh);
  QualityReport quality = measure_quality(mesh, build_hex_adjacency(mesh), {}, &progress);
  std::vector<PatchSummary> patches = summarise_patches(mesh, source.blocks(), cut, deviation, diagonal);
  std::vector<Gate> gates = surface_gates(fit, settings.tolerance, diagonal);
  gates.push_back(inversion_gate(quality));
  gates.push_back(proof_gate(graded.validity, mesh));
  std::vector<FamilyMember> coarser = coarser_members(mesh, deviation, settings.family - 1, progress);
  for (const FamilyMember& member : coarser) {
    for (Gate gate : {inversion_gate(member.quality), proof_gate(member.validity, member.mesh)}) {
      gate.name += fmt::format("_of_{}_cells", member.quality.cells);
      gates.push_back(std::move(gate));
    }
  }
  return {.fit = std::move(fit),
          .mesh = std::move(mesh),
          .quality = std::move(quality),
          .validity = graded.validity,
          .bound = std::move(bound),
          .layers = graded.layers,
          .normals = graded.normals,
          .deviation = std::move(deviation),
          .patches = std::move(patches),
          .coarser = std::move(coarser),
          .gates = std::move(gates),
          .fit_seconds = fit_seconds,
          .volume_seconds = volume_time.seconds()};
}

}  // namespace flowcage
