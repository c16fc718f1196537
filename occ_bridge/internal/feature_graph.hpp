#pragma once
#include <vector>

#include "occ_bridge/internal/chain_curve.hpp"
#include "occ_bridge/internal/feature_edges.hpp"

namespace flowcage::occ {

struct ChainSettings {
  double corner_angle = 0;  ///< radians: feature edges that turn by more at a vertex meet in a corner
  double scale = 1;         ///< metres per length unit of the shape
  double deviation = 0;     ///< of the chains' polylines, in metres
};

struct ChainSet {
  FeatureGraph graph;
  std::vector<ChainCurve> curves;  ///< one a chain
};

/// Joins runs of feature edges end to end. A vertex is a corner unless exactly two run ends of the same kind
/// meet there and their tangents turn by at most the corner angle. An edge whose own curve turns by more at a
/// point inside is cut there. Two ends that nothing else meets join where they lie within the vertices'
/// tolerance (an open boundary that was not sewn).
ChainSet join_feature_runs(const FaceEdges& topology, const std::vector<FeatureRun>& runs,
                           const ChainSettings& settings);

}  // namespace flowcage::occ
