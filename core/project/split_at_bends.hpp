#pragma once
#include <span>
#include <vector>

#include "core/mesh/cage.hpp"
#include "core/project/feature_match.hpp"

namespace flowcage {

/// A level whose creases end where their CAD edges turn back within less than a cell.
struct SplitCreases {
  SurfaceLevel topology;
  std::vector<CreaseChain> chains;
  FeatureMatch match;
};

/// Makes the vertices at ChainMatch::kept corners and cuts chains and matches there; all else stays. The rim
/// that ends a thin strip turns back within a thousandth of the edges beside it: a uniform cubic through such
/// vertices overshoots by a share of the long edges and folds the strip, three curves that meet in corners
/// do not. points: #V control points of the level. A warning names each place.
SplitCreases split_at_bends(SurfaceLevel topology, std::span<const Vec3> points,
                            std::vector<CreaseChain> chains, FeatureMatch match, const TargetSurface& target,
                            const FeatureMatchSettings& settings = {});

/// The vertices of a cage that split_at_bends makes corners, ascending.
std::vector<Index> vertices_at_bends(const Cage& cage, const TargetSurface& target);

}  // namespace flowcage
