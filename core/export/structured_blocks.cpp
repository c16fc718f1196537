#include "core/export/structured_blocks.hpp"

#include <algorithm>
#include <numeric>

#include "core/mesh/hex_numbering.hpp"
#include "core/mesh/visit_cells.hpp"

namespace flowcage {
namespace {

constexpr std::array<std::array<int, 2>, 3> other_axes{{{1, 2}, {0, 2}, {0, 1}}};
constexpr std::array<std::array<int, 3>, 6> axis_orders{
    {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}}};

/// The block's own face at side (0 or 1) of the box's axis d.
int own_face(const BlockPlacement& p, int d, int side) {
  return 2 * p.axis[d] + (p.reversed[d] ? 1 - side : side);
}

Index across(const HexComplex& c, Index block, int face) {
  const auto& two = c.quad_hexes[c.hex_quads[block][face]];
  return two[0] == block ? two[1] : two[0];
}

/// The block across side `side` of axis d, as the same box sees it; block no_index outside.
BlockPlacement neighbour(const HexComplex& c, const BlockPlacement& p, int d, int side) {
  BlockPlacement next;
  const int face = own_face(p, d, side);
  next.block = across(c, p.block, face);
  if (next.block == no_index) return next;
  const Index quad = c.hex_quads[p.block][face];
  const auto& next_quads = c.hex_quads[next.block];
  const auto entry =
      static_cast<int>(std::find(next_quads.begin(), next_quads.end(), quad) - next_quads.begin());
  next.axis[d] = entry / 2;
  next.reversed[d] = (entry % 2 == 1) == (side == 1);
  // Along the face, an edge of the quad that runs along the box's axis shows the neighbour's axis.
  std::array<int, 3> corner{};
  corner[p.axis[d]] = face % 2;
  for (const int e : other_axes[d]) {
    std::array<int, 3> end = corner;
    corner[p.axis[e]] = p.reversed[e] ? 1 : 0;
    end[p.axis[e]] = p.reversed[e] ? 0 : 1;
    const auto& hex = c.hexes[p.block];
    const auto& other = c.hexes[next.block];
    const auto place = [&](const std::array<int, 3>& ijk) {
      const Index point = hex[hex_corner_at(ijk[0], ijk[1], ijk[2])];
      return hex_corner_ijk[std::find(other.begin(), other.end(), point) - other.begin()];
    };
    const auto from = place(corner), to = place(end);
    for (int a = 0; a < 3; ++a) {
      if (from[a] == to[a]) continue;
      next.axis[e] = a;
      next.reversed[e] = from[a] == 1;
    }
  }
  return next;
}

bool same(const BlockPlacement& a, const BlockPlacement& b) {
  return a.block == b.block && a.axis == b.axis && a.reversed == b.reversed;
}

Offset box_cells(const BlockMesh& mesh, const StructuredBlock& box) {
  return std::accumulate(box.blocks.begin(), box.blocks.end(), Offset{0}, [&](Offset sum, const auto& p) {
    return sum + mesh.block_begin(p.block + 1) - mesh.block_begin(p.block);
  });
}

/// Grows boxes over the blocks that no box has yet.
class BoxGrower {
 public:
  explicit BoxGrower(const BlockMesh& mesh)
      : mesh_(mesh), taken_(mesh.block_count(), 0), in_box_(mesh.block_count(), 0) {}

  bool taken(Index block) const { return taken_[block] != 0; }
  void take(const StructuredBlock& box) {
    for (const BlockPlacement& p : box.blocks) taken_[p.block] = 1;
  }

  /// The largest box around a block.
  StructuredBlock grow(Index start) {
    StructuredBlock best;
    Offset most = -1;
    for (const auto& order : axis_orders) {
      StructuredBlock box;
      BlockPlacement first;
      first.block = start;
      box.blocks = {first};
      ++round_;
      in_box_[start] = round_;
      for (const int d : order) {
        for (const int side : {1, 0}) {
          while (add_slab(box, d, side)) {
          }
        }
      }
      const Offset cells = box_cells(mesh_, box);
      if (cells > most) {
        most = cells;
        best = std::move(box);
      }
    }
    return best;
  }

