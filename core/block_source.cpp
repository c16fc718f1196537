#include "core/block_source.hpp"

#include <fmt/format.h>

#include <cmath>

#include "core/blocks/assemble_blocks.hpp"
#include "core/blocks/drawn_blocks.hpp"
#include "core/blocks/enclosure.hpp"
#include "core/blocks/swept_base.hpp"
#include "core/limit/limit_stencils.hpp"
#include "core/refit/prepare_cage.hpp"
#include "core/subdivide/refine.hpp"
#include "core/volume/start_swept.hpp"

namespace flowcage {
namespace {

/// Growth off the wall that the number of layers is chosen for.
constexpr double default_growth = 1.25;

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<long>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Median line and median wall edge of blocks before any refinement.
TypicalLine coarse_line(const WallBlocks& blocks) {
  const HexComplex& complex = *blocks.complex;
  std::vector<double> lengths, edges;
  for (Index f = 0; f < blocks.wall.face_count(); ++f) {
    const auto& line = complex.edges[seat_edge(blocks, f).edge];
    lengths.push_back((complex.points[line[0]] - complex.points[line[1]]).norm());
    const WallSeat& seat = blocks.seats[f];
    for (int c = 0; c < 4; ++c) {
      edges.push_back((complex.points[complex.hexes[seat.block][seat.foot[c]]] -
                       complex.points[complex.hexes[seat.block][seat.foot[(c + 1) % 4]]])
                          .norm());
    }
  }
  return {median(std::move(lengths)), median(std::move(edges))};
}

class ShellSource final : public BlockSource {
 public:
  ShellSource(Cage cage, const Cage* outer, const FarField& farfield, const Box3& body)
      : cage_(std::move(cage)),
        drawn_(outer != nullptr),
        outer_name_(outer != nullptr ? outer->source : ""),
        shell_(drawn_ ? build_shell(cage_, *outer) : build_farfield_shell(cage_, farfield, body)) {}

  std::string name() const override { return "shell"; }
  const Cage& cage() const override { return cage_; }
  const WallBlocks& blocks() const override { return shell_; }
  int fit_level() const override { return shell_.cage_level; }

  Size size_at(int last) const override {
    const int refinements = last - shell_.cage_level;
    const Index line = layers(last) << refinements;
    return {std::ldexp(static_cast<double>(shell_.wall.face_count()), 2 * refinements) * line, line,
            typical_line(shell_, refinements)};
  }
  BlockMesh start(const SurfaceFit& fit, int last) const override {
    return start_volume(shell_, fit.levels[shell_.cage_level].control_points, layers(last));
  }
  void spread(BlockMesh& mesh, int level, int last) const override {
    // Each refinement takes the root of the growth along the lines.
    spread_lines(mesh, shell_, std::max(1.5, std::pow(default_growth, std::exp2(last - level))));
  }
  void place_outer(BlockMesh& mesh, const SurfaceLevel& cut, int refinements, bool last) const override {
    // A far field that the optimiser slides along keeps its places; only a drawn one is told where to go.
    if (shell_.outer_shape && refinements > 1) {
      if (!last) project_outer(mesh, shell_);
      return;
    }
    place_boundary(mesh, shell_, cut, {{}, outer_points(shell_, refinements, last)});
  }
  BoundaryFreedom freedom(const BlockMesh& mesh) const override { return shell_freedom(mesh, shell_); }
  void check(const SurfaceFit& fit, const TargetSurface& target) const override {
    require_planar_rim(fit, target);
    if (drawn_) require_enclosure(fit);
  }

 private:
  Index layers(int last) const { return layers_for_growth(shell_, last - shell_.cage_level, default_growth); }

  static std::vector<Vec3> limit_points(const FittedLevel& level) {
    return apply_stencils(limit_stencils(level.topology), level.control_points);
  }

  /// The outer polyhedron was seen to enclose the cage; subdivision draws both in.
  void require_enclosure(const SurfaceFit& fit) const {
    const int level = std::min(shell_.cage_level + 1, static_cast<int>(fit.levels.size()) - 1);
    const SurfaceLevel& topology = fit.levels[level].topology;
    const std::vector<Vec3> inner = limit_points(fit.levels[level]);
    const std::vector<Vec3> outer = outer_points(shell_, level - shell_.cage_level, true);
    if (const auto defect = enclosure_defect({topology, inner}, {topology, outer}, shell_.symmetry)) {
      throw input_error(
          outer_name_, 0, "its limit surface does not enclose the body: " + *defect,
          "draw the outer polyhedron larger: subdivision draws it in, by up to a third of its radius");
    }
  }

