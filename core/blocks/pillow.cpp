#include "core/blocks/pillow.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "core/base/error.hpp"

namespace flowcage {
namespace {

using Quad = std::array<Index, 4>;

Quad sorted(Quad q) {
  std::sort(q.begin(), q.end());
  return q;
}

Quad face_of(const HexPoints& hex, int face) {
  Quad q{};
  for (int n = 0; n < 4; ++n) q[n] = hex[hex_faces[face][n]];
  return q;
}

std::array<Index, 2> undirected(Index a, Index b) {
  return {std::min(a, b), std::max(a, b)};
}

/// A hex's use of a quad, sorted so that equal quads are neighbours.
struct Use {
  Quad key;
  Index hex;
  int face;
  auto operator<=>(const Use&) const = default;
};

std::vector<Use> face_uses(const BlockDraft& draft) {
  std::vector<Use> uses;
  uses.reserve(6 * draft.hexes.size());
  for (Index h = 0; h < static_cast<Index>(draft.hexes.size()); ++h) {
    for (int f = 0; f < 6; ++f) uses.push_back({sorted(face_of(draft.hexes[h], f)), h, f});
  }
  std::sort(uses.begin(), uses.end());
  return uses;
}

std::map<Quad, Index> boundary_by_corners(const BlockDraft& draft) {
  std::map<Quad, Index> result;
  for (Index b = 0; b < static_cast<Index>(draft.boundary.size()); ++b) {
    result.emplace(sorted(draft.boundary[b].corners), b);
  }
  return result;
}

using EdgeQuads = std::map<std::array<Index, 2>, Index>;  // directed edge of a boundary quad of the set: it

/// Where a point's copy goes: the mean of the set's hexes there; on boundary that stays, of its quads; where
/// two of its patches meet, along their common edges: so planes and their edges keep their points.
std::vector<Vec3> inner_places(const BlockDraft& draft, const std::vector<char>& in_set,
                               const std::vector<char>& keeps, const EdgeQuads& beside) {
  struct Mean {
    Vec3 sum = Vec3::Zero();
    int count = 0;
    void add(const Vec3& p) {
      sum += p;
      ++count;
    }
  };
  std::vector<Mean> hexes(draft.points.size()), quads(hexes.size()), edges(hexes.size());
  for (std::size_t h = 0; h < draft.hexes.size(); ++h) {
    if (in_set[h] == 0) continue;
    Vec3 centre = Vec3::Zero();
    for (const Index v : draft.hexes[h]) centre += draft.points[v] / 8;
    for (const Index v : draft.hexes[h]) hexes[v].add(centre);
  }
  for (std::size_t b = 0; b < draft.boundary.size(); ++b) {
    if (keeps[b] == 0) continue;
    Vec3 centre = Vec3::Zero();
    for (const Index v : draft.boundary[b].corners) centre += draft.points[v] / 4;
    for (const Index v : draft.boundary[b].corners) quads[v].add(centre);
  }
  for (const auto& [edge, quad] : beside) {
    const auto other = beside.find({edge[1], edge[0]});
    if (other == beside.end() || draft.boundary[quad].patch == draft.boundary[other->second].patch) continue;
    edges[edge[0]].add((draft.points[edge[0]] + draft.points[edge[1]]) / 2);
  }
  std::vector<Vec3> result(hexes.size(), Vec3::Zero());
  for (std::size_t v = 0; v < result.size(); ++v) {
    const Mean& mean = edges[v].count > 0 ? edges[v] : quads[v].count > 0 ? quads[v] : hexes[v];
    if (mean.count > 0) result[v] = mean.sum / mean.count;
  }
  return result;
}

}  // namespace

Pillow pillow(const BlockDraft& draft, const std::vector<char>& in_set,
              const std::function<bool(const BoundaryQuad&)>& covers, double depth) {
  Pillow result;
  BlockDraft& out = result.draft;
  out = draft;
  const std::map<Quad, Index> on_boundary = boundary_by_corners(draft);

  // The surface, outward of the set; and the set's boundary quads that stay, by their directed edges.
  std::vector<Quad> surface;
  EdgeQuads beside;
  std::vector<char> keeps(draft.boundary.size(), 0);
  const std::vector<Use> uses = face_uses(draft);
  for (std::size_t n = 0; n < uses.size(); ++n) {
    const bool paired =
        (n > 0 && uses[n - 1].key == uses[n].key) || (n + 1 < uses.size() && uses[n + 1].key == uses[n].key);
    if (in_set[uses[n].hex] == 0) continue;
    const Quad face = face_of(draft.hexes[uses[n].hex], uses[n].face);
    if (paired) {
      const Use& other = n > 0 && uses[n - 1].key == uses[n].key ? uses[n - 1] : uses[n + 1];
      if (in_set[other.hex] == 0) surface.push_back(face);
      continue;
    }
    const Index b = on_boundary.at(uses[n].key);
    if (covers(draft.boundary[b])) {
      surface.push_back(face);
    } else {
      keeps[b] = 1;
      for (int c = 0; c < 4; ++c) beside[{face[c], face[(c + 1) % 4]}] = b;
    }
  }

  // Split points: the old one stays outside, the new one is the set's.
  std::vector<Index> split(draft.points.size(), no_index);
  for (const Quad& q : surface) {
    for (const Index v : q) {
      if (split[v] != no_index) continue;
      split[v] = static_cast<Index>(draft.points.size() + result.split_from.size());
      result.split_from.push_back(v);
    }
  }
  const auto inner = [&](Index v) { return split[v] == no_index ? v : split[v]; };
  for (std::size_t h = 0; h < draft.hexes.size(); ++h) {
    if (in_set[h] == 0) continue;
    for (Index& v : out.hexes[h]) v = inner(v);
  }
  const std::vector<Vec3> toward = inner_places(draft, in_set, keeps, beside);
  for (const Index v : result.split_from) {
    out.points.push_back(draft.points[v] + 2 * depth * (toward[v] - draft.points[v]));
  }
  for (std::size_t b = 0; b < draft.boundary.size(); ++b) {
    if (keeps[b] == 0) continue;
    for (Index& v : out.boundary[b].corners) v = inner(v);
  }

  // One hex a quad of the surface; its sides on the boundary where the surface ends.
  std::map<std::array<Index, 2>, int> edges;
  for (const Quad& q : surface) {
    for (int c = 0; c < 4; ++c) ++edges[undirected(q[c], q[(c + 1) % 4])];
  }
  for (const Quad& q : surface) {
    HexPoints hex;
    for (int c = 0; c < 4; ++c) {
      hex[c] = inner(q[c]);
      hex[c + 4] = q[c];
    }
    result.layer_hexes.push_back(static_cast<Index>(out.hexes.size()));
    out.hexes.push_back(hex);
    for (int c = 0; c < 4; ++c) {
      const Index a = q[c], b = q[(c + 1) % 4];
      const int uses_of_edge = edges.at(undirected(a, b));
      if (uses_of_edge == 2) continue;
      const auto found = beside.find({b, a});
      if (uses_of_edge != 1 || found == beside.end()) {
        throw Error(ErrorKind::internal,
                    fmt::format("pillow: the surface is no manifold, or ends inside of the blocks, at {}",
                                place((draft.points[a] + draft.points[b]) / 2)),
                    "this is a defect of flowcage: please report it");
      }
      // The set's boundary quad runs b -> a along its edge, now between the inner points.
      out.boundary.push_back({{inner(a), inner(b), b, a}, draft.boundary[found->second].patch});
    }
  }
  return result;
}

}  // namespace flowcage
