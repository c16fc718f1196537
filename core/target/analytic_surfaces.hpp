#pragma once
#include <memory>
#include <vector>

#include "core/target/parametric_patch.hpp"
#include "core/target/target_surface.hpp"

namespace flowcage {

class AnalyticFace;

/// A circle or a straight segment, by arc length.
struct AnalyticCurve {
  Vec3 origin = Vec3::Zero();  ///< the circle's centre, the segment's start
  Vec3 x = Vec3::UnitX();      ///< unit: toward the circle's start; the segment's direction
  Vec3 y = Vec3::UnitY();      ///< unit, circle only: its tangent at the start
  double radius = 0;           ///< 0: a segment
  double length = 0;
};

/// Targets whose answers are known in closed form, without a CAD kernel: for tests, and for cages that
/// approximate a plain shape. Every answer is exact to rounding. A face of these shapes has one local minimum
/// of the distance for each query, so closest_compatible asks each face for its nearest point. A query that
/// is not finite gives `failed`.
class AnalyticSurface final : public TargetSurface {
 public:
  /// Use the functions below. `curves[c]` is the exact curve of graph.chains[c]; their polylines and lengths
  /// are filled in here.
  AnalyticSurface(std::vector<std::unique_ptr<AnalyticFace>> faces, FeatureGraph graph,
                  std::vector<AnalyticCurve> curves);
  ~AnalyticSurface() override;

  void closest_points(std::span<const Vec3> queries, std::span<const SurfacePoint> hints,
                      std::span<SurfacePoint> results) const override;
  void closest_compatible(std::span<const Vec3> queries, std::span<const Vec3> normals, double min_cosine,
                          double max_distance, std::span<SurfacePoint> results) const override;
  void intersect_lines(std::span<const Vec3> queries, std::span<const Vec3> directions, double min_cosine,
                       double max_distance, std::span<SurfacePoint> results) const override;
  const FeatureGraph& features() const override { return graph_; }
  CurvePoint chain_point(Index chain, double s) const override;
  CurvePoint closest_on_chain(Index chain, const Vec3& query) const override;
  const Tessellation& tessellation() const override { return tessellation_; }
  Index face_count() const override { return static_cast<Index>(faces_.size()); }
  std::string face_name(Index face) const override;
  Box3 bounds() const override { return bounds_; }

  /// The face's parametrisation; its domain is the whole face (nothing is trimmed).
  const ParametricPatch& patch(Index face) const;

 private:
  std::vector<std::unique_ptr<AnalyticFace>> faces_;
  std::vector<AnalyticCurve> curves_;
  FeatureGraph graph_;
  Tessellation tessellation_;
  Box3 bounds_;
};

/// Face "sphere", no chain. u is the longitude, v the latitude.
std::unique_ptr<AnalyticSurface> sphere_surface(const Vec3& center, double radius);

/// The half of a sphere on the side of `axis` (unit), without its disc: one open boundary chain, a closed
/// loop.
std::unique_ptr<AnalyticSurface> half_sphere_surface(const Vec3& center, const Vec3& axis, double radius);

struct TorusShape {
  Vec3 center = Vec3::Zero();
  Vec3 axis = Vec3::UnitZ();  ///< unit
  double major_radius = 1;    ///< of the circle that the tube's centre runs along
  double minor_radius = 0.25;
};
std::unique_ptr<AnalyticSurface> torus_surface(const TorusShape& shape);

struct CylinderShape {
  Vec3 base_center = Vec3::Zero();
  Vec3 axis = Vec3::UnitZ();  ///< unit, from the base to the top
  double radius = 1;
  double height = 1;
};
/// Faces "base", "side", "top"; chains 0 (base) and 1 (top), sharp closed loops without corner.
std::unique_ptr<AnalyticSurface> cylinder_surface(const CylinderShape& shape);

/// Faces "x-", "x+", "y-", "y+", "z-", "z+"; 8 corners (number = x + 2 y + 4 z with 0 low, 1 high) and 12
/// sharp chains.
std::unique_ptr<AnalyticSurface> box_surface(const Box3& box);

/// The open parallelogram origin + a, origin + b with normal a x b (a perpendicular to b): 4 corners, 4
/// boundary chains.
std::unique_ptr<AnalyticSurface> sheet_surface(const Vec3& origin, const Vec3& a, const Vec3& b);

}  // namespace flowcage