  /// An open boundary of the cage follows the CAD's, which need not lie in the cage's symmetry plane.
  void require_planar_rim(const SurfaceFit& fit, const TargetSurface& target) const {
    if (!shell_.symmetry) return;
    constexpr double allowed = 1e-3;  // of the diagonal
    const FittedLevel& last = fit.levels.back();
    const std::vector<Vec3> limit = limit_points(last);
    double worst = 0;
    Vec3 worst_place = Vec3::Zero();
    for (const Index v : boundary_vertices(last.topology)) {
      const double off = std::abs(shell_.symmetry->distance(limit[v]));
      if (off > worst) {
        worst = off;
        worst_place = limit[v];
      }
    }
    if (worst <= allowed * target.diagonal()) return;
    throw input_error(
        cage_.source, 0,
        fmt::format("the fitted surface's open boundary leaves the symmetry plane by {:.3g} m at {}", worst,
                    place(worst_place)),
        "the CAD is open there, too, off that plane: close the CAD and the cage there; only the cut "
        "of a half model may be open");
  }

  Cage cage_;
  bool drawn_;
  std::string outer_name_;
  Shell shell_;
};

class SweptSource final : public BlockSource {
 public:
  explicit SweptSource(SweptBlocks swept) : swept_(std::move(swept)) {}

  std::string name() const override { return "swept"; }
  const Cage& cage() const override { return swept_.cage; }
  const WallBlocks& blocks() const override { return swept_.blocks; }
  int fit_level() const override { return 1; }
  std::vector<std::string> warnings() const override { return swept_.body.warnings; }

  Size size_at(int last) const override {
    const int refinements = last - 1;
    const Index line = layers(last);
    const SurfaceLevel level = build_surface_level(swept_.cage);
    const std::vector<Vec3> points = apply_stencils(refinement_stencils(level), swept_.cage.points);
    const BlockMesh mesh = start_swept_volume(swept_, points, line);
    TypicalLine typical = coarse_line(swept_.blocks);
    typical.wall_cell = std::ldexp(typical.wall_cell, -refinements);
    return {std::ldexp(static_cast<double>(mesh.cell_count()), 3 * refinements), line << refinements,
            typical};
  }
  BlockMesh start(const SurfaceFit& fit, int last) const override {
    std::vector<Vec3> points = fit.levels[1].control_points;
    straighten_base(swept_, swept_.blocks.wall, fit.levels[1].topology, points);
    return start_swept_volume(swept_, points, layers(last));
  }
  std::vector<Index> fit_vertices(const SurfaceLevel& cut, const SurfaceLevel& level) const override {
    return cut_vertices(cut, level);
  }
  void straighten(const SurfaceLevel& cut, const SurfaceLevel& level, std::span<Vec3> points) const override {
    straighten_base(swept_, cut, level, points);
  }
  BoundaryFreedom freedom(const BlockMesh& mesh) const override { return planar_freedom(mesh); }
  /// The coarse cells at a tip do not know its curves: two of the fit's levels have to be shaped.
  Offset whole_mesh_cells() const override { return 150000; }
  bool shape_start() const override { return true; }  // its blocks are straight from the wall to the box

 private:
  /// Cells on outward chords so that they grow by 1.4 at most after the refinements.
  Index layers(int last) const {
    constexpr double most_growth = 1.4;
    const TypicalLine line = coarse_line(swept_.blocks);
    const double cell = std::ldexp(line.wall_cell, 1 - last);
    for (Index layers = 2; layers < 16; ++layers) {
      const double reach = cell * (std::pow(most_growth, layers << (last - 1)) - 1) / (most_growth - 1);
      if (reach >= line.length) return layers;
    }
    return 16;
  }

  SweptBlocks swept_;
};

/// The wall of a fluid inside of the CAD is seen from the side that the CAD's normals leave, its cage from
/// the other: the same faces, each the other way round from the same first corner.
Cage turned(Cage cage) {
  for (Index f = 0; f < cage.faces.size(); ++f) {
    const auto face = cage.faces[f];
    std::reverse(face.begin() + 1, face.end());
  }
  return cage;
}

/// Vertex of a level of a cage of quads for each vertex of the turned cage's level. Child i of a face has its
/// corner i; turned, corner c is corner (4 - c) mod 4.
std::vector<Index> turned_vertices(const SurfaceLevel& cut, const SurfaceLevel& level) {
  const auto other = [](Index c) { return (4 - c) % 4; };
  std::vector<Index> out(cut.vertex_count(), no_index);
  for (Index f = 0; f < cut.face_count(); ++f) {
    Index g = f >> (2 * cut.depth);
    for (int d = cut.depth - 1; d >= 0; --d) g = 4 * g + other(f >> (2 * d) & 3);
    for (int c = 0; c < 4; ++c) out[cut.face_vertices[f][c]] = level.face_vertices[g][other(c)];
  }
  return out;
}

/// Blocks of any topology whose walls are fitted: of the ambient grid or of a file.
class PlacedSource final : public BlockSource {
 public:
  PlacedSource(AmbientBlocks ambient, std::string route, const std::string& name)
      : route_(std::move(route)), ambient_(std::move(ambient)) {
    const auto complex = std::make_shared<const HexComplex>(ambient_.complex);
    const auto seated = [&](const Cage& cage) {
      return seat_blocks(complex, build_surface_level(cage), ambient_.vertex_corner, name);
    };
    blocks_ = seated(ambient_.cage);
    turned_ = !seen_from_block(blocks_, 0);
    if (turned_) blocks_ = seated(turned(ambient_.cage));
    blocks_.symmetry = find_symmetry_plane(blocks_.wall, ambient_.cage.points, name);
  }

