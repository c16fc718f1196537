#include "core/project/crease_chains.hpp"

#include <algorithm>
#include <cassert>

namespace flowcage {
namespace {

bool is_sharp(const SurfaceLevel& level, Index e) {
  return level.edge_sharpness[e] >= infinitely_sharp;
}

Index other_end(const SurfaceLevel& level, Index e, Index v) {
  const auto& ends = level.edge_vertices[e];
  return ends[0] == v ? ends[1] : ends[0];
}

/// The sharp edge that goes on from e at v, or no_index at an end.
Index next_edge(const SurfaceLevel& level, const std::vector<bool>& is_end, Index v, Index e) {
  if (is_end[v]) return no_index;
  for (const Index next : level.vertex_edges[v]) {
    if (next == e || !is_sharp(level, next)) continue;
    return level.is_boundary_edge(next) == level.is_boundary_edge(e) ? next : no_index;
  }
  return no_index;
}

Index edge_between(const SurfaceLevel& level, Index a, Index b) {
  for (const Index e : level.vertex_edges[a]) {
    if (other_end(level, e, a) == b) return e;
  }
  return no_index;
}

}  // namespace

std::vector<Index> sharp_edge_counts(const SurfaceLevel& level) {
  std::vector<Index> counts(static_cast<std::size_t>(level.vertex_count()), 0);
  for (Index e = 0; e < level.edge_count(); ++e) {
    if (!is_sharp(level, e)) continue;
    for (const Index v : level.edge_vertices[e]) ++counts[v];
  }
  return counts;
}

std::vector<bool> crease_ends(const SurfaceLevel& level) {
  const std::vector<Index> counts = sharp_edge_counts(level);
  std::vector<bool> ends(counts.size());
  for (std::size_t v = 0; v < counts.size(); ++v) {
    ends[v] = level.vertex_sharpness[v] >= infinitely_sharp || (counts[v] != 0 && counts[v] != 2);
  }
  return ends;
}

std::vector<CreaseChain> crease_chains(const SurfaceLevel& level) {
  const std::vector<bool> is_end = crease_ends(level);
  std::vector<bool> used(static_cast<std::size_t>(level.edge_count()), false);
  std::vector<CreaseChain> chains;
  for (Index seed = 0; seed < level.edge_count(); ++seed) {
    if (used[seed] || !is_sharp(level, seed)) continue;
    // Back to where the chain begins (or round the loop), then forward.
    Index edge = seed;
    Index vertex = level.edge_vertices[seed][0];
    bool closed = false;
    for (Index back = next_edge(level, is_end, vertex, edge); back != no_index;
         back = next_edge(level, is_end, vertex, edge)) {
      if (back == seed) {
        closed = true;
        break;
      }
      edge = back;
      vertex = other_end(level, edge, vertex);
    }
    CreaseChain chain;
    chain.boundary = level.is_boundary_edge(seed);
    chain.closed = closed;
    if (closed) {
      edge = seed;
      vertex = level.edge_vertices[seed][0];
    }
    chain.vertices.push_back(vertex);
    while (edge != no_index && !used[edge]) {
      used[edge] = true;
      chain.edges.push_back(edge);
      vertex = other_end(level, edge, vertex);
      chain.vertices.push_back(vertex);
      edge = next_edge(level, is_end, vertex, edge);
    }
    if (closed) chain.vertices.pop_back();
    chains.push_back(std::move(chain));
  }
  return chains;
}

CreaseChain child_chain(const CreaseChain& chain, const SurfaceLevel& parent, const SurfaceLevel& child) {
  CreaseChain result;
  result.closed = chain.closed;
  result.boundary = chain.boundary;
  for (Index i = 0; i < chain.segment_count(); ++i) {
    result.vertices.push_back(chain.vertices[i]);
    result.vertices.push_back(parent.vertex_count() + chain.edges[i]);
  }
  if (!chain.closed) result.vertices.push_back(chain.vertices.back());
  for (Index i = 0; i < 2 * chain.segment_count(); ++i) {
    result.edges.push_back(edge_between(child, result.vertex(i), result.vertex(i + 1)));
    assert(result.edges.back() != no_index);
  }
  return result;
}

}  // namespace flowcage
