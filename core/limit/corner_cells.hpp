#pragma once
#include <span>
#include <vector>

#include "core/limit/evaluate.hpp"

namespace flowcage {

/// A quad seen from one of its corners: (a,b) is (0,0) there, (1,0) at the next corner counter-clockwise,
/// (0,1) at the previous one.
struct FaceCorner {
  Index face = 0, corner = 0;
};
/// The limit point and its derivatives by (a,b); see LimitEvaluator::evaluate.
LimitPoint evaluate_at_corner(const LimitEvaluator& evaluator, std::span<const Vec3> points,
                              const FaceCorner& at, const Vec2& ab);

/// A small bicubic spline that stands for the limit surface on [0, size]^2 of a face seen from an irregular
/// corner, where no bicubic can be exact: segments x segments polynomials, C1. It
///   - keeps position and first derivatives of the limit surface where the cell ends inside the face;
///   - begins at the vertex's limit point and, where one exists, in its tangent plane. None exists at a
///   corner
///     (sharp vertex, or three and more creases) with several faces between two creases: the surface comes to
///     it like a cone or a cusp, and cells cannot agree at the tip itself;
///   - shares its boundary curves with the cells beside it; along creases they are exact;
///   - has its last free point by least squares: positions in the cell, and the limit surface's tangent
///   planes
///     along the curves that it shares.
struct CornerCell {
  bool pointed = false;   ///< at a corner without a tangent plane
  int depth = 0;          ///< size = 2^-depth; 0: the corner is regular, there is no cell
  std::vector<Vec3> net;  ///< count x count control points, [count i + j], i along a, j along b

  /// Along each direction: `segments` equal parts, every inner knot double.
  static constexpr int segments = 2, count = 2 * segments + 2;

  double size() const;
  Vec3 position(const Vec2& ab) const;
};

struct CornerCellSettings {
  double max_angle_degrees = 0.03;  ///< between cells of a vertex along their shared curves
  double max_deviation = 0;         ///< of a cell from the limit surface, metres
  int max_depth = 14;
};

/// Cells by corner of each face (positions of face_vertices.values). All cells of a vertex have one size: the
/// largest that holds the settings (a quarter face at most), or the best one tried; max_depth at pointed
/// ones. The surface's bend over the cell falls as (mu / lambda)^depth, lambda and mu being the vertex's
/// second and third eigenvalue, and with it the angle. Preconditions: quads only, no semi-sharp edges or
/// vertices, points.size() == level.vertex_count(), `evaluator` made of the level.
std::vector<CornerCell> fit_corner_cells(const SurfaceLevel& level, const LimitEvaluator& evaluator,
                                         std::span<const Vec3> points, const CornerCellSettings& settings);

/// Distance from p to the limit surface over the face: an upper bound that starts at (a,b) and improves it by
/// Gauss-Newton steps; exact to second order near the surface.
double distance_to_limit(const LimitEvaluator& evaluator, std::span<const Vec3> points, const FaceCorner& at,
                         Vec2 ab, const Vec3& p);

}  // namespace flowcage