 private:
  /// Adds one layer of blocks if all of it is free and fits together.
  bool add_slab(StructuredBlock& box, int d, int side) {
    const HexComplex& c = mesh_.complex();
    const auto [a, b] = other_axes[d];
    const auto& n = box.coarse;
    const std::array<Index, 3> step{1, n[0], n[0] * n[1]};
    std::vector<BlockPlacement> slab;
    for (Index v = 0; v < n[b]; ++v) {
      for (Index u = 0; u < n[a]; ++u) {
        const Index at = u * step[a] + v * step[b] + (side == 1 ? (n[d] - 1) * step[d] : 0);
        const BlockPlacement next = neighbour(c, box.blocks[at], d, side);
        const bool free = next.block != no_index && !taken(next.block) && in_box_[next.block] != round_;
        const bool fits = free && (u == 0 || same(neighbour(c, slab.back(), a, 1), next)) &&
                          (v == 0 || same(neighbour(c, slab[slab.size() - n[a]], b, 1), next));
        if (!fits) {
          for (const BlockPlacement& p : slab) in_box_[p.block] = 0;
          return false;
        }
        in_box_[next.block] = round_;
        slab.push_back(next);
      }
    }
    std::array<Index, 3> size = n;
    ++size[d];
    std::vector<BlockPlacement> blocks;
    blocks.reserve(box.blocks.size() + slab.size());
    const Index at_slab = side == 1 ? size[d] - 1 : 0;
    std::array<Index, 3> x{};
    for (x[2] = 0; x[2] < size[2]; ++x[2]) {
      for (x[1] = 0; x[1] < size[1]; ++x[1]) {
        for (x[0] = 0; x[0] < size[0]; ++x[0]) {
          if (x[d] == at_slab) {
            blocks.push_back(slab[x[a] + n[a] * x[b]]);
            continue;
          }
          std::array<Index, 3> old = x;
          if (side == 0) --old[d];
          blocks.push_back(box.blocks[old[0] * step[0] + old[1] * step[1] + old[2] * step[2]]);
        }
      }
    }
    box.blocks = std::move(blocks);
    box.coarse = size;
    return true;
  }

  const BlockMesh& mesh_;
  std::vector<char> taken_;
  std::vector<Index> in_box_;  ///< the round in which a block was put into the box that grows
  Index round_ = 0;
};

void set_starts(const BlockMesh& mesh, StructuredBlock& box) {
  const std::array<Index, 3> step{1, box.coarse[0], box.coarse[0] * box.coarse[1]};
  for (int d = 0; d < 3; ++d) {
    box.starts[d] = {0};
    for (Index x = 0; x < box.coarse[d]; ++x) {
      const BlockPlacement& p = box.blocks[x * step[d]];
      box.starts[d].push_back(box.starts[d].back() + mesh.dims(p.block)[p.axis[d]]);
    }
  }
}

/// Where a coarse block stands in the boxes.
struct BlockPlace {
  Index box = no_index;
  std::array<Index, 3> at{};
};

/// Cuts the faces of the boxes into windows.
class WindowMaker {
 public:
  WindowMaker(const BlockMesh& mesh, const std::vector<StructuredBlock>& boxes)
      : c_(mesh.complex()), boxes_(boxes), place_(mesh.block_count()), done_(c_.quads.size(), 0) {
    for (Index b = 0; b < static_cast<Index>(boxes.size()); ++b) {
      const auto& n = boxes[b].coarse;
      for (Index p = 0; p < static_cast<Index>(boxes[b].blocks.size()); ++p) {
        place_[boxes[b].blocks[p].block] = {b, {p % n[0], p / n[0] % n[1], p / n[0] / n[1]}};
      }
    }
  }

  std::vector<BlockWindow> make() {
    for (Index b = 0; b < static_cast<Index>(boxes_.size()); ++b) {
      for (int face = 0; face < 6; ++face) cut_face(b, face);
    }
    return std::move(windows_);
  }

 private:
  /// What one coarse quad of a face joins: windows hold quads whose links are equal. A point of the box is
  /// the donor's origin + the signed steps of `transform`.
  struct Link {
    Index patch = no_index, donor = no_index;
    std::array<int, 3> transform{};
    std::array<Index, 3> origin{};
    bool operator==(const Link&) const = default;
  };

  const BlockPlacement& placement(Index b, const std::array<Index, 3>& at) const {
    const auto& n = boxes_[b].coarse;
    return boxes_[b].blocks[at[0] + n[0] * (at[1] + n[1] * at[2])];
  }

  Index quad_at(Index b, int face, const std::array<Index, 3>& at) const {
    const BlockPlacement& p = placement(b, at);
    return c_.hex_quads[p.block][own_face(p, face / 2, face % 2)];
  }

