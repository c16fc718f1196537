#pragma once
#include <memory>
#include <string>
#include <vector>

#include "core/auto_blocks.hpp"
#include "core/blocks/farfield.hpp"
#include "core/blocks/swept_blocks.hpp"
#include "core/optimise/smooth_blocks.hpp"
#include "core/refit/fit_surface.hpp"
#include "core/volume/wall_lines.hpp"

namespace flowcage {

/// Where the blocks of a volume come from, as the pipeline behind it sees it: a cage to fit, blocks that
/// stand on its wall, and what their other boundary does. Two polyhedra or a grown far field (shell), the C-H
/// blocks of a swept body, the ambient grid, a user's block file.
class BlockSource {
 public:
  virtual ~BlockSource() = default;

  virtual std::string name() const = 0;  ///< shell, swept, ambient or file
  virtual const Cage& cage() const = 0;  ///< what refit/fit_surface takes
  virtual const WallBlocks& blocks() const = 0;
  virtual int fit_level() const = 0;  ///< the level of the fit that blocks().wall belongs to
  virtual std::vector<std::string> warnings() const { return {}; }

  /// Cells when the fit ends at a level, before boundary layers, and what lines off the wall have then.
  struct Size {
    double cells = 0;
    Index line_cells = 1;
    TypicalLine line;
  };
  virtual Size size_at(int last) const = 0;

  /// The block mesh at the fit's level fit_level(), with as many cells as refinement to level `last` needs.
  virtual BlockMesh start(const SurfaceFit& fit, int last) const = 0;
  /// Called once after the first refinement, when the wall is in its place.
  virtual void spread(BlockMesh&, int /*level*/, int /*last*/) const {}
  /// Vertex of a level of the fit for each vertex of `cut`, blocks().wall refined to that level.
  virtual std::vector<Index> fit_vertices(const SurfaceLevel& cut, const SurfaceLevel& level) const;
  /// Mends places of a level's vertices before they are carried to the wall.
  virtual void straighten(const SurfaceLevel&, const SurfaceLevel&, std::span<Vec3>) const {}
  /// Puts the rest of the boundary where it belongs after `refinements`; `last`: the final places.
  virtual void place_outer(BlockMesh&, const SurfaceLevel&, int /*refinements*/, bool /*last*/) const {}
  virtual BoundaryFreedom freedom(const BlockMesh& mesh) const = 0;
  /// Meshes up to this size are shaped as a whole; finer ones inherit that and are mended where need be.
  virtual Offset whole_mesh_cells() const { return 30000; }
  /// Whether start() wants shaping before any refinement.
  virtual bool shape_start() const { return false; }
  /// Refuses a fit that the blocks cannot stand on. Throws Error(input).
  virtual void check(const SurfaceFit&, const TargetSurface&) const {}
};

/// Blocks between a cage and an outer polyhedron, or a far field that grows from the cage where `outer` is
/// null. Throws as build_shell and build_farfield_shell do.
std::unique_ptr<BlockSource> shell_source(Cage cage, const Cage* outer, const FarField& farfield,
                                          const Box3& body);
/// Throws as make_swept_blocks does.
std::unique_ptr<BlockSource> swept_source(const TargetSurface& target, const SweptSettings& settings,
                                          const std::string& name);
/// Throws as make_ambient_blocks does, and Error(gate) where blocks stay inverted or a feature is lost.
std::unique_ptr<BlockSource> ambient_source(const TargetSurface& target, const AmbientSettings& settings,
                                            const std::string& name, Progress& progress);

/// A user's hex blocks, one a cell of `mesh`, in metres; their walls are fitted to the CAD
/// (blocks/drawn_blocks, refit/prepare_cage). Throws as these do, and Error(gate) where blocks stay inverted
/// when their walls lie on the CAD.
std::unique_ptr<BlockSource> drawn_source(const HexView& mesh, const TargetSurface& target, bool internal,
                                          const std::string& name, Progress& progress);

}  // namespace flowcage
