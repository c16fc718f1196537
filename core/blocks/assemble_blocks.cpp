#include "core/blocks/assemble_blocks.hpp"

#include <algorithm>
#include <map>

namespace flowcage {
namespace {

std::array<Index, 4> sorted(std::array<Index, 4> q) {
  std::sort(q.begin(), q.end());
  return q;
}

/// build_hex_complex makes borders of patches sharp; between walls only the cage's creases are.
void smooth_between_walls(HexComplex& complex, const Cage& cage, const WallCage& wall) {
  std::map<std::array<Index, 2>, Index> walls;  // edge: how many wall quads meet there
  for (Index f = 0; f < cage.faces.size(); ++f) {
    for (int n = 0; n < 4; ++n) {
      const Index a = wall.vertex_corner[cage.faces[f][n]],
                  b = wall.vertex_corner[cage.faces[f][(n + 1) % 4]];
      ++walls[{std::min(a, b), std::max(a, b)}];
    }
  }
  for (const Cage::Crease& c : cage.creases) {
    const Index a = wall.vertex_corner[c.a], b = wall.vertex_corner[c.b];
    walls.erase({std::min(a, b), std::max(a, b)});
  }
  for (std::size_t e = 0; e < complex.edges.size(); ++e) {
    const auto found = walls.find(complex.edges[e]);
    if (found != walls.end() && found->second == 2) complex.edge_sharpness[e] = 0;
  }
}

}  // namespace

void assemble_blocks(BlockDraft draft, const AmbientFrame& frame, AmbientBlocks& result,
                     const WallCage& wall) {
  std::vector<HexComplex::Patch> patches;
  for (const std::string& name : result.cage.patch_names) {
    patches.push_back({name.empty() ? "wall" : name, PatchType::wall});
  }
  std::array<Index, 3> outer{no_index, no_index, no_index};
  std::vector<Index> patch(draft.boundary.size(), no_index);
  for (std::size_t f = 0; f < wall.face_boundary.size(); ++f) {
    patch[wall.face_boundary[f]] = result.cage.face_patch[f];
  }
  for (std::size_t b = 0; b < draft.boundary.size(); ++b) {
    if (patch[b] != no_index) continue;
    const PatchType type = frame.sides[draft.boundary[b].patch - 1].type;
    Index& number = outer[type == PatchType::symmetry ? 1 : 0];
    if (number == no_index) {
      number = static_cast<Index>(patches.size());
      patches.push_back({type == PatchType::symmetry ? "symmetry" : "farfield", type});
    }
    patch[b] = number;
  }
  // The box's edges are sharp although both sides are one patch.
  std::map<std::array<Index, 2>, Index> side;
  std::vector<SharpEdge> sharp;
  for (std::size_t b = 0; b < draft.boundary.size(); ++b) {
    for (int n = 0; n < 4; ++n) {
      const Index p = draft.boundary[b].corners[n], q = draft.boundary[b].corners[(n + 1) % 4];
      const auto [it, fresh] =
          side.try_emplace(std::array{std::min(p, q), std::max(p, q)}, draft.boundary[b].patch);
      if (!fresh && it->second != draft.boundary[b].patch) sharp.push_back({p, q});
    }
    draft.boundary[b].patch = patch[b];
  }
  assemble_blocks(std::move(draft), std::move(patches), std::move(sharp), result, wall);
}

void assemble_blocks(BlockDraft draft, std::vector<HexComplex::Patch> patches, std::vector<SharpEdge> sharp,
                     AmbientBlocks& result, const WallCage& wall) {
  for (const Cage::Crease& c : result.cage.creases) {
    sharp.push_back({wall.vertex_corner[c.a], wall.vertex_corner[c.b], c.sharpness});
  }
  result.complex = build_hex_complex(std::move(draft.points), std::move(draft.hexes), std::move(patches),
                                     draft.boundary, sharp);
  HexComplex& complex = result.complex;
  smooth_between_walls(complex, result.cage, wall);
  for (const Cage::Corner& c : result.cage.corners) {
    complex.corner_sharpness[wall.vertex_corner[c.vertex]] = c.sharpness;
  }
  std::map<std::array<Index, 4>, Index> quad;
  for (Index q = 0; q < static_cast<Index>(complex.quads.size()); ++q) {
    if (complex.quad_patch[q] != no_index) quad.emplace(sorted(complex.quads[q]), q);
  }
  result.vertex_corner = wall.vertex_corner;
  for (const Index b : wall.face_boundary)
    result.face_quad.push_back(quad.at(sorted(draft.boundary[b].corners)));
}

}  // namespace flowcage
