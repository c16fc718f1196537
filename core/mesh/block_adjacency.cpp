#include "core/mesh/block_adjacency.hpp"

#include <algorithm>

#include "core/mesh/hex_numbering.hpp"

namespace flowcage {
namespace {

/// The two axes across `axis`, ascending.
constexpr std::array<std::array<int, 2>, 3> other_axes{{{1, 2}, {0, 2}, {0, 1}}};

int face_of(const HexComplex& c, Index hex, Index quad) {
  const auto& quads = c.hex_quads[hex];
  return static_cast<int>(std::find(quads.begin(), quads.end(), quad) - quads.begin());
}

/// First boundary quad of each quad of the complex, in the order in which BlockMesh lists them: patch by
/// patch, each patch's quads ascending.
std::vector<Index> first_boundary_quads(const BlockMesh& mesh) {
  const HexComplex& c = mesh.complex();
  std::vector<Index> next{0};
  for (const BoundaryPatch& patch : mesh.patches()) {
    next.push_back(next.back() + static_cast<Index>(patch.quads.size()));
  }
  std::vector<Index> first(c.quads.size(), no_index);
  for (std::size_t q = 0; q < c.quads.size(); ++q) {
    if (c.quad_patch[q] == no_index) continue;
    const auto [block, unused] = c.quad_hexes[q];
    const auto [a, b] = other_axes[face_of(c, block, static_cast<Index>(q)) / 2];
    const auto n = mesh.dims(block);
    first[q] = next[c.quad_patch[q]];
    next[c.quad_patch[q]] += n[a] * n[b];
  }
  return first;
}

}  // namespace

BlockAdjacency::Link BlockAdjacency::link_to_block(const BlockMesh& mesh, std::array<Index, 2> from,
                                                   std::array<Index, 2> to) {
  const HexComplex& c = mesh.complex();
  const auto [block, face] = from;
  const auto [other, other_face] = to;
  const auto [a, b] = other_axes[face / 2];
  const HexPoints& hex = c.hexes[block];
  const HexPoints& other_hex = c.hexes[other];
  // Where the other block has the corner at (0 or 1, 0 or 1) of this block's face.
  const auto seen = [&](int at_a, int at_b) {
    std::array<int, 3> at{};
    at[face / 2] = face % 2;
    at[a] = at_a;
    at[b] = at_b;
    const Index corner = hex[hex_corner_at(at[0], at[1], at[2])];
    return hex_corner_ijk[std::find(other_hex.begin(), other_hex.end(), corner) - other_hex.begin()];
  };
  const auto origin = seen(0, 0);
  const auto a_end = seen(1, 0);
  const auto b_end = seen(0, 1);
  const auto n = mesh.dims(other);
  const std::array<Index, 3> step{1, n[0], n[0] * n[1]};
  Link link;
  link.base = static_cast<Index>(mesh.block_begin(other));
  for (int axis = 0; axis < 3; ++axis) {
    const bool at_low = axis == other_face / 2 ? other_face % 2 == 0 : origin[axis] == 0;
    if (!at_low) link.base += step[axis] * (n[axis] - 1);
    link.along_a += step[axis] * (a_end[axis] - origin[axis]);
    link.along_b += step[axis] * (b_end[axis] - origin[axis]);
  }
  return link;
}

BlockAdjacency::BlockAdjacency(const BlockMesh& mesh) : cells_(mesh.cell_count()) {
  const HexComplex& c = mesh.complex();
  const std::vector<Index> first = first_boundary_quads(mesh);
  for (Index block = 0; block < mesh.block_count(); ++block) {
    Block& out = blocks_.emplace_back();
    out.begin = mesh.block_begin(block);
    out.dims = mesh.dims(block);
    for (int face = 0; face < 6; ++face) {
      const Index q = c.hex_quads[block][face];
      const auto [one, two] = c.quad_hexes[q];
      if (two == no_index) {
        // ~(first + a + n b) = ~first - a - n b
        out.links[face] = {~first[q], -1, -out.dims[other_axes[face / 2][0]]};
      } else {
        const Index other = one == block ? two : one;
        out.links[face] = link_to_block(mesh, {block, face}, {other, face_of(c, other, q)});
      }
    }
  }
}

void BlockAdjacency::read_across(Offset begin, std::span<CellNeighbours> out) const {
  if (out.empty()) return;
  auto block = std::upper_bound(blocks_.begin(), blocks_.end(), begin,
                                [](Offset cell, const Block& b) { return cell < b.begin; }) -
               1;
  std::size_t done = 0;
  while (done < out.size()) {
    const auto [ni, nj, nk] = block->dims;
    Offset local = begin + static_cast<Offset>(done) - block->begin;
    if (local == Offset{ni} * nj * nk) {
      ++block;
      continue;
    }
    const auto& links = block->links;
    const auto j = static_cast<Index>(local / ni % nj);
    const auto k = static_cast<Index>(local / ni / nj);
    auto cell = static_cast<Index>(block->begin + local);
    for (auto i = static_cast<Index>(local % ni); i < ni && done < out.size(); ++i, ++done, ++cell) {
      out[done] = {
          i > 0 ? cell - 1 : links[0].at(j, k),       i + 1 < ni ? cell + 1 : links[1].at(j, k),
          j > 0 ? cell - ni : links[2].at(i, k),      j + 1 < nj ? cell + ni : links[3].at(i, k),
          k > 0 ? cell - ni * nj : links[4].at(i, j), k + 1 < nk ? cell + ni * nj : links[5].at(i, j)};
    }
  }
}

}  // namespace flowcage
