#include "core/mesh/hex_complex.hpp"

#include <fmt/format.h>

#include <numeric>

#include "core/base/error.hpp"
#include "core/mesh/hex_numbering.hpp"

namespace flowcage {
namespace {

using Quad = std::array<Index, 4>;

Quad sorted(Quad q) {
  std::sort(q.begin(), q.end());
  return q;
}

/// One use of an edge or quad by a hex: sorting by (key, hex, slot) brings equal ones together.
template <std::size_t N>
struct Use {
  std::array<Index, N> key;
  Index hex;
  int slot;
  auto operator<=>(const Use&) const = default;
};

Error bad(const std::string& what, const Vec3& at) {
  return {ErrorKind::input, fmt::format("block mesh: {} at {}", what, place(at)),
          "repair the blocks there: they must fit face to face and their boundary must be a manifold"};
}

Vec3 centre(const HexComplex& c, const Quad& q) {
  return (c.points[q[0]] + c.points[q[1]] + c.points[q[2]] + c.points[q[3]]) / 4;
}

void check_hexes(const HexComplex& c) {
  const Index corners = static_cast<Index>(c.points.size());
  std::vector<char> used(c.points.size(), 0);
  for (std::size_t h = 0; h < c.hexes.size(); ++h) {
    for (const Index v : c.hexes[h]) {
      if (v < 0 || v >= corners) {
        throw Error(ErrorKind::input, fmt::format("block mesh: block {} has corner {} of {}", h, v, corners),
                    "corner numbers start at 0");
      }
      used[v] = 1;
    }
    HexPoints s = c.hexes[h];
    std::sort(s.begin(), s.end());
    const auto twice = std::adjacent_find(s.begin(), s.end());
    if (twice != s.end()) throw bad(fmt::format("block {} has corner {} twice", h, *twice), c.points[*twice]);
  }
  for (Index v = 0; v < corners; ++v) {
    if (!c.points[v].allFinite()) {
      throw Error(ErrorKind::input, fmt::format("block mesh: corner {} is not a finite point", v),
                  "give every corner three finite coordinates");
    }
    if (used[v] == 0) throw bad(fmt::format("corner {} belongs to no block", v), c.points[v]);
  }
}

void number_edges(HexComplex& c) {
  std::vector<Use<2>> uses;
  uses.reserve(12 * c.hexes.size());
  for (Index h = 0; h < static_cast<Index>(c.hexes.size()); ++h) {
    for (int s = 0; s < 12; ++s) {
      const Index a = c.hexes[h][hex_edges[s][0]];
      const Index b = c.hexes[h][hex_edges[s][1]];
      uses.push_back({{std::min(a, b), std::max(a, b)}, h, s});
    }
  }
  std::sort(uses.begin(), uses.end());
  c.hex_edges.resize(c.hexes.size());
  for (const Use<2>& use : uses) {
    if (c.edges.empty() || c.edges.back() != use.key) c.edges.push_back(use.key);
    c.hex_edges[use.hex][use.slot] = static_cast<Index>(c.edges.size()) - 1;
  }
}

/// The face of a hex as corners of the complex, outward.
Quad outward_face(const HexComplex& c, Index hex, int face) {
  Quad q{};
  for (int n = 0; n < 4; ++n) q[n] = c.hexes[hex][hex_faces[face][n]];
  return q;
}

/// Whether `b` is the cycle `a` run backwards.
bool is_reverse(const Quad& a, const Quad& b) {
  const int shift = static_cast<int>(std::find(b.begin(), b.end(), a[0]) - b.begin());
  for (int n = 0; n < 4; ++n) {
    if (shift == 4 || a[n] != b[(shift + 4 - n) % 4]) return false;
  }
  return true;
}

void number_quads(HexComplex& c) {
  std::vector<Use<4>> uses;
  uses.reserve(6 * c.hexes.size());
  for (Index h = 0; h < static_cast<Index>(c.hexes.size()); ++h) {
    for (int s = 0; s < 6; ++s) uses.push_back({sorted(outward_face(c, h, s)), h, s});
  }
  std::sort(uses.begin(), uses.end());
  c.hex_quads.resize(c.hexes.size());
  for (std::size_t n = 0; n < uses.size(); ++n) {
    const Use<4>& use = uses[n];
    const Quad face = outward_face(c, use.hex, use.slot);
    if (n == 0 || uses[n - 1].key != use.key) {
      c.quads.push_back(face);
      c.quad_hexes.push_back({use.hex, no_index});
    } else {
      if (c.quad_hexes.back()[1] != no_index) {
        throw bad("a quad belongs to more than two blocks", centre(c, face));
      }
      if (!is_reverse(c.quads.back(), face)) {
        throw bad(
            fmt::format("blocks {} and {} lie on the same side of a quad, or one is twisted or inside out",
                        c.quad_hexes.back()[0], use.hex),
            centre(c, face));
      }
      c.quad_hexes.back()[1] = use.hex;
    }
    c.hex_quads[use.hex][use.slot] = static_cast<Index>(c.quads.size()) - 1;
  }
}

void assign_patches(HexComplex& c, const std::vector<BoundaryQuad>& boundary) {
  std::vector<std::pair<Quad, Index>> by_corners;  // of the complex's quads
  for (Index q = 0; q < static_cast<Index>(c.quads.size()); ++q)
    by_corners.push_back({sorted(c.quads[q]), q});
  std::sort(by_corners.begin(), by_corners.end());
  c.quad_patch.assign(c.quads.size(), no_index);
  for (const BoundaryQuad& given : boundary) {
    const Quad key = sorted(given.corners);
    if (key[0] < 0 || key[3] >= static_cast<Index>(c.points.size())) {
      throw Error(ErrorKind::input, fmt::format("block mesh: a boundary quad has corner {}", key[0]),
                  "corner numbers start at 0");
    }
    const auto found = std::lower_bound(by_corners.begin(), by_corners.end(), std::pair{key, Index{0}});
    if (found == by_corners.end() || found->first != key) {
      throw bad("a boundary quad is a face of no block", centre(c, given.corners));
    }
    const Index q = found->second;
    if (c.quad_hexes[q][1] != no_index)
      throw bad("a boundary quad lies between two blocks", centre(c, c.quads[q]));
    if (given.patch < 0 || given.patch >= static_cast<Index>(c.patches.size())) {
      throw bad(fmt::format("a boundary quad names patch {} of {}", given.patch, c.patches.size()),
                centre(c, c.quads[q]));
    }
    if (c.quad_patch[q] != no_index && c.quad_patch[q] != given.patch) {
      throw bad("a boundary quad belongs to two patches", centre(c, c.quads[q]));
    }
    c.quad_patch[q] = given.patch;
  }
  for (std::size_t q = 0; q < c.quads.size(); ++q) {
    if (c.quad_hexes[q][1] == no_index && c.quad_patch[q] == no_index) {
      throw bad("a quad of the boundary has no patch", centre(c, c.quads[q]));
    }
  }
}

/// Each boundary edge has two boundary quads, each boundary corner one fan of them: walks the fan by taking,
/// at each quad, the edge that enters the corner to the quad on its other side.
struct BoundaryEdges {
  std::vector<std::array<Index, 2>> quads;  ///< #E; no_index inside
};

Index edge_between(const HexComplex& c, Index a, Index b) {
  const std::array<Index, 2> key{std::min(a, b), std::max(a, b)};
  const auto found = std::lower_bound(c.edges.begin(), c.edges.end(), key);
  return found != c.edges.end() && *found == key ? static_cast<Index>(found - c.edges.begin()) : no_index;
}

BoundaryEdges check_boundary_manifold(const HexComplex& c) {
  BoundaryEdges result;
  result.quads.assign(c.edges.size(), {no_index, no_index});
  std::vector<Index> quads_at(c.points.size(), 0);
  std::vector<Index> some_quad(c.points.size(), no_index);
  for (Index q = 0; q < static_cast<Index>(c.quads.size()); ++q) {
    if (c.quad_patch[q] == no_index) continue;
    for (int n = 0; n < 4; ++n) {
      const Index a = c.quads[q][n];
      const Index e = edge_between(c, a, c.quads[q][(n + 1) % 4]);
      auto& two = result.quads[e];
      if (two[1] != no_index) {
        throw bad("more than two boundary quads meet at an edge (the blocks touch there only along it)",
                  (c.points[c.edges[e][0]] + c.points[c.edges[e][1]]) / 2);
      }
      (two[0] == no_index ? two[0] : two[1]) = q;
      ++quads_at[a];
      some_quad[a] = q;
    }
  }
  for (Index v = 0; v < static_cast<Index>(c.points.size()); ++v) {
    if (some_quad[v] == no_index) continue;
    Index count = 0;
    Index q = some_quad[v];
    do {
      const auto& corners = c.quads[q];
      const auto at = std::find(corners.begin(), corners.end(), v) - corners.begin();
      const Index e = edge_between(c, corners[(at + 3) % 4], v);
      q = result.quads[e][0] == q ? result.quads[e][1] : result.quads[e][0];
      ++count;
    } while (q != some_quad[v] && count <= quads_at[v]);
    if (count != quads_at[v]) {
      throw bad(fmt::format("two parts of the boundary touch at corner {}", v), c.points[v]);
    }
  }
  return result;
}

void assign_sharpness(HexComplex& c, const BoundaryEdges& on_boundary, const std::vector<SharpEdge>& sharp) {
  c.edge_sharpness.assign(c.edges.size(), 0);
  c.corner_sharpness.assign(c.points.size(), 0);
  for (std::size_t e = 0; e < c.edges.size(); ++e) {
    const auto [p, q] = on_boundary.quads[e];
    if (p != no_index && c.quad_patch[p] != c.quad_patch[q]) c.edge_sharpness[e] = infinitely_sharp;
  }
  for (const SharpEdge& s : sharp) {
    const Index e = edge_between(c, s.a, s.b);
    if (e == no_index || on_boundary.quads[e][0] == no_index) {
      throw Error(ErrorKind::input,
                  fmt::format("block mesh: sharp edge {}-{} is no edge of the boundary", s.a, s.b),
                  "give the sharp edge by two neighbouring corners of the boundary");
    }
    c.edge_sharpness[e] = std::max(c.edge_sharpness[e], s.sharpness);
  }
}

/// Edges opposite in a quad share a chord: union-find with the smallest edge as the root, so that chords are
/// numbered in the order of their first edges.
void number_chords(HexComplex& c) {
  std::vector<Index> parent(c.edges.size());
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&](Index e) {
    while (parent[e] != e) e = parent[e] = parent[parent[e]];
    return e;
  };
  for (const auto& edges : c.hex_edges) {
    for (int axis = 0; axis < 3; ++axis) {
      for (int n = 1; n < 4; ++n) {
        const Index a = root(edges[4 * axis]);
        const Index b = root(edges[4 * axis + n]);
        parent[std::max(a, b)] = std::min(a, b);
      }
    }
  }
  c.edge_chord.resize(c.edges.size());
  for (Index e = 0; e < static_cast<Index>(c.edges.size()); ++e) {
    const Index r = root(e);
    c.edge_chord[e] = r == e ? c.chord_count++ : c.edge_chord[r];
  }
}

}  // namespace

HexComplex build_hex_complex(std::vector<Vec3> points, std::vector<HexPoints> hexes,
                             std::vector<HexComplex::Patch> patches,
                             const std::vector<BoundaryQuad>& boundary, const std::vector<SharpEdge>& sharp) {
  HexComplex c;
  c.points = std::move(points);
  c.hexes = std::move(hexes);
  c.patches = std::move(patches);
  check_hexes(c);
  number_edges(c);
  number_quads(c);
  assign_patches(c, boundary);
  assign_sharpness(c, check_boundary_manifold(c), sharp);
  number_chords(c);
  return c;
}

}  // namespace flowcage
