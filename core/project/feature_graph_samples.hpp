#pragma once
#include <vector>

#include "core/project/chain_places.hpp"
#include "core/project/side_normals.hpp"

namespace flowcage {

/// The target's feature chains as a graph of points along them: the target's corners first, then the inner
/// samples chain by chain.
struct SampledFeatures {
  struct Arc {
    Index to = no_index;
    Index piece = no_index;  ///< undirected number of the arc: what exclusivity is kept by
    FeaturePiece along;
    double length = 0;
  };
  std::vector<Vec3> points;
  Csr<Arc> arcs;           ///< per point, the arcs that leave it
  Index corner_count = 0;  ///< points [0, corner_count) are the target's corners
  Index piece_count = 0;
  std::vector<Index> piece_chain;     ///< #pieces
  std::vector<double> piece_length;   ///< #pieces
  std::vector<ChainKind> piece_kind;  ///< #pieces
  Csr<Vec3> normals;                  ///< of the faces at the corners, then at places along each chain
  std::vector<Index> point_normals;   ///< #points; row of normals
};

/// Samples every chain with about `spacing` (at least 16, at most 2048 arcs a chain).
SampledFeatures sample_features(const TargetSurface& target, double spacing);

/// What a cage chain asks of the graph.
struct MatchQuery : DrawnChain {
  std::vector<Vec3> limits;  ///< second places: the crease's own limit points (corners: the same)
  std::vector<std::vector<SideNormal>> sides;  ///< #controls; normals of the cage's faces beside the chain
  double scale = 0;  ///< what distances and stretches are relative to: the mean edge length, or more where
                     ///< the chain is short beside its neighbours (the base of a blunt trailing edge)
  Index first_node = no_index, last_node = no_index;  ///< fixed ends
};

struct MatchedRun {
  bool found = false;
  std::vector<Index> nodes;   ///< #controls
  std::vector<double> s;      ///< #controls, path length at each
  std::vector<Index> pieces;  ///< undirected arcs used
  FeaturePath path;
  double cost = 0;
};

/// Which arcs may be used.
struct GraphFilter {
  bool sharp = true, boundary = true;
  std::vector<bool> used;  ///< #pieces
};

/// The best run for a query (Viterbi); found == false when no run follows it.
MatchedRun find_run(const SampledFeatures& graph, const MatchQuery& query, const GraphFilter& filter);

}  // namespace flowcage
