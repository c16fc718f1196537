#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "core/base/types.hpp"

namespace flowcage {

/// Planes of constant x, y or z at which a surface is mirrored, at most one of each.
struct MirrorPlanes {
  std::array<bool, 3> on{};   ///< by axis
  Vec3 value = Vec3::Zero();  ///< where on; 0 elsewhere

  bool any() const { return on[0] || on[1] || on[2]; }
};
/// Both. Precondition: they agree where both have a plane.
MirrorPlanes unite(const MirrorPlanes& a, const MirrorPlanes& b);

/// Sets the coordinates of the axes whose bits are set.
void put_into_planes(unsigned axes, const Vec3& values, Vec3& point);

/// How combinations of points and of their mirror images are written in the points alone ("folded"). An image
/// has its original's coordinates but 2 value - x for each axis it is reflected on. Hence, x measured from
/// the planes, an image's weight counts for its original with the same sign or, on those axes, with the
/// opposite one, and what lies in a plane has the coordinate 0 there whatever its weight.
struct MirrorFold {
  MirrorPlanes planes;
  std::vector<std::uint8_t> in_planes;  ///< #V; bit a: the vertex lies in the plane of axis a
  std::vector<Index> original;          ///< #images, which are numbered from #V
  std::vector<std::uint8_t> reflected;  ///< #images; bit a: reflected on axis a

  Index vertex_count() const { return static_cast<Index>(in_planes.size()); }
  Index original_of(Index v) const { return v < vertex_count() ? v : original[v - vertex_count()]; }
  /// By axis: 1, -1 where reflected, 0 in the plane.
  Vec3 factors(Index v) const;
};

}  // namespace flowcage
