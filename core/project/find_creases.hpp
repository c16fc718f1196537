#pragma once
#include <string>
#include <vector>

#include "core/mesh/cage.hpp"
#include "core/target/target_surface.hpp"

namespace flowcage {

struct CreaseSearchSettings {
  double corner_reach =
      0.5;  ///< farthest vertex for a corner of the target, in the vertex's mean edge lengths
  double detail_reach = 0.2;  ///< the same where another corner of the target lies beside it
  double cost_limit = 0.3;    ///< largest root mean square distance of a path, in its mean edge lengths
  double turn_degrees = 15;   ///< where two chains turn by more, the crease gets a corner
};

struct FoundCreases {
  Cage cage;  ///< with the creases and corners added
  Index crease_edges = 0;
  std::vector<Index> corners;            ///< vertices tagged as corners
  Index sharp_chains = 0, followed = 0;  ///< of the target; how many of them have a path
  std::vector<std::string> warnings;     ///< chains without a path and details left out, with places
};

/// Finds the edges of a cage that lie along the target's sharp edges and makes them infinitely sharp creases.
///
/// The target's corners are given to vertices of the cage first, one to one within a reach; corners closer
/// together than the cage resolves share a vertex, and where just two chains meet in a corner that no vertex
/// is near, they are one run. Then each run between corners (each closed loop) gets the path of edges that
/// follows it best (edge_path.hpp), exclusively: an edge belongs to one run, and paths meet in corners alone.
/// Open boundaries of the target claim open edges of the cage. Where a run finds no path, others are moved
/// out of its way and corners exchanged while that helps. A vertex where a crease ends, turns, or meets other
/// runs that found no path is tagged as a corner; three creases make one by themselves.
///
/// Precondition: the cage is a manifold; creases that it has stay. Throws nothing of its own.
FoundCreases find_creases(const Cage& cage, const TargetSurface& target,
                          const CreaseSearchSettings& settings = {});

}  // namespace flowcage