  std::string name() const override { return route_; }
  const Cage& cage() const override { return ambient_.cage; }
  const WallBlocks& blocks() const override { return blocks_; }
  int fit_level() const override { return 0; }

  Size size_at(int last) const override {
    TypicalLine line = coarse_line(blocks_);
    line.wall_cell = std::ldexp(line.wall_cell, -last);
    return {std::ldexp(static_cast<double>(ambient_.complex.hexes.size()), 3 * last), Index{1} << last, line};
  }
  BlockMesh start(const SurfaceFit& fit, int) const override {
    BlockMesh mesh(blocks_.complex);
    place_boundary(mesh, blocks_, blocks_.wall, {fit.levels[0].control_points, {}});
    return mesh;
  }
  std::vector<Index> fit_vertices(const SurfaceLevel& cut, const SurfaceLevel& level) const override {
    return turned_ ? turned_vertices(cut, level) : BlockSource::fit_vertices(cut, level);
  }
  BoundaryFreedom freedom(const BlockMesh& mesh) const override { return planar_freedom(mesh); }

 private:
  std::string route_;
  AmbientBlocks ambient_;
  WallBlocks blocks_;
  bool turned_ = false;
};

void require_valid(const PlacedBlocks& placed, const std::string& what, const std::string& remedy) {
  if (placed.untangle.after.inverted == 0) return;
  throw Error(
      ErrorKind::gate,
      fmt::format("{}: {} of {} blocks stay inverted, the first at {}", what, placed.untangle.after.inverted,
                  placed.blocks.complex.hexes.size(), place(placed.untangle.inverted.front().centre)),
      remedy);
}

}  // namespace

std::vector<Index> BlockSource::fit_vertices(const SurfaceLevel& cut, const SurfaceLevel&) const {
  std::vector<Index> same(cut.vertex_count());
  for (std::size_t v = 0; v < same.size(); ++v) same[v] = static_cast<Index>(v);
  return same;
}

std::unique_ptr<BlockSource> shell_source(Cage cage, const Cage* outer, const FarField& farfield,
                                          const Box3& body) {
  return std::make_unique<ShellSource>(std::move(cage), outer, farfield, body);
}

std::unique_ptr<BlockSource> swept_source(const TargetSurface& target, const SweptSettings& settings,
                                          const std::string& name) {
  return std::make_unique<SweptSource>(make_swept_blocks(target, settings, name));
}

std::unique_ptr<BlockSource> ambient_source(const TargetSurface& target, const AmbientSettings& settings,
                                            const std::string& name, Progress& progress) {
  PlacedBlocks placed = place_blocks(make_ambient_blocks(target, settings, progress), target, progress);
  const AmbientReport& report = placed.blocks.report;
  if (!report.findings.empty()) {
    std::string all;
    for (const AmbientFinding& f : report.findings)
      all += (all.empty() ? "" : "\n  ") + f.check + ": " + f.what;
    throw Error(
        ErrorKind::gate, fmt::format("{}: automatic blocks lose features of the CAD: {}", name, all),
        "draw a cage (docs/cages.md), or start from the proposal that `flowcage cage --force` writes");
  }
  require_valid(placed, name + ": automatic blocks",
                "give another --cage-size, or draw a cage (docs/cages.md)");
  return std::make_unique<PlacedSource>(std::move(placed.blocks), "ambient", name);
}

std::unique_ptr<BlockSource> drawn_source(const HexView& mesh, const TargetSurface& target, bool internal,
                                          const std::string& name, Progress& progress) {
  DrawnBlocks drawn = sort_out_blocks(mesh, internal, name);
  AmbientBlocks blocks;
  PrepareSettings prepare;
  prepare.new_faces = false;  // the blocks have these
  blocks.cage = prepare_cage(drawn.wall.cage, target, prepare, progress).cage;
  assemble_blocks(std::move(drawn.draft), std::move(drawn.patches), std::move(drawn.sharp), blocks,
                  drawn.wall);
  PlacedBlocks placed = place_blocks(std::move(blocks), target, progress);
  require_valid(placed, name,
                "move the blocks' walls nearer to the CAD, and their lines to where its edges are");
  return std::make_unique<PlacedSource>(std::move(placed.blocks), "file", name);
}

}  // namespace flowcage
