#pragma once
#include <optional>
#include <span>
#include <string>

#include "core/mesh/surface_level.hpp"

namespace flowcage {

/// The plane that cuts a half model; the body lies where normal . x >= offset.
struct SymmetryPlane {
  Vec3 normal = Vec3::UnitY();
  double offset = 0;
  int axis = no_index;  ///< 0, 1, 2 when the normal is +-x, y or z; then points in the plane are exact

  double distance(const Vec3& p) const { return normal.dot(p) - offset; }
  /// Moves p into the plane: its coordinate exactly, when the plane has an axis.
  void flatten(Vec3& p) const {
    if (axis != no_index) {
      p[axis] = normal[axis] * offset;
    } else {
      p -= distance(p) * normal;
    }
  }
  Vec3 mirrored(const Vec3& p) const { return p - 2 * distance(p) * normal; }
};

/// The plane of all boundary loops of an open polyhedron; none when it is closed. Planar means within
/// 1e-4 of its bounding-box diagonal; a normal within 1e-4 of an axis is that axis, a coordinate within
/// 1e-9 diagonals of 0 is 0. Throws Error(input), naming `source` and the worst place, when the loops are
/// not planar or vertices lie on both sides.
std::optional<SymmetryPlane> find_symmetry_plane(const SurfaceLevel& level, std::span<const Vec3> points,
                                                 const std::string& source);

/// Numbers of the boundary's vertices, ascending.
std::vector<Index> boundary_vertices(const SurfaceLevel& level);

}  // namespace flowcage
