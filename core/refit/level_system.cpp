#include "core/refit/level_system.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/parallel.hpp"
#include "core/refit/symmetric_level.hpp"

namespace flowcage {
namespace {

constexpr Offset grain = 512;

/// Corners without a crease, at tips.
void mark_tips(const FeatureMatch& match, LevelSystem& level) {
  const std::size_t drawn = std::min(match.end_is_fixed.size(), level.vertex_stage.size());
  for (std::size_t v = 0; v < drawn; ++v) {
    if (!match.end_is_fixed[v] || level.vertex_stage[v] != SolveStage::corner) continue;
    level.kind[v] = SampleKind::fixed;
    level.fixed_position[v] = match.end_position[v];
  }
}

void mark_chain_samples(const FeatureMatch& match, LevelSystem& level) {
  for (Index c = 0; c < static_cast<Index>(level.chains.size()); ++c) {
    const CreaseChain& chain = level.chains[c];
    const auto put = [&](Index sample, Index on_chain) {
      level.kind[sample] = match.chains[c].matched ? SampleKind::chain : SampleKind::crease;
      level.sample_chain[sample] = c;
      level.sample_on_chain[sample] = on_chain;
    };
    for (Index i = 0; i < chain.segment_count(); ++i) {
      if (chain.closed || i > 0) put(chain.vertices[i], 2 * i);
      put(level.edge_sample(chain.edges[i]), 2 * i + 1);
    }
    if (chain.closed) continue;
    for (const Index v : {chain.vertices.front(), chain.vertices.back()}) {
      if (v < static_cast<Index>(match.end_is_fixed.size()) && match.end_is_fixed[v]) {
        level.kind[v] = SampleKind::fixed;
        level.fixed_position[v] = match.end_position[v];
      } else {
        level.kind[v] = SampleKind::crease;
      }
    }
  }
}

}  // namespace

ChainPlaces cage_places(const FeatureMatch& match) {
  ChainPlaces places;
  for (const ChainMatch& chain : match.chains) {
    std::vector<double>& list = places.emplace_back();
    if (!chain.matched) continue;
    const std::size_t segments = chain.s.size() - 1;
    for (std::size_t k = 0; k <= 2 * segments; ++k) {
      list.push_back(k % 2 == 0 ? chain.s[k / 2] : parameter_at(chain, 0.5 * static_cast<double>(k)));
    }
  }
  return places;
}

ChainPlaces child_places(const ChainPlaces& places) {
  ChainPlaces result;
  for (const std::vector<double>& above : places) {
    std::vector<double>& list = result.emplace_back();
    for (std::size_t k = 0; k < above.size(); ++k) {
      if (k > 0) list.push_back(0.5 * (above[k - 1] + above[k]));
      list.push_back(above[k]);
    }
  }
  return result;
}

LevelSystem build_level_system(SurfaceLevel topology, std::vector<CreaseChain> chains, ChainPlaces places,
                               const FeatureMatch& match) {
  LevelSystem level;
  level.samples = oversampled_limit_stencils(topology);
  level.topology = std::move(topology);
  level.chains = std::move(chains);
  level.places = std::move(places);
  const std::size_t count = static_cast<std::size_t>(level.sample_count());
  level.kind.assign(count, SampleKind::surface);
  level.sample_chain.assign(count, no_index);
  level.sample_on_chain.assign(count, no_index);
  level.fixed_position.assign(count, Vec3::Zero());

  const std::vector<Index> sharp = whole_sharp_counts(level.topology);
  const Index vertices = level.topology.vertex_count();
  level.vertex_stage.assign(static_cast<std::size_t>(vertices), SolveStage::interior);
  std::vector<SolveStage> row_stage(count, SolveStage::interior);
  for (Index v = 0; v < vertices; ++v) {
    const bool tagged = level.topology.vertex_sharpness[v] >= infinitely_sharp;
    if (tagged || sharp[v] > 2) {
      level.vertex_stage[v] = SolveStage::corner;
      level.kind[v] = SampleKind::crease;
    } else if (sharp[v] == 2) {
      level.vertex_stage[v] = SolveStage::crease;
    }
    row_stage[v] = level.vertex_stage[v];
  }
  for (Index e = 0; e < level.topology.edge_count(); ++e) {
    if (level.topology.edge_sharpness[e] >= infinitely_sharp) {
      row_stage[level.edge_sample(e)] = SolveStage::crease;
    }
  }
  mark_tips(match, level);
  mark_chain_samples(match, level);
  level.mirror_axis.assign(count, -1);
  if (level.topology.mirrors.any()) {
    for (Index e = 0; e < level.topology.edge_count(); ++e) {
      const int axis = level.topology.edge_mirror_axis[e];
      if (axis < 0 || level.topology.edge_sharpness[e] >= infinitely_sharp) continue;
      level.mirror_axis[level.edge_sample(e)] = axis;
      for (const Index v : level.topology.edge_vertices[e]) {
        if (level.vertex_stage[v] == SolveStage::interior) level.mirror_axis[v] = axis;
      }
    }
  }
  level.system = build_hierarchical_system(level.samples.position, level.vertex_stage, row_stage);
  return level;
}

LimitState limit_state(const LevelSystem& level, std::span<const Vec3> control_points) {
  LimitState state;
  state.points = apply_stencils(level.samples.position, control_points);
  state.normals = sample_normals(level.samples, control_points);
  for (std::size_t i = 0; i < state.normals.size(); ++i) {
    Vec3& normal = state.normals[i];
    const double norm = normal.norm();
    const bool has_one = level.kind[i] == SampleKind::surface && norm > 0 && std::isfinite(norm);
    normal = has_one ? Vec3(normal / norm) : Vec3(Vec3::Zero());
  }

  const SurfaceLevel& t = level.topology;
  state.lengths.assign(state.points.size(), 0.0);
  for (Index e = 0; e < t.edge_count(); ++e) {
    const Vec3& middle = state.points[level.edge_sample(e)];
    state.lengths[level.edge_sample(e)] = (state.points[t.edge_vertices[e][0]] - middle).norm() +
                                          (middle - state.points[t.edge_vertices[e][1]]).norm();
  }
  const auto mean_of_edges = [&](std::span<const Index> edges) {
    double sum = 0;
    for (const Index e : edges) sum += state.lengths[level.edge_sample(e)];
    return sum / static_cast<double>(edges.size());
  };
  for (Index v2 = 0; v2 < t.vertex_count(); ++v2) state.lengths[v2] = mean_of_edges(t.vertex_edges[v2]);
  for (Index f = 0; f < t.face_count(); ++f) {
    state.lengths[level.face_sample(f)] = mean_of_edges(t.face_edges[f]);
  }
  return state;
}

std::vector<Index> folded_faces(const LevelSystem& level, const LimitState& state,
                                std::span<const Vec3> target_normals) {
  const SurfaceLevel& t = level.topology;
  std::vector<char> folded(static_cast<std::size_t>(t.face_count()), 0);
  parallel_for(t.face_count(), grain, [&](Offset begin, Offset end) {
    for (Index f = static_cast<Index>(begin); f < static_cast<Index>(end); ++f) {
      const Index middle = level.face_sample(f);
      const Vec3& wanted = target_normals[middle];
      const Vec3& normal = state.normals[middle];
      bool bad = normal.isZero(0) || (!wanted.isZero(0) && normal.dot(wanted) <= 0);
      for (std::size_t i = 0; i < t.face_vertices[f].size() && !bad; ++i) {
        const std::array<Index, 4> at = level.sample_quad(f, i);
        const std::array<Vec3, 4> quad{state.points[at[0]], state.points[at[1]], state.points[at[2]],
                                       state.points[at[3]]};
        const Vec3 across = (quad[2] - quad[0]).cross(quad[3] - quad[1]);
        bad = across.dot(wanted.isZero(0) ? normal : wanted) <= 0;
        for (std::size_t k = 0; k < 4 && !bad; ++k) {
          const Vec3 next = quad[(k + 1) % 4] - quad[k];
          const Vec3 last = quad[(k + 3) % 4] - quad[k];
          bad = next.cross(last).dot(across) < -1e-9 * next.norm() * last.norm() * across.norm();
        }
      }
      folded[f] = bad ? 1 : 0;
    }
  });
  std::vector<Index> result;
  for (Index f = 0; f < t.face_count(); ++f) {
    if (folded[f] != 0) result.push_back(f);
  }
  return result;
}

std::vector<Vec3> tangential_relaxation(const LevelSystem& level, const LimitState& state, double weight) {
  const SurfaceLevel& t = level.topology;
  std::vector<Vec3> moves(state.points.size(), Vec3::Zero());
  for (Index v = 0; v < t.vertex_count(); ++v) {
    const Vec3& n = state.normals[v];
    if (n.isZero(0)) continue;
    Vec3 mean = Vec3::Zero();
    for (const Index e : t.vertex_edges[v]) {
      const Index other = t.edge_vertices[e][0] == v ? t.edge_vertices[e][1] : t.edge_vertices[e][0];
      mean += state.points[other];
    }
    const Vec3 way = mean / static_cast<double>(t.vertex_edges[v].size()) - state.points[v];
    moves[v] = weight * (way - n * n.dot(way));
  }
  for (Index e = 0; e < t.edge_count(); ++e) {
    const Index sample = level.edge_sample(e);
    if (level.kind[sample] != SampleKind::surface) continue;
    moves[sample] = 0.5 * (moves[t.edge_vertices[e][0]] + moves[t.edge_vertices[e][1]]);
  }
  for (Index f = 0; f < t.face_count(); ++f) {
    const auto corners = t.face_vertices[f];
    Vec3 sum = Vec3::Zero();
    for (const Index v : corners) sum += moves[v];
    moves[level.face_sample(f)] = sum / static_cast<double>(corners.size());
  }
  return moves;
}

}  // namespace flowcage
