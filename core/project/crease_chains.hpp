#pragma once
#include <span>
#include <vector>

#include "core/mesh/surface_level.hpp"

namespace flowcage {

/// Infinitely sharp edges of a level joined end to end: a run along which the limit surface has a crease, a
/// uniform cubic B-spline curve of its own vertices. It ends at corners (tagged, or with other than two sharp
/// edges); a dart is an end with one sharp edge where the surface is smooth.
struct CreaseChain {
  std::vector<Index> vertices;  ///< in order; a closed loop without corner does not repeat its first
  std::vector<Index> edges;     ///< edge i joins vertices i and i+1 (cyclic on closed loops)
  bool closed = false;          ///< a loop without corner; a loop through one corner is open with equal ends
  bool boundary = false;        ///< open edges of the cage, not creases between two faces

  Index segment_count() const { return static_cast<Index>(edges.size()); }
  /// Vertex i; i may be segment_count() on a closed loop.
  Index vertex(Index i) const { return vertices[static_cast<std::size_t>(i) % vertices.size()]; }
};

/// How many infinitely sharp edges meet at each vertex.
std::vector<Index> sharp_edge_counts(const SurfaceLevel& level);

/// True where a crease may end or turn: infinitely sharp vertices and those with other than 0 or 2 sharp
/// edges.
std::vector<bool> crease_ends(const SurfaceLevel& level);

/// All chains of a level; chains of boundary edges and of creases are kept apart. Ordered by their smallest
/// edge.
std::vector<CreaseChain> crease_chains(const SurfaceLevel& level);

/// The same chain one level down: vertices v0 e01 v1 e12 ..., so segment i becomes segments 2i and 2i+1.
CreaseChain child_chain(const CreaseChain& chain, const SurfaceLevel& parent, const SurfaceLevel& child);

}  // namespace flowcage
