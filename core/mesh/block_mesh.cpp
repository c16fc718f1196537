#include "core/mesh/block_mesh.hpp"

#include <fmt/format.h>

#include <limits>

#include "core/base/error.hpp"
#include "core/mesh/hex_numbering.hpp"

namespace flowcage {
namespace {

/// The two axes across `axis`, ascending.
constexpr std::array<std::array<int, 2>, 3> other_axes{{{1, 2}, {0, 2}, {0, 1}}};

/// Divisions of a quad along its first side and along its last.
std::array<Index, 2> quad_divisions(const HexComplex& c, const std::vector<Index>& chord_divisions,
                                    Index quad, std::array<Index, 2> hex_and_face) {
  const auto [hex, face] = hex_and_face;
  const auto [a, b] = other_axes[face / 2];
  const std::array<Index, 2> along{chord_divisions[c.edge_chord[c.hex_edges[hex][4 * a]]],
                                   chord_divisions[c.edge_chord[c.hex_edges[hex][4 * b]]]};
  // The quad's first side runs along axis a or b of this hex.
  const auto position = [&](int corner) {
    const auto& hc = c.hexes[hex];
    return hex_corner_ijk[std::find(hc.begin(), hc.end(), c.quads[quad][corner]) - hc.begin()];
  };
  const bool first_along_a = position(0)[a] != position(1)[a];
  return first_along_a ? along : std::array<Index, 2>{along[1], along[0]};
}

int face_of(const HexComplex& c, Index hex, Index quad) {
  const auto& quads = c.hex_quads[hex];
  return static_cast<int>(std::find(quads.begin(), quads.end(), quad) - quads.begin());
}

struct Offsets {
  std::vector<Index> edge, quad, hex;
  Index total = 0;
};

Offsets count_points(const HexComplex& c, const std::vector<Index>& divisions) {
  Offsets result;
  Offset next = static_cast<Offset>(c.points.size());
  const auto take = [&](std::vector<Index>& offsets, Offset count) {
    offsets.push_back(static_cast<Index>(next));
    next += count;
    if (next > std::numeric_limits<Index>::max()) {
      throw Error(ErrorKind::input, "the mesh would have more than 2147483647 points", "refine fewer times");
    }
  };
  for (const Index chord : c.edge_chord) take(result.edge, divisions[chord] - 1);
  for (Index q = 0; q < static_cast<Index>(c.quads.size()); ++q) {
    const Index hex = c.quad_hexes[q][0];
    const auto [a, b] = other_axes[face_of(c, hex, q) / 2];
    take(result.quad, Offset{divisions[c.edge_chord[c.hex_edges[hex][4 * a]]] - 1} *
                          (divisions[c.edge_chord[c.hex_edges[hex][4 * b]]] - 1));
  }
  for (const auto& edges : c.hex_edges) {
    take(result.hex, Offset{divisions[c.edge_chord[edges[0]]] - 1} * (divisions[c.edge_chord[edges[4]]] - 1) *
                         (divisions[c.edge_chord[edges[8]]] - 1));
  }
  result.total = static_cast<Index>(next);
  return result;
}

}  // namespace

Index BlockMesh::point_count(const HexComplex& complex, const std::vector<Index>& chord_divisions) {
  return count_points(complex, chord_divisions).total;
}

BlockMesh::BlockMesh(std::shared_ptr<const HexComplex> complex, std::vector<Index> chord_divisions,
                     std::vector<Vec3> points)
    : complex_(std::move(complex)), chord_divisions_(std::move(chord_divisions)), points_(std::move(points)) {
  if (static_cast<Index>(chord_divisions_.size()) != complex_->chord_count) {
    throw Error(ErrorKind::internal, "BlockMesh: one number of divisions a chord", "report this defect");
  }
  Offsets offsets = count_points(*complex_, chord_divisions_);
  if (static_cast<Index>(points_.size()) != offsets.total) {
    throw Error(ErrorKind::internal,
                fmt::format("BlockMesh: {} points given, {} needed", points_.size(), offsets.total),
                "report this defect");
  }
  edge_offset_ = std::move(offsets.edge);
  quad_offset_ = std::move(offsets.quad);
  hex_offset_ = std::move(offsets.hex);
  cell_offset_.push_back(0);
  for (Index b = 0; b < block_count(); ++b) {
    frames_.push_back(make_frame(b));
    const auto [ni, nj, nk] = frames_.back().dims;
    cell_offset_.push_back(cell_offset_.back() + Offset{ni} * nj * nk);
  }
  build_patches();
}

BlockMesh::BlockMesh(std::shared_ptr<const HexComplex> complex)
    : BlockMesh(complex, std::vector<Index>(complex->chord_count, 1), complex->points) {}

BlockMesh::Frame BlockMesh::make_frame(Index block) const {
  const HexComplex& c = *complex_;
  const HexPoints& hex = c.hexes[block];
  Frame frame{};
  for (int axis = 0; axis < 3; ++axis) {
    frame.dims[axis] = chord_divisions_[c.edge_chord[c.hex_edges[block][4 * axis]]];
  }
  // Point t of an edge that the block sees forward is offset + t - 1, backward offset + (n - t) - 1.
  for (int s = 0; s < 12; ++s) {
    const Index e = c.hex_edges[block][s];
    const bool forward = c.edges[e][0] == hex[hex_edges[s][0]];
    const Index n = frame.dims[s / 4];
    frame.edges[s] = forward ? std::array<Index, 2>{edge_offset_[e] - 1, 1}
                             : std::array<Index, 2>{edge_offset_[e] + n - 1, -1};
  }
  // A quad's own (u,v), u along its first side, as an affine function of the block's two axes a and b:
  // found from where the quad's corners 0, 1 and 3 lie in the block.
  for (int f = 0; f < 6; ++f) {
    const Index q = c.hex_quads[block][f];
    const auto [a, b] = other_axes[f / 2];
    const auto [nu, nv] = quad_divisions(c, chord_divisions_, q, {block, f});
    const auto at = [&](int corner) {
      return hex_corner_ijk[std::find(hex.begin(), hex.end(), c.quads[q][corner]) - hex.begin()];
    };
    const auto origin = at(0);
    const bool first_along_a = at(1)[a] != origin[a];
    const Index row = nu - 1;
    // number = offset + (u - 1) + row * (v - 1)
    Index base = quad_offset_[q] - 1 - row;
    std::array<Index, 2> stride{};
    for (int side = 0; side < 2; ++side) {
      const int axis = side == 0 ? a : b;
      const bool is_u = (side == 0) == first_along_a;
      const Index step = is_u ? 1 : row;
      const Index n = is_u ? nu : nv;
      if (origin[axis] == 0) {
        stride[side] = step;
      } else {
        stride[side] = -step;
        base += step * n;
      }
    }
    frame.faces[f] = {base, stride[0], stride[1]};
  }
  const auto [ni, nj, nk] = frame.dims;
  frame.interior = hex_offset_[block] - 1 - (ni - 1) - (ni - 1) * (nj - 1);
  return frame;
}

std::array<Index, 3> BlockMesh::dims(Index block) const {
  return frames_[block].dims;
}

Index BlockMesh::point_number(Index block, Index i, Index j, Index k) const {
  const Frame& frame = frames_[block];
  const std::array<Index, 3> at{i, j, k};
  // side[axis]: 0 or 1 on the block's surface, -1 between.
  std::array<int, 3> side{};
  int inner = 0;
  for (int axis = 0; axis < 3; ++axis) {
    side[axis] = at[axis] == 0 ? 0 : (at[axis] == frame.dims[axis] ? 1 : -1);
    inner += side[axis] < 0 ? 1 : 0;
  }
  if (inner == 3) {
    return frame.interior + i + (frame.dims[0] - 1) * (j + (frame.dims[1] - 1) * k);
  }
  if (inner == 0) return complex_->hexes[block][hex_corner_at(side[0], side[1], side[2])];
  if (inner == 1) {
    const int axis = side[0] < 0 ? 0 : (side[1] < 0 ? 1 : 2);
    const auto [a, b] = other_axes[axis];
    const auto& [base, stride] = frame.edges[4 * axis + side[a] + 2 * side[b]];
    return base + stride * at[axis];
  }
  const int axis = side[0] >= 0 ? 0 : (side[1] >= 0 ? 1 : 2);
  const auto [a, b] = other_axes[axis];
  const auto& [base, stride_a, stride_b] = frame.faces[2 * axis + side[axis]];
  return base + stride_a * at[a] + stride_b * at[b];
}

QuadLattice BlockMesh::quad_lattice(Index quad) const {
  const HexComplex& c = *complex_;
  QuadLattice lattice;
  lattice.block = c.quad_hexes[quad][0];
  const HexPoints& hex = c.hexes[lattice.block];
  const auto& n = frames_[lattice.block].dims;
  const auto at = [&](int corner) {
    return hex_corner_ijk[std::find(hex.begin(), hex.end(), c.quads[quad][corner]) - hex.begin()];
  };
  const auto origin = at(0);
  const auto u_end = at(1);
  const auto v_end = at(3);
  for (int axis = 0; axis < 3; ++axis) {
    lattice.origin[axis] = origin[axis] * n[axis];
    lattice.du[axis] = u_end[axis] - origin[axis];
    lattice.dv[axis] = v_end[axis] - origin[axis];
    if (lattice.du[axis] != 0) lattice.nu = n[axis];
    if (lattice.dv[axis] != 0) lattice.nv = n[axis];
  }
  return lattice;
}

PointRow BlockMesh::point_row(Index block, int axis, std::array<Index, 3> at) const {
  const auto number = [&](Index t) {
    at[axis] = t;
    return point_number(block, at[0], at[1], at[2]);
  };
  const Index n = frames_[block].dims[axis];
  PointRow row{n, number(0), number(n)};
  if (n > 2) row.stride = number(2) - number(1);
  if (n > 1) row.base = number(1) - row.stride;
  return row;
}

Index BlockMesh::block_of(Offset cell) const {
  return static_cast<Index>(std::upper_bound(cell_offset_.begin(), cell_offset_.end(), cell) -
                            cell_offset_.begin()) -
         1;
}

void BlockMesh::read_cells(Offset begin, std::span<HexPoints> out) const {
  if (out.empty()) return;
  Index block = block_of(begin);
  std::size_t done = 0;
  while (done < out.size()) {
    while (begin + static_cast<Offset>(done) >= cell_offset_[block + 1]) ++block;
    const auto [ni, nj, nk] = frames_[block].dims;
    const Offset local = begin + static_cast<Offset>(done) - cell_offset_[block];
    const auto first = static_cast<Index>(local % ni);
    const auto j = static_cast<Index>(local / ni % nj);
    const auto k = static_cast<Index>(local / ni / nj);
    const std::array<PointRow, 4> rows{point_row(block, 0, {0, j, k}), point_row(block, 0, {0, j + 1, k}),
                                       point_row(block, 0, {0, j, k + 1}),
                                       point_row(block, 0, {0, j + 1, k + 1})};
    std::array<Index, 4> low{rows[0][first], rows[1][first], rows[2][first], rows[3][first]};
    for (Index i = first; i < ni && done < out.size(); ++i, ++done) {
      std::array<Index, 4> high;
      for (int r = 0; r < 4; ++r) high[r] = rows[r][i + 1];
      out[done] = {low[0], high[0], high[1], low[1], low[2], high[2], high[3], low[3]};
      low = high;
    }
  }
}

void BlockMesh::build_patches() {
  for (const HexComplex::Patch& patch : complex_->patches)
    patches_.push_back({patch.name, patch.type, {}, {}});
  if (cell_count() > std::numeric_limits<Index>::max()) {
    throw Error(ErrorKind::input, "the mesh would have more than 2147483647 cells", "refine fewer times");
  }
  for (Index q = 0; q < static_cast<Index>(complex_->quads.size()); ++q) {
    if (complex_->quad_patch[q] == no_index) continue;
    BoundaryPatch& patch = patches_[complex_->quad_patch[q]];
    const Index block = complex_->quad_hexes[q][0];
    const int face = face_of(*complex_, block, q);
    const int axis = face / 2;
    const auto [a, b] = other_axes[axis];
    const auto& n = frames_[block].dims;
    for (Index vb = 0; vb < n[b]; ++vb) {
      for (Index va = 0; va < n[a]; ++va) {
        std::array<Index, 3> cell{};
        cell[a] = va;
        cell[b] = vb;
        cell[axis] = face % 2 == 0 ? 0 : n[axis] - 1;
        std::array<Index, 4> quad{};
        for (int c = 0; c < 4; ++c) {
          const auto& corner = hex_corner_ijk[hex_faces[face][c]];
          quad[c] = point_number(block, cell[0] + corner[0], cell[1] + corner[1], cell[2] + corner[2]);
        }
        patch.quads.push_back(quad);
        patch.owner.push_back(
            static_cast<Index>(cell_offset_[block] + cell[0] + n[0] * (cell[1] + Offset{n[1]} * cell[2])));
      }
    }
  }
}

}  // namespace flowcage
