#pragma once
#include <Eigen/Geometry>
#include <cstdint>

namespace flowcage {

using Vec2 = Eigen::Vector2d;
using Vec3 = Eigen::Vector3d;
using Box3 = Eigen::AlignedBox3d;
using Index = std::int32_t;   ///< numbers of vertices, edges, faces, coarse hexes
using Offset = std::int64_t;  ///< numbers of fine points and cells, positions in CSR arrays

inline constexpr Index no_index = -1;

/// An edge or vertex at least this sharp stays sharp at every level (OpenSubdiv's convention).
inline constexpr double infinitely_sharp = 10.0;

}  // namespace flowcage
