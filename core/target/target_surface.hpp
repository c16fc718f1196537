#pragma once
#include <array>
#include <span>
#include <string>
#include <vector>

#include "core/base/types.hpp"

namespace flowcage {

/// Whether a projection found its foot point.
enum class FootStatus : std::uint8_t {
  failed,    ///< nothing found (a ray that misses, no compatible normal)
  interior,  ///< inside a trimmed face: the residual is along the normal
  boundary,  ///< on a trimming curve or vertex: the nearest point, but not a perpendicular foot
};

/// A point on the target and how it was found; also the hint for the next query of the same sample.
struct SurfacePoint {
  Vec3 position = Vec3::Zero();
  Vec3 normal = Vec3::Zero();  ///< unit, on the fluid's side of a body (the face's orientation in the CAD)
  double distance = 0;         ///< from the query
  Index face = no_index;       ///< region of the target
  Vec2 uv = Vec2::Zero();
  FootStatus status = FootStatus::failed;
};

struct Tessellation {
  std::vector<Vec3> points;
  std::vector<std::array<Index, 3>> triangles;  ///< counter-clockwise seen from the face's normal side
  std::vector<Index> triangle_face;             ///< region of each triangle
};

/// What kind of curve a chain is.
enum class ChainKind : std::uint8_t {
  sharp,     ///< the two sides' exact normals differ by more than the crease angle
  boundary,  ///< open: one face only after sewing
};

/// CAD edges merged end to end between feature corners: a smooth run along which the fitted surface has a
/// crease.
struct FeatureChain {
  ChainKind kind = ChainKind::sharp;
  Index start = no_index,
        end = no_index;        ///< into FeatureGraph::corners; both no_index on a closed loop without corner
  double length = 0;           ///< arc length; s runs from start to end in [0, length]
  std::vector<Vec3> polyline;  ///< for pictures and first guesses: closed loops repeat their first point
  std::vector<double> polyline_s;  ///< arc length at each of them, ascending
  std::vector<Index> faces;        ///< regions on both sides along it, sorted, unique
};

struct FeatureGraph {
  std::vector<Vec3> corners;
  std::vector<FeatureChain> chains;
  std::vector<Vec3> tips;  ///< apexes of cones: no chain ends there, but there is no tangent plane either
};

struct CurvePoint {
  Vec3 position = Vec3::Zero();
  Vec3 tangent = Vec3::Zero();  ///< unit, toward growing s
  double s = 0;
  double distance = 0;
};

/// The seam between core and CAD (model: deal.II's Manifold). Lengths in metres. All calls are const,
/// thread-safe, deterministic, and take batches: the implementation decides on threads.
class TargetSurface {
 public:
  virtual ~TargetSurface() = default;

  /// Nearest points of the trimmed faces. `hints` is empty or as long as queries (results of an earlier pass
  /// for the same samples; a hint may speed the search and never changes which point is found beyond
  /// rounding). Precondition: results.size() == queries.size().
  virtual void closest_points(std::span<const Vec3> queries, std::span<const SurfacePoint> hints,
                              std::span<SurfacePoint> results) const = 0;

  /// Nearest point among those whose normal n satisfies n . normals[i] >= min_cosine; `failed` where there is
  /// none within max_distance.
  virtual void closest_compatible(std::span<const Vec3> queries, std::span<const Vec3> normals,
                                  double min_cosine, double max_distance,
                                  std::span<SurfacePoint> results) const = 0;

  /// Nearest intersection, in either direction, of the line through queries[i] along the unit vector
  /// directions[i] with a face of compatible normal (n . directions[i] >= min_cosine), within max_distance;
  /// `failed` where there is none.
  virtual void intersect_lines(std::span<const Vec3> queries, std::span<const Vec3> directions,
                               double min_cosine, double max_distance,
                               std::span<SurfacePoint> results) const = 0;

  virtual const FeatureGraph& features() const = 0;
  /// The exact point of a chain at arc length s (clamped to [0, length]; wrapped on closed loops).
  virtual CurvePoint chain_point(Index chain, double s) const = 0;
  /// The nearest exact point of a chain.
  virtual CurvePoint closest_on_chain(Index chain, const Vec3& query) const = 0;

  virtual const Tessellation& tessellation() const = 0;
  virtual Index face_count() const = 0;
  virtual std::string face_name(Index face) const = 0;  ///< "" where the CAD has none
  virtual Box3 bounds() const = 0;                      ///< of the faces, tight
  double diagonal() const { return bounds().diagonal().norm(); }
};

}  // namespace flowcage
