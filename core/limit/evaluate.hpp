#pragma once
#include <memory>
#include <span>
#include <vector>

#include "core/mesh/stencil_table.hpp"
#include "core/mesh/surface_level.hpp"

namespace flowcage {

/// A place on the limit surface: face of the level and (u,v) in [0,1]^2 with (0,0) at corner 0, (1,0) at
/// corner 1, (1,1) at corner 2. On a face that is no quad: `corner` names the child quad, (0,0) at that
/// corner and (1,1) at the face's midpoint; ignored on quads.
struct LimitLocation {
  Index face = 0;
  double u = 0, v = 0;
  Index corner = 0;
};

struct LimitPoint {
  Vec3 position, du, dv;  ///< du and dv by the location's parameters; du x dv is on the fluid's side
};

/// Limit points as combinations of the level's vertices: one row a location in each table. Position rows sum
/// to 1 and have no negative weight; the others sum to 0.
struct EvaluationStencils {
  StencilTable position, du, dv;
};

/// Exact evaluation of the limit surface anywhere (Stam 1998), infinitely sharp creases, corners, darts and
/// boundaries included, by the eigenstructure of the local subdivision matrix (corner_patch.hpp); semi-sharp
/// creases by refining until they have decayed. du and dv are true derivatives, except at an irregular vertex
/// itself (extraordinary, dart, corner of several faces, crease with other than two faces in the sector):
/// there they are the limit tangents of limit_masks.hpp, whose lengths mean nothing.
///
/// Child levels of quads are used as they are; of other levels one finer level is built (two if the level has
/// n-gons): about 1 kB a vertex.
class LimitEvaluator {
 public:
  explicit LimitEvaluator(SurfaceLevel level);
  ~LimitEvaluator();
  LimitEvaluator(LimitEvaluator&&) noexcept;
  LimitEvaluator& operator=(LimitEvaluator&&) noexcept;

  /// Any thread. u and v outside of [0,1] are moved to its ends (NaN to 0). Preconditions: points.size() ==
  /// level.vertex_count(); location.face (and corner, on n-gons) in range.
  LimitPoint evaluate(std::span<const Vec3> points, const LimitLocation& at) const;

  /// `evaluate` as rows; parallel over the locations.
  friend EvaluationStencils evaluation_stencils(const LimitEvaluator& evaluator,
                                                std::span<const LimitLocation> locations);

 private:
  struct Tables;
  std::unique_ptr<const Tables> tables_;
};
EvaluationStencils evaluation_stencils(const LimitEvaluator& evaluator,
                                       std::span<const LimitLocation> locations);

/// The limit surface as a fine quad mesh: every face of the level split `splits` times, every vertex a limit
/// point with its unit normal (on the fluid's side; at a crease that of the vertex's first sector; zero where
/// the tangents are parallel). Watertight where the level is; patches are inherited; topology.edge_sharpness
/// tells which edges are creases. With splits = 0 the level's own faces, which may be any polygons.
struct SampledSurface {
  SurfaceLevel topology;
  std::vector<Vec3> points, normals;  ///< #V of the topology
};
/// Preconditions: points.size() == level.vertex_count(), splits >= 0.
SampledSurface sample_limit_surface(const SurfaceLevel& level, std::span<const Vec3> points, int splits);

}  // namespace flowcage
