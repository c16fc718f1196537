#pragma once
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/base/progress.hpp"
#include "core/blocks/farfield.hpp"
#include "core/mesh/block_mesh.hpp"
#include "core/mesh/cage.hpp"
#include "core/quality/quality_report.hpp"
#include "core/refit/fit_surface.hpp"
#include "core/target/target_surface.hpp"

namespace flowcage {

/// Figure 1 of Rom & Brakhage (2011) as code: fit the cage's limit surface to the CAD, connect it to an outer surface,
/// refine the blocks, follow the fitted surface, judge the result. All lengths in metres.

/// A condition that a result must meet; `place` and `detail` say where and how it is missed.
struct Gate {
  std::string name;
  double limit = 0, value = 0;
  bool holds = true;
  Vec3 place = Vec3::Zero();
  std::string detail;
};

/// Per boundary patch of a mesh: what an engineer checks first.
struct PatchSummary {
  std::string name;
  PatchType type = PatchType::wall;
  Index faces = 0;
  double max_deviation = 0, rms_deviation = 0;        ///< mesh points to CAD, relative to the diagonal; walls only
  double min_first_height = 0, max_first_height = 0;  ///< distance of the first point off the wall, metres; walls only
};

struct SurfaceMesh {
  std::vector<Vec3> points;             ///< #V limit points (snapped if asked) of the last level
  std::vector<Vec3> normals;            ///< #V, on the fluid's side
  std::vector<double> deviation;        ///< #V distance to the CAD in metres
  SurfaceLevel topology;
};

struct SurfaceSettings {
  FitSettings fit;
  double tolerance = 1e-4;  ///< gate; relative to the CAD's diagonal
  bool snap = true;
  int sample = 0;           ///< > 0: the fitted limit surface itself, each face split this many times more; no snap
};

struct SurfaceResult {
  SurfaceFit fit;
  SurfaceMesh mesh;
  std::vector<Gate> gates;
};

SurfaceResult make_surface(const Cage& cage, const TargetSurface& target, const SurfaceSettings& settings,
                           Progress& progress);

}  // namespace flowcage
