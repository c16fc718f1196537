#include "core/project/strips.hpp"

#include <algorithm>

namespace flowcage {
namespace {

struct ChainSegment {
  Index chain = no_index, segment = 0;
};

/// The edge on a quad's other side; no_index if the face is no quad.
Index edge_across(const SurfaceLevel& level, Index face, Index edge) {
  const auto edges = level.face_edges[face];
  if (edges.size() != 4) return no_index;
  const auto side = std::find(edges.begin(), edges.end(), edge) - edges.begin();
  return edges[(side + 2) % 4];
}

/// Whether the face's boundary, counter-clockwise, runs along a chain's segment from its first vertex on.
bool runs_along(const SurfaceLevel& level, Index face, const CreaseChain& chain, Index segment) {
  const auto edges = level.face_edges[face];
  const auto side = std::find(edges.begin(), edges.end(), chain.edges[segment]) - edges.begin();
  return level.face_vertices[face][side] == chain.vertex(segment);
}

}  // namespace

std::vector<OppositeSegments> opposite_segments(const SurfaceLevel& level,
                                                std::span<const CreaseChain> chains) {
  constexpr int widest = 5;
  std::vector<ChainSegment> on_edge(static_cast<std::size_t>(level.edge_count()));
  for (std::size_t c = 0; c < chains.size(); ++c) {
    for (std::size_t i = 0; i < chains[c].edges.size(); ++i) {
      on_edge[chains[c].edges[i]] = {static_cast<Index>(c), static_cast<Index>(i)};
    }
  }
  std::vector<OppositeSegments> pairs;
  for (Index start = 0; start < level.edge_count(); ++start) {
    if (on_edge[start].chain == no_index) continue;
    for (const Index first : level.edge_faces[start]) {
      Index edge = start, face = first;
      for (int width = 0; width < widest && face != no_index; ++width) {
        edge = edge_across(level, face, edge);
        if (edge == no_index) break;
        const ChainSegment a = on_edge[start], b = on_edge[edge];
        if (b.chain != no_index) {
          if (start < edge) {
            const bool against = runs_along(level, first, chains[a.chain], a.segment) ==
                                 runs_along(level, face, chains[b.chain], b.segment);
            pairs.push_back({a.chain, a.segment, b.chain, b.segment, against});
          }
          break;
        }
        const auto& faces = level.edge_faces[edge];
        face = faces[0] == face ? faces[1] : faces[0];
      }
    }
  }
  return pairs;
}

}  // namespace flowcage
