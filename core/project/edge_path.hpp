#pragma once
#include <memory>
#include <span>
#include <vector>

#include "core/mesh/surface_level.hpp"
#include "core/target/target_surface.hpp"

namespace flowcage {

/// A run along the target's features that one path of cage edges is to follow, sampled evenly in arc length.
struct ChainRun {
  std::vector<Vec3> samples;  ///< N + 1; on a closed loop the last repeats the first
  double length = 0;
  bool closed = false;  ///< a loop without corner
  ChainKind kind = ChainKind::sharp;
  Index start = no_index, end = no_index;  ///< the target's corners at its ends; equal: a loop through one
  std::vector<Index> chains;               ///< the target's, in the run's order
};

struct EdgePath {
  bool found = false;
  std::vector<Index> vertices;  ///< in order; a loop repeats its first
  std::vector<Index> edges;     ///< #vertices - 1
  double effort = 0;            ///< what the search made smallest, in cubed lengths
  double cost = 0;  ///< root mean square distance from the run in mean edge lengths of the path (of one edge
                    ///< or a short path: of the edges at its ends, as at the base of a blunt trailing edge)
};

/// What a path may not use. Its own end vertices are always free.
struct EdgePathBlocks {
  std::vector<bool> vertex;  ///< #V
  std::vector<bool> edge;    ///< #E
};

/// A cage as the search sees it.
struct CageShape {
  const SurfaceLevel& level;
  std::span<const Vec3> points;
  std::vector<double> scales;    ///< #V, the mean length of each vertex's edges
  std::vector<double> flatness;  ///< #E, how little speaks for a crease, in [0, 1]: half of it whether the
                                 ///< faces at the edge lie on one face of the target, half (1 + cosine
                                 ///< between their normals) / 2; 0 on the boundary
};
CageShape cage_shape(const SurfaceLevel& level, std::span<const Vec3> points, const TargetSurface& target);

/// Finds paths of edges of a cage that follow one run: map matching with the roles of network and trace
/// exchanged. The states are pairs (vertex, sample), an edge leads from one to another further along the run,
/// and dynamic programming finds the path of least
///   sum over edges of  ds * mean |edge - run|^2  +  0.1 |edge| (|edge| - ds)^2
///     +  (0.002 + 0.1 flatness) |edge|^3,
/// ds the run's length that an edge covers. The first term does not depend on how many edges a path has; the
/// others keep it from going sideways, and on edges where the cage itself turns (the rim of a thin tip is no
/// farther from the vertices inside than a rough drawing is from the rim). Vertices farther from the run than
/// 0.75 of their mean edge length take no part.
class EdgePathSearch {
 public:
  /// Both arguments must outlive the search.
  EdgePathSearch(const CageShape& cage, const ChainRun& run);
  ~EdgePathSearch();
  EdgePathSearch(EdgePathSearch&&) noexcept;

  /// The best path from one vertex to another (equal for a loop through a corner); of a closed run both are
  /// no_index and the path starts where a vertex lies nearest.
  EdgePath find(Index first, Index last, const EdgePathBlocks& blocks) const;

 private:
  struct Table;
  struct Ends {
    Index first, first_sample, last;
  };
  using Windows = std::vector<std::pair<Index, Index>>;  // per vertex: steps of the path that it may be at
  EdgePath find_from(const Ends& ends, const EdgePathBlocks& blocks, Windows windows, int splits) const;

  std::unique_ptr<const Table> table_;
};

}  // namespace flowcage
