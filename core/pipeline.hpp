#pragma once
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/base/progress.hpp"
#include "core/block_source.hpp"
#include "core/grade/boundary_layers.hpp"
#include "core/mesh/block_mesh.hpp"
#include "core/mesh/cage.hpp"
#include "core/optimise/hex_validity.hpp"
#include "core/prediction.hpp"
#include "core/quality/quality_report.hpp"
#include "core/quality/topology_bound.hpp"
#include "core/refit/fit_surface.hpp"
#include "core/target/target_surface.hpp"
#include "core/volume/wall_normals.hpp"

namespace flowcage {

/// Figure 1 of Rom & Brakhage (2011) as code: fit the cage's limit surface to the CAD, connect it to an outer
/// surface, refine the blocks in 3-D, follow the fitted surface, judge the result. Lengths in metres,
/// deviations relative to the CAD's bounding-box diagonal. A result that misses a gate is returned: the
/// caller decides what to do with it. Throws Error(input) for a cage or an outer surface that cannot be used,
/// Error(interrupted) by `progress`.

/// A condition that a result must meet; `detail` says where and by how much it is missed.
struct Gate {
  std::string name;
  double limit = 0, value = 0;
  bool holds = true;
  std::string detail;
  std::optional<Vec3> place{};  ///< where the value is worst, if that is one place; also where it holds
};

struct SurfaceSettings {
  FitSettings fit;
  double tolerance = 1e-4;  ///< gate: largest deviation
  bool snap = true;         ///< put the vertices of the last level exactly on the CAD
  int sample = 0;  ///< > 0: the fitted limit surface itself, each face split this many times more; no snap
};

struct SurfaceResult {
  SurfaceFit fit;
  Cage mesh;                      ///< limit points of the last level (or of its samples), with patches
  std::vector<double> deviation;  ///< #V, of the fitted surface (before any snap) from the CAD, metres
  std::vector<Gate> gates;
};

SurfaceResult make_surface(const Cage& cage, const TargetSurface& target, const SurfaceSettings& settings,
                           Progress& progress);

struct VolumeSettings {
  FitSettings fit;
  double tolerance = 1e-4;
  bool snap = true;
  LayerSettings layers;  ///< first height 0: cells at the wall as high as they are wide
  std::function<void(const Prediction&)> predicted;  ///< called before the work; what it throws ends it
  int family = 1;    ///< nested meshes to make: this one and coarser ones of every second point
  Offset cells = 0;  ///< > 0: refine to the level nearest to so many cells, whatever fit.levels says
};

/// What an engineer looks at first, per boundary patch.
struct PatchSummary {
  std::string name;
  PatchType type = PatchType::wall;
  Index faces = 0;
  double max_deviation = 0, rms_deviation = 0;        ///< walls: of the fitted surface at the mesh's points
  double min_first_height = 0, max_first_height = 0;  ///< walls: first point off the wall, metres
};

/// A coarser mesh of a nested family. Its patches are those of the finest.
struct FamilyMember {
  BlockMesh mesh;
  QualityReport quality;
  CellProof validity;
  std::vector<double> deviation;  ///< #points, as VolumeResult's
};

struct VolumeResult {
  SurfaceFit fit;
  BlockMesh mesh;
  QualityReport quality;
  CellProof validity;  ///< of the whole mesh, its cells' insides included
  TopologyBound bound;
  LayerReport layers;  ///< where a first height was asked for
  NormalReport normals;
  std::vector<double>
      deviation;  ///< #points; of the fitted surface from the CAD at wall points, metres, else 0
  std::vector<PatchSummary> patches;
  std::vector<FamilyMember> coarser;  ///< VolumeSettings.family - 1, the finest of them first
  std::vector<Gate> gates;            ///< of the coarser meshes, too
  double fit_seconds = 0, volume_seconds = 0;
};

VolumeResult make_volume(const BlockSource& source, const TargetSurface& target,
                         const VolumeSettings& settings, Progress& progress);

/// True when all hold.
bool all_hold(const std::vector<Gate>& gates);

}  // namespace flowcage
