#pragma once
#include <span>
#include <vector>

#include "core/project/feature_match.hpp"

namespace flowcage {

/// An open edge chain of the cage whose target lies in a plane of constant x, y or z.
struct ChainPlane {
  Index chain = no_index;  ///< into the crease chains
  int axis = 0;            ///< 0 x, 1 y, 2 z
  double value = 0;
};

/// The boundary chains that follow the target in an axis plane (a symmetry plane, a waterline) within 1e-7 of
/// the target's diagonal; values that small themselves are taken as 0.
std::vector<ChainPlane> chain_planes(std::span<const CreaseChain> chains, const FeatureMatch& match,
                                     const TargetSurface& target);

/// Puts the chains' control vertices into their planes to the last bit. `chains` are those of the level that
/// control_points belong to, in the same order as above.
void impose_planes(std::span<const ChainPlane> planes, std::span<const CreaseChain> chains,
                   std::span<Vec3> control_points);

}  // namespace flowcage
