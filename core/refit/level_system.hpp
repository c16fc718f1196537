#pragma once
#include <array>
#include <span>
#include <vector>

#include "core/limit/limit_stencils.hpp"
#include "core/project/feature_match.hpp"
#include "core/refit/hierarchical_solve.hpp"

namespace flowcage {

/// What a sample of the limit surface has to follow.
enum class SampleKind : std::uint8_t {
  surface,  ///< the target's faces
  crease,   ///< a crease or open edge that matched no feature: the nearest point of any face
  chain,    ///< a matched crease: it lies on the path
  fixed,    ///< a matched corner or dart
};

/// Per chain the path lengths of its samples in order (vertex, midpoint, vertex, ...; on a loop the last is
/// the first plus the path's length): 2 #segments + 1 values, none where the chain matched nothing.
using ChainPlaces = std::vector<std::vector<double>>;

/// The chains' places at level 0.
ChainPlaces cage_places(const FeatureMatch& match);
/// One level down: the samples of the level above stay, those between lie halfway.
ChainPlaces child_places(const ChainPlaces& places);

/// One level of the loop, ready to be solved: the paper's system C V = L with everything that does not change
/// from pass to pass. Sample order: vertices, edges' midpoints, faces' midpoints (LimitSamples).
struct LevelSystem {
  SurfaceLevel topology;
  LimitSamples samples;
  std::vector<CreaseChain> chains;       ///< same order as FeatureMatch::chains
  std::vector<SampleKind> kind;          ///< #samples
  std::vector<Index> sample_chain;       ///< #samples; the chain of `chain` samples
  std::vector<Index> sample_on_chain;    ///< #samples; which of the chain's samples it is, from 0
  ChainPlaces places;                    ///< of the chains' samples, at first
  std::vector<Vec3> fixed_position;      ///< #samples; place of `fixed` samples
  std::vector<int> mirror_axis;          ///< #samples; of `chain` samples where the surface goes on smoothly
                                         ///< into its mirror image: the plane's axis, else -1
  std::vector<SolveStage> vertex_stage;  ///< #V
  HierarchicalSystem system;

  Index sample_count() const { return samples.position.size(); }
  Index edge_sample(Index e) const { return topology.vertex_count() + e; }
  Index face_sample(Index f) const { return topology.vertex_count() + topology.edge_count() + f; }
  /// The samples round corner i of face f: vertex, next edge, face, last edge.
  std::array<Index, 4> sample_quad(Index f, std::size_t i) const {
    const auto edges = topology.face_edges[f];
    return {topology.face_vertices[f][i], edge_sample(edges[i]), face_sample(f),
            edge_sample(edges[(i + edges.size() - 1) % edges.size()])};
  }
};

/// Builds the stencils and sorts everything into stages.
LevelSystem build_level_system(SurfaceLevel topology, std::vector<CreaseChain> chains, ChainPlaces places,
                               const FeatureMatch& match);

/// The limit mesh at the samples: what every pass measures.
struct LimitState {
  std::vector<Vec3> points;     ///< #samples
  std::vector<Vec3> normals;    ///< #samples, unit; zero on creases and corners, where there is no single one
  std::vector<double> lengths;  ///< #samples, local edge length
};
LimitState limit_state(const LevelSystem& level, std::span<const Vec3> control_points);

/// Faces whose limit quads fold: the normal turns against the target's (#samples; zero where unknown), or a
/// corner of one of the quads between vertex, edge and face samples is not convex. Ascending.
std::vector<Index> folded_faces(const LevelSystem& level, const LimitState& state,
                                std::span<const Vec3> target_normals);

/// Displacement of each sample that evens out the cells: `weight` times the way to the mean of a vertex's
/// neighbours along the surface; none on creases, and none across them.
std::vector<Vec3> tangential_relaxation(const LevelSystem& level, const LimitState& state, double weight);

}  // namespace flowcage