  Link link(Index b, int face, const std::array<Index, 3>& at) const {
    Link result;
    const Index quad = quad_at(b, face, at);
    result.patch = c_.quad_patch[quad];
    if (c_.quad_hexes[quad][1] == no_index) return result;
    result.patch = no_index;
    const BlockPlacement next = neighbour(c_, placement(b, at), face / 2, face % 2);
    const BlockPlace& place = place_[next.block];
    const BlockPlacement& stored = placement(place.box, place.at);
    result.donor = place.box;
    // Each axis of this box is an axis of the block across, which is an axis of the donor.
    for (int d = 0; d < 3; ++d) {
      const auto e = static_cast<int>(std::find(stored.axis.begin(), stored.axis.end(), next.axis[d]) -
                                      stored.axis.begin());
      const bool backward = next.reversed[d] != stored.reversed[e];
      result.transform[d] = backward ? -(e + 1) : e + 1;
      // The near end of the block across along d, in this box and in the donor.
      const auto& starts = boxes_[b].starts[d];
      Index here = starts[at[d]];
      if (d == face / 2) {
        const Index length =
            boxes_[place.box].starts[e][place.at[e] + 1] - boxes_[place.box].starts[e][place.at[e]];
        here = face % 2 == 1 ? starts[at[d] + 1] : here - length;
      }
      const Index there = boxes_[place.box].starts[e][place.at[e] + (backward ? 1 : 0)];
      result.origin[e] = backward ? there + here : there - here;
    }
    return result;
  }

  void cut_face(Index b, int face) {
    const int d = face / 2;
    const auto [u, v] = other_axes[d];
    const auto& n = boxes_[b].coarse;
    const auto at = [&, u = u, v = v](Index x, Index y) {
      std::array<Index, 3> place{};
      place[d] = face % 2 == 0 ? 0 : n[d] - 1;
      place[u] = x;
      place[v] = y;
      return place;
    };
    // A quad between two faces is marked at once for both, also where a face is folded onto itself.
    const auto take = [&](Index x, Index y, const Link& wanted) {
      char& done = done_[quad_at(b, face, at(x, y))];
      if (done != 0 || !(link(b, face, at(x, y)) == wanted)) return false;
      return (done = 1) != 0;
    };
    const auto give_back = [&](Index x, Index y) { done_[quad_at(b, face, at(x, y))] = 0; };
    for (Index y = 0; y < n[v]; ++y) {
      for (Index x = 0; x < n[u]; ++x) {
        const Link wanted = link(b, face, at(x, y));
        if (!take(x, y, wanted)) continue;
        Index x_end = x + 1, y_end = y + 1;
        while (x_end < n[u] && take(x_end, y, wanted)) ++x_end;
        for (bool whole = true; whole && y_end < n[v];) {
          Index taken = x;
          while (taken < x_end && take(taken, y_end, wanted)) ++taken;
          whole = taken == x_end;
          if (whole) {
            ++y_end;
          } else {
            while (taken > x) give_back(--taken, y_end);
          }
        }
        add(b, face, at(x, y), at(x_end - 1, y_end - 1), wanted);
      }
    }
  }

  void add(Index b, int face, const std::array<Index, 3>& first, const std::array<Index, 3>& last,
           const Link& to) {
    const int d = face / 2;
    BlockWindow window;
    window.block = b;
    window.face = face;
    for (int e = 0; e < 3; ++e) {
      const auto& starts = boxes_[b].starts[e];
      window.low[e] = starts[first[e]];
      window.high[e] = starts[last[e] + 1];
    }
    window.low[d] = window.high[d] = face % 2 == 0 ? 0 : boxes_[b].starts[d].back();
    window.patch = to.patch;
    window.donor = to.donor;
    window.transform = to.transform;
    if (to.donor == no_index) {
      windows_.push_back(window);
      return;
    }
    BlockWindow opposite;
    opposite.block = to.donor;
    opposite.donor = b;
    for (int e = 0; e < 3; ++e) {
      const int there = std::abs(to.transform[e]) - 1, sign = to.transform[e] > 0 ? 1 : -1;
      window.donor_low[there] = to.origin[there] + sign * window.low[e];
      window.donor_high[there] = to.origin[there] + sign * window.high[e];
      opposite.transform[there] = sign * (e + 1);
      if (e == d) opposite.face = 2 * there + (window.donor_low[there] == 0 ? 0 : 1);
    }
    for (int e = 0; e < 3; ++e) {
      const bool swapped = window.donor_low[e] > window.donor_high[e];
      opposite.low[e] = swapped ? window.donor_high[e] : window.donor_low[e];
      opposite.high[e] = swapped ? window.donor_low[e] : window.donor_high[e];
      const int here = std::abs(opposite.transform[e]) - 1;
      opposite.donor_low[here] = swapped ? window.high[here] : window.low[here];
      opposite.donor_high[here] = swapped ? window.low[here] : window.high[here];
    }
    windows_.push_back(window);
    windows_.push_back(opposite);
  }

