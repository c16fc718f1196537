#pragma once
#include <span>
#include <vector>

#include "core/mesh/surface_level.hpp"
#include "core/project/crease_chains.hpp"
#include "core/target/target_surface.hpp"

namespace flowcage {

/// Where two edges of the CAD lie closer together than a cage is drawn (both edges of a blunt trailing edge),
/// distances do not tell which one a crease means: the faces on its two sides do.

/// The distinct unit normals of the target's faces that meet at each point: one row a point, in a fixed
/// order. Faces within 1e-4 diagonals count, for gaps, but only 2e-5 farther than the nearest.
Csr<Vec3> normals_at(const TargetSurface& target, std::span<const Vec3> points);

/// A normal of the cage and how much it is to be trusted: slender faces turn with the noise of their
/// vertices.
struct SideNormal {
  Vec3 normal = Vec3::Zero();  ///< unit
  double weight = 0;           ///< 0 .. 1
};

/// Normals of a level's faces (Newell) with weights by slenderness. points: #V.
std::vector<SideNormal> face_normals(const SurfaceLevel& level, std::span<const Vec3> points);

/// How badly the cage's normals round a place disagree with the target's there: 0 within 45 degrees, 1.7
/// where they are opposed. The weighted mean over the cage's of 1 - cosine to the best of the target's, less
/// 0.3.
double normal_mismatch(std::span<const SideNormal> cage, std::span<const Vec3> target);

}  // namespace flowcage
