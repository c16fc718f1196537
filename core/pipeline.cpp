#include "core/pipeline.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

#include "core/blocks/enclosure.hpp"
#include "core/blocks/shell.hpp"
#include "core/limit/evaluate.hpp"
#include "core/limit/limit_stencils.hpp"
#include "core/mesh/hex_adjacency.hpp"
#include "core/optimise/smooth_blocks.hpp"
#include "core/subdivide/refine.hpp"
#include "core/volume/refine_volume.hpp"
#include "core/volume/wall_lines.hpp"
#include "core/volume/wall_normals.hpp"

namespace flowcage {
namespace {

using Clock = std::chrono::steady_clock;
double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

// How far the surface may miss CAD that the fit should have covered, in tolerances: both are sampled.
constexpr double coverage_factor = 1.5;

Gate make_gate(std::string name, double limit, double value, std::string where) {
  Gate gate{std::move(name), limit, value, value <= limit, {}};
  if (!gate.holds) gate.detail = std::move(where);
  return gate;
}

std::vector<Gate> surface_gates(const SurfaceFit& fit, double tolerance, double diagonal) {
  const Index folds = fit.levels.back().report.folds;
  return {
      make_gate("max_deviation", tolerance, fit.max_deviation,
                fmt::format("the fitted surface is {:.3g} m from the CAD near {}",
                            fit.max_deviation * diagonal, place(fit.worst_place))),
      make_gate("coverage_deviation", coverage_factor * tolerance, fit.coverage_deviation,
                fmt::format("CAD near {} is {:.3g} m from the fitted surface",
                            place(fit.worst_coverage_place), fit.coverage_deviation * diagonal)),
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

// Growth off the wall that the number of layers is chosen for where none is asked.
constexpr double default_growth = 1.25;

Index layers_at_start(const Shell& shell, int level) {
  return layers_for_growth(shell, level - shell.cage_level, default_growth);
}

// Cells along a typical line at a level, those of the boundary layer included.
double cells_along_line(const Shell& shell, const LayerSettings& layers, int level) {
  const int refinements = level - shell.cage_level;
  const Index count = layers_at_start(shell, level) << refinements;
  if (!(layers.first_height > 0)) return count;
  const TypicalLine line = typical_line(shell, refinements);
  std::vector<double> lengths{0};
  for (const double cell : geometric_cells(line.length, count, line.wall_cell, default_growth)) {
    lengths.push_back(lengths.back() + cell);
  }
  return static_cast<double>(graded_cells(lengths, layers).size());
}

double cells_at_level(const Shell& shell, const LayerSettings& layers, int level) {
  return std::ldexp(static_cast<double>(shell.wall.face_count()), 2 * (level - shell.cage_level)) *
         cells_along_line(shell, layers, level);
}

// The level whose number of cells is nearest to the wish, in ratio.
int level_for_cells(const Shell& shell, const VolumeSettings& settings) {
  constexpr int most_levels = 10;
  const auto distance = [&](int level) {
    return std::abs(
        std::log(cells_at_level(shell, settings.layers, level) / static_cast<double>(settings.cells)));
  };
  int best = shell.cage_level;
  for (int level = best + 1; level <= most_levels; ++level) {
    if (distance(level) < distance(best)) best = level;
  }
  return best;
}

// What a job makes at its last level, and the memory that takes: peaks measured on the examples.
struct Demand {
  double faces = 0, cells = 0, samples = 0;

  double bytes() const { return 46e3 * faces + 600 * cells + 800 * samples; }
  bool fits() const {
    constexpr double most_points = 2e9;  // an Index numbers them
    const double memory =
        static_cast<double>(::sysconf(_SC_PHYS_PAGES)) * static_cast<double>(::sysconf(_SC_PAGE_SIZE));
    return bytes() <= memory && std::max(cells, samples) < most_points;
  }
};

// The levels to do. Asked for (no tolerance), they are done or refused; otherwise they are only a bound,
// which comes down to what the machine holds. `demand` is that of a level, none is tried below `least`.
template <typename DemandOfLevel>
int affordable_levels(const FitSettings& fit, int least, const std::string& cage_name,
                      const DemandOfLevel& demand) {
  int most = std::max(fit.levels, least);
  while (most > least && !demand(most).fits()) --most;
  const bool asked = fit.tolerance <= 0;
  const int wanted = asked ? std::max(fit.levels, least) : most;
  const Demand needed = demand(wanted);
  if (needed.fits()) return wanted;
  std::string makes = fmt::format("{:.3g} faces", needed.faces);
  if (needed.cells > 0) makes += fmt::format(" and {:.3g} cells", needed.cells);
  if (needed.samples > 0) makes += fmt::format(" in {:.3g} samples", needed.samples);
  throw Error(
      ErrorKind::usage,
      fmt::format("--levels: {} level(s) of {} make {}, about {:.3g} GB: more than this machine holds",
                  wanted, cage_name, makes, needed.bytes() / 1e9),
      demand(most).fits() ? fmt::format("ask for fewer: {} level(s) fit", most)
                          : std::string("give a coarser cage or a larger machine"));
}

// The outer polyhedron was seen to enclose the cage; subdivision draws both in. Throws Error(input) where the
// outer limit surface does not enclose the fitted one.
void require_enclosure(const Shell& shell, const SurfaceFit& fit, const std::string& outer_name) {
  const int level = std::min(shell.cage_level + 1, static_cast<int>(fit.levels.size()) - 1);
  const SurfaceLevel& topology = fit.levels[level].topology;
  const std::vector<Vec3> inner = limit_points(fit.levels[level]);
  const std::vector<Vec3> outer = outer_points(shell, level - shell.cage_level, true);
  if (const auto defect = enclosure_defect({topology, inner}, {topology, outer}, shell.symmetry)) {
    throw input_error(
        outer_name, 0, "its limit surface does not enclose the body: " + *defect,
        "draw the outer polyhedron larger: subdivision draws it in, by up to a third of its radius");
  }
}

// An open boundary of the cage follows the CAD's, which need not lie in the cage's symmetry plane. Throws
// Error(input) where the fitted one leaves it.
void require_planar_rim(const Shell& shell, const SurfaceFit& fit, const TargetSurface& target,
                        const std::string& cage_name) {
  if (!shell.symmetry) return;
  constexpr double allowed = 1e-3;  // of the diagonal
  const FittedLevel& last = fit.levels.back();
  const std::vector<Vec3> limit = limit_points(last);
  double worst = 0;
  Vec3 worst_place = Vec3::Zero();
  for (const Index v : boundary_vertices(last.topology)) {
    const double off = std::abs(shell.symmetry->distance(limit[v]));
    if (off > worst) {
      worst = off;
      worst_place = limit[v];
    }
  }
  if (worst <= allowed * target.diagonal()) return;
  throw input_error(
      cage_name, 0,
      fmt::format("the fitted surface's open boundary leaves the symmetry plane by {:.3g} m at {}", worst,
                  place(worst_place)),
      "the CAD is open there, too, off that plane: close the CAD and the cage there; only the cut "
      "of a half model may be open");
}

// Meshes up to this size are shaped as a whole; finer ones inherit that and are mended where need be.
constexpr Offset whole_mesh_cells = 30000;

// The blocks at the last level: refined in 3-D, the wall following the fitted control points at each level,
// finally limit points (on the CAD if asked) on the wall and the outer surface's own limit outside.
BlockMesh shaped_blocks(const Shell& shell, const VolumeSettings& settings, const SurfaceFit& fit,
                        Progress& progress) {
  const int last = static_cast<int>(fit.levels.size()) - 1;
  BlockMesh mesh =
      start_volume(shell, fit.levels[shell.cage_level].control_points, layers_at_start(shell, last));
  for (int level = shell.cage_level + 1; level <= last; ++level) {
    progress.step("volume",
                  static_cast<double>(level - shell.cage_level - 1) / (last - shell.cage_level + 1));
    mesh = refine_volume(mesh);
    const std::vector<Vec3> outer = outer_points(shell, level - shell.cage_level, false);
    // A far field that the optimiser slides along keeps its places; only a drawn one is told where to go.
    const bool drawn = !shell.outer_shape || level == shell.cage_level + 1;
    place_boundary(
        mesh, shell, fit.levels[level].topology,
        {fit.levels[level].control_points, drawn ? std::span<const Vec3>(outer) : std::span<const Vec3>()});
    if (!drawn) project_outer(mesh, shell);
    // Each refinement takes the root of the growth along the lines.
    if (level == shell.cage_level + 1) {
      spread_lines(mesh, shell, std::max(1.5, std::pow(default_growth, std::exp2(last - level))));
    }
    if (mesh.cell_count() <= whole_mesh_cells) {
      smooth_blocks(mesh, shell, progress);
    } else {
      mend_blocks(mesh, shell, progress);
    }
  }
  std::vector<Vec3> wall = limit_points(fit.levels[last]);
  if (settings.snap) wall = snapped(fit, std::move(wall));
  const std::vector<Vec3> outer =
      shell.outer_shape ? std::vector<Vec3>() : outer_points(shell, last - shell.cage_level, true);
  place_boundary(mesh, shell, fit.levels[last].topology, {wall, outer});
  return mesh;
}

struct GradedMesh {
  BlockMesh mesh;
  LayerReport layers;
  NormalReport normals;
  HexValidity validity;
};

// The shaped blocks with lines that leave the wall along its normals and, if asked, boundary layers on them.
GradedMesh graded_mesh(const Shell& shell, const VolumeSettings& settings, const SurfaceFit& fit,
                       Progress& progress) {
  GradedMesh result{shaped_blocks(shell, settings, fit, progress), {}, {}, {}};
  progress.step("spacing", 0);
  result.normals = turn_lines_to_wall(result.mesh, shell, {});
  progress.step("spacing", 0.5);
  if (settings.layers.first_height > 0) {
    result.mesh = insert_boundary_layers(result.mesh, shell, settings.layers, result.layers);
  }
  mend_blocks(result.mesh, shell, progress);
  result.validity = hex_validity(result.mesh);
  return result;
}

std::vector<PatchSummary> summarise_patches(const BlockMesh& mesh, const Shell& shell,
                                            const SurfaceLevel& top, std::span<const double> deviation,
                                            double diagonal) {
  const std::vector<WallLine> lines = wall_lines(shell, top);
  const std::vector<Index> wall = layer_points(mesh, shell, lines, 0);
  const std::vector<Index> first = layer_points(mesh, shell, lines, 1);
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
                                     worst.front().block, place(worst.front().place), worst.front().value));
}

// Cells whose corners are right but whose inside is not proved.
Gate proof_gate(const HexValidity& validity, const HexView& mesh) {
  Gate gate = make_gate("unproved_cells", 0, static_cast<double>(validity.uncertified), "");
  if (!gate.holds) {
    const LocatedCell cell = unproved_cells(mesh, 1).front();
    gate.detail = fmt::format(
        "the Jacobian inside {} of {} cells cannot be proved positive; the first, cell {} of block {}, is at "
        "{}",
        validity.uncertified, mesh.cell_count(), cell.cell, mesh.block_of(cell.cell), place(cell.centre));
  }
  return gate;
}

}  // namespace

bool all_hold(const std::vector<Gate>& gates) {
  return std::all_of(gates.begin(), gates.end(), [](const Gate& g) { return g.holds; });
}

SurfaceResult make_surface(const Cage& cage, const TargetSurface& target, const SurfaceSettings& settings,
                           Progress& progress) {
  FitSettings fit_settings = settings.fit;
  fit_settings.levels = affordable_levels(settings.fit, 0, cage.source, [&](int level) {
    const double faces = level == 0
                             ? static_cast<double>(cage.faces.size())
                             : std::ldexp(static_cast<double>(cage.faces.values.size()), 2 * (level - 1));
    return Demand{faces, 0, settings.sample > 0 ? std::ldexp(faces, 2 * settings.sample) : 0};
  });
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

VolumeResult make_volume(const Cage& cage, const TargetSurface& target, const VolumeSettings& settings,
                         Progress& progress) {
  const Shell shell = settings.outer ? build_shell(cage, *settings.outer)
                                     : build_farfield_shell(cage, settings.farfield, target.bounds());
  FitSettings fit_settings = settings.fit;
  if (settings.cells > 0) {
    fit_settings.levels = level_for_cells(shell, settings);
    fit_settings.tolerance = 0;  // a tolerance that is met earlier is no reason for fewer cells
  }
  fit_settings.levels = affordable_levels(fit_settings, shell.cage_level, cage.source, [&](int level) {
    const double faces =
        std::ldexp(static_cast<double>(shell.wall.face_count()), 2 * (level - shell.cage_level));
    return Demand{faces, cells_at_level(shell, settings.layers, level), 0};
  });

  const auto fit_start = Clock::now();
  SurfaceFit fit = fit_surface(cage, target, fit_settings, progress);
  const double fit_seconds = seconds_since(fit_start);
  require_planar_rim(shell, fit, target, cage.source);
  if (settings.outer) require_enclosure(shell, fit, settings.outer->source);

  const auto volume_start = Clock::now();
  GradedMesh graded = graded_mesh(shell, settings, fit, progress);
  BlockMesh& mesh = graded.mesh;

  progress.step("quality", 0);
  const FittedLevel& last = fit.levels.back();
  const std::vector<double> wall_deviation = distances_to(target, limit_points(last));
  const std::vector<Index> wall = layer_points(mesh, shell, wall_lines(shell, last.topology), 0);
  std::vector<double> deviation(mesh.points().size(), 0);
  for (std::size_t v = 0; v < wall.size(); ++v) deviation[wall[v]] = wall_deviation[v];
  const double diagonal = target.diagonal();
  TopologyBound bound = topology_bound(mesh);
  QualityReport quality = measure_quality(mesh, build_hex_adjacency(mesh), {}, &progress);
  std::vector<PatchSummary> patches = summarise_patches(mesh, shell, last.topology, deviation, diagonal);
  std::vector<Gate> gates = surface_gates(fit, settings.tolerance, diagonal);
  gates.push_back(inversion_gate(quality));
  gates.push_back(proof_gate(graded.validity, mesh));
  return {.fit = std::move(fit),
          .mesh = std::move(mesh),
          .quality = std::move(quality),
          .validity = graded.validity,
          .bound = std::move(bound),
          .layers = graded.layers,
          .normals = graded.normals,
          .deviation = std::move(deviation),
          .patches = std::move(patches),
          .gates = std::move(gates),
          .fit_seconds = fit_seconds,
          .volume_seconds = seconds_since(volume_start)};
}

}  // namespace flowcage
