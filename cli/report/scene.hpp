#pragma once
#include <array>
#include <span>
#include <string>
#include <vector>

#include "cli/report/color_map.hpp"
#include "core/pipeline.hpp"

namespace flowcage {

/// What a report and its pictures show of a result, as plain data: surfaces with their fields, lines, cells.
/// Lengths in metres, deviations in the CAD's diagonals. How it is coloured and drawn is others' work.

/// A named part of a surface.
struct SceneName {
  std::string name, type;  ///< type: "CAD", or of a mesh wall, farfield, symmetry, inlet, outlet
  Rgb color;
};

/// Polygons, counter-clockwise seen from the fluid.
struct SceneSurface {
  std::vector<SceneName> names{};
  std::vector<Vec3> points{};
  std::vector<std::array<Index, 4>> faces{};  ///< a triangle repeats its last corner
  std::vector<Index> name{};                  ///< #faces, into names
  std::vector<Index> region{};                ///< #faces, face of the CAD; empty for a mesh
  std::vector<Index> block{};                 ///< #faces; empty for what has no blocks
  std::vector<float> quality{};    ///< #faces, scaled Jacobian of the cell there; empty without cells
  std::vector<float> deviation{};  ///< #points, of the fitted surface from the CAD; empty where unknown
};

/// The cells of a block mesh. Block b has dims[b] cells and (ni+1)(nj+1)(nk+1) entries in `numbers`, the
/// points of its lattice, i fastest; blocks one after the other, cells as BlockMesh numbers them.
struct SceneVolume {
  std::vector<Vec3> points{};
  std::vector<std::array<Index, 3>> dims{};
  std::vector<Index> numbers{};
  std::vector<float> quality{};  ///< #cells, scaled Jacobian
  Index stride = 1;              ///< a cell stands for up to so many of the mesh in each direction
};

/// A cell that is marked: one of the worst of a metric.
struct SceneCell {
  std::string metric;  ///< as in the JSON, "scaled_jacobian"
  std::array<Vec3, 8> corners{};
};

/// A place that somebody should look at, numbered from 1 in the page.
struct SceneMark {
  std::string text;
  Vec3 place;
  Rgb color;
  std::vector<std::vector<Vec3>> lines{};  ///< polylines
};

struct Scene {
  double diagonal = 0;   ///< of the CAD
  double tolerance = 0;  ///< of the fit, in diagonals; 0 without one
  Box3 body{};           ///< of the CAD
  SceneSurface cad{}, mesh{};
  std::vector<std::vector<Vec3>> edges{};  ///< of the CAD: sharp and open ones, polylines
  SceneVolume volume{};                    ///< empty without one
  std::vector<SceneCell> worst{};
  std::vector<SceneMark> marks{};
  Histogram deviation{};  ///< of all wall points of the result: log10 of diagonals; no counts where unknown
  std::vector<std::string> shown{};  ///< a sentence each: what is shown of how much
};

/// A picture of more than this would be a file that no browser opens quickly.
struct SceneLimits {
  Index faces = 150000, triangles = 150000;
  Offset cells = 200000;
};

/// The CAD alone: its tessellation by patch names, and its edges.
Scene cad_scene(const TargetSurface& cad, const SceneLimits& limits = {});
/// With the fitted surface; of one of more faces than the limit a coarser level is shown.
Scene surface_scene(const TargetSurface& cad, const SurfaceResult& result, double tolerance,
                    const SceneLimits& limits = {});
/// With the boundary and the cells of a volume mesh; of larger ones every so-many-th line (thin_blocks), a
/// cell with the least scaled Jacobian of those it covers. Precondition: the mesh still in metres.
Scene volume_scene(const TargetSurface& cad, const VolumeResult& result, double tolerance,
                   const SceneLimits& limits = {});

}  // namespace flowcage
