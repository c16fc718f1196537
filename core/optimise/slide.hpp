#pragma once
#include "core/optimise/hex_patch.hpp"

namespace flowcage {

/// Where the moving points of a patch may slide. Positions are in units of `unit` metres.
struct SlideContext {
  const HexPatch& patch;
  std::span<const Projector> projectors;
  double unit = 1;
};

/// True when a moving point slides on a projector.
bool has_projected_points(const HexPatch& patch);

/// Orthogonal projections onto the directions in which each moving point (#M) can go: the identity, without
/// the frozen axes, and without what its surface's normal or its curve's normal plane takes away. The latter
/// from the projector alone: its derivative on the surface is the projection onto the tangent space, whose
/// eigenvalues are 0 or 1; differences over `steps` (#M, a small part of the local cell size) give it.
std::vector<Eigen::Matrix3d> tangent_projections(const SlideContext& context, std::span<const Vec3> positions,
                                                 std::span<const double> steps);

/// Puts the points that slide back on their curves and surfaces; frozen coordinates come from `reference`.
void project_points(const SlideContext& context, std::span<const Vec3> reference, std::span<Vec3> positions);

}  // namespace flowcage
