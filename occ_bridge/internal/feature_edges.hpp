#pragma once
#include <span>
#include <string>
#include <vector>

#include "core/target/target_surface.hpp"
#include "occ_bridge/internal/face_edges.hpp"

namespace flowcage::occ {

/// A run of an edge that is a feature: [t0, t1] of the edge's parameter.
struct FeatureRun {
  Index edge = no_index;
  ChainKind kind = ChainKind::sharp;
  double t0 = 0, t1 = 0;
  bool whole_start = true, whole_end = true;  ///< the run reaches the edge's first / last vertex
};

struct FeatureEdges {
  std::vector<FeatureRun> runs;  ///< in the order of the edges
  Index sharp_edges = 0;         ///< edges with at least one sharp run
  Index partly_sharp_edges = 0;  ///< those that are sharp on a part of their length only
  Index crowded_edges = 0;       ///< of more than two faces
};

/// Which edges are features. An edge of one face is a boundary; an edge of two faces (or a seam) is sharp
/// where the exact outward normals of both, taken through the edge's curve in each face's parameters, differ
/// by more than `crease_angle` radians; an edge of more faces is sharp. Tessellations are not asked: they
/// show 12 to 20 degrees on a smooth leading edge.
///
/// The angle is sampled at 17 points an edge. Sharp at all: the edge. At none: no feature. In between: the
/// edge stays whole where its smallest angle is above half the crease angle; otherwise it is cut where the
/// angle passes the crease angle (bisection to 1e-6 of the parameter range), and runs or gaps of a single
/// sample join their surroundings. An edge between two different openings (#faces: an inlet's or outlet's
/// name, "" of walls), or an opening and a wall, is a feature whatever its angle: a patch ends there.
FeatureEdges find_feature_edges(const FaceEdges& topology, double crease_angle,
                                std::span<const std::string> openings, std::vector<std::string>& warnings);

}  // namespace flowcage::occ
