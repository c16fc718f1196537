#pragma once
#include <functional>
#include <span>
#include <vector>

#include "core/mesh/hex_view.hpp"

namespace flowcage {

/// Nearest points of a curve or surface: feet[i] for queries[i], in metres. Feet of points on it are the
/// points themselves to within rounding. Both spans have the same size. Called from one thread.
using Projector = std::function<void(std::span<const Vec3> queries, std::span<Vec3> feet)>;

/// How one point of a mesh may move. The default is free.
struct PointFreedom {
  static constexpr std::uint8_t all_axes = 7;
  std::uint8_t frozen_axes =
      0;                       ///< bit a set: coordinate a keeps its value to the bit; 7: the point is fixed
  Index projector = no_index;  ///< slides on this curve or surface (number in the list given beside it)

  bool moves() const { return frozen_axes != all_axes; }
  bool operator==(const PointFreedom&) const = default;
};

inline constexpr PointFreedom fixed_point{PointFreedom::all_axes, no_index};
/// Slides in a plane across axis 0, 1 or 2: a symmetry plane.
constexpr PointFreedom in_plane(int axis) {
  return {static_cast<std::uint8_t>(1U << static_cast<unsigned>(axis)), no_index};
}
constexpr PointFreedom on_surface(Index projector) {
  return {0, projector};
}

/// Freedom of each point when the points of patch n have per_patch[n] and inner points are free. A point of
/// several patches has all their frozen axes; one that would slide on two different projectors is fixed. An
/// empty list: every boundary point is fixed. Precondition: as many entries as patches, or none.
std::vector<PointFreedom> patch_freedom(const HexView& mesh, std::span<const PointFreedom> per_patch);

}  // namespace flowcage