  const HexComplex& c_;
  const std::vector<StructuredBlock>& boxes_;
  std::vector<BlockPlace> place_;
  std::vector<char> done_;  ///< coarse quads that are in a window
  std::vector<BlockWindow> windows_;
};

/// A point (thickness 0) or cell (thickness 1) of a box as its coarse block counts it.
struct PlaceInBlock {
  Index block = no_index;
  std::array<Index, 3> ijk{};
};

PlaceInBlock place_in_block(const BlockMesh& mesh, const StructuredBlock& box,
                            const std::array<Index, 3>& ijk, Index thickness) {
  std::array<Index, 3> at{}, inside{};
  for (int d = 0; d < 3; ++d) {
    const auto& starts = box.starts[d];
    const auto after = std::upper_bound(starts.begin() + 1, starts.end() - 1, ijk[d]);
    at[d] = static_cast<Index>(after - starts.begin()) - 1;
    inside[d] = ijk[d] - starts[at[d]];
  }
  const BlockPlacement& p = box.blocks[at[0] + box.coarse[0] * (at[1] + box.coarse[1] * at[2])];
  PlaceInBlock place{p.block, {}};
  const auto dims = mesh.dims(p.block);
  for (int d = 0; d < 3; ++d) {
    const int own = p.axis[d];
    place.ijk[own] = p.reversed[d] ? dims[own] - thickness - inside[d] : inside[d];
  }
  return place;
}

}  // namespace

StructuredBlocks merge_blocks(const BlockMesh& mesh, const MergeSettings& settings) {
  BoxGrower grower(mesh);
  StructuredBlocks result;
  const Index count = mesh.block_count();
  for (Index start = 0; start < count;) {
    if (grower.taken(start)) {
      ++start;
      continue;
    }
    StructuredBlock best = grower.grow(start);
    for (Index other = start + 1; count <= settings.any_start_up_to && other < count; ++other) {
      if (grower.taken(other)) continue;
      StructuredBlock box = grower.grow(other);
      if (box_cells(mesh, box) > box_cells(mesh, best)) best = std::move(box);
    }
    grower.take(best);
    set_starts(mesh, best);
    result.blocks.push_back(std::move(best));
  }
  result.windows = WindowMaker(mesh, result.blocks).make();
  return result;
}

Index point_number(const BlockMesh& mesh, const StructuredBlock& block, const std::array<Index, 3>& ijk) {
  const PlaceInBlock at = place_in_block(mesh, block, ijk, 0);
  return mesh.point_number(at.block, at.ijk[0], at.ijk[1], at.ijk[2]);
}

Offset cell_number(const BlockMesh& mesh, const StructuredBlock& block, const std::array<Index, 3>& ijk) {
  const PlaceInBlock at = place_in_block(mesh, block, ijk, 1);
  const auto dims = mesh.dims(at.block);
  return mesh.block_begin(at.block) + at.ijk[0] + Offset{dims[0]} * (at.ijk[1] + Offset{dims[1]} * at.ijk[2]);
}

BlockMesh blocks_of_cells(const HexView& mesh) {
  std::vector<HexPoints> cells(static_cast<std::size_t>(mesh.cell_count()));
  mesh.read_cells(0, cells);
  std::vector<HexComplex::Patch> patches;
  std::vector<BoundaryQuad> quads;
  for (const BoundaryPatch& patch : mesh.patches()) {
    for (const auto& quad : patch.quads) quads.push_back({quad, static_cast<Index>(patches.size())});
    patches.push_back({patch.name, patch.type});
  }
  return BlockMesh(std::make_shared<const HexComplex>(build_hex_complex(
      {mesh.points().begin(), mesh.points().end()}, std::move(cells), std::move(patches), quads, {})));
}

}  // namespace flowcage
