#include "core/volume/refine_volume.hpp"

#include "core/base/parallel.hpp"
#include "core/mesh/hex_numbering.hpp"
#include "core/volume/complex_incidence.hpp"
#include "core/volume/volume_masks.hpp"

namespace flowcage {
namespace {

/// base + sum of w (p - base): exact in a coordinate that all points share.
class Combination {
 public:
  explicit Combination(const Vec3& base) : base_(base) {}
  void add(double weight, const Vec3& p) { sum_ += weight * (p - base_); }
  Vec3 value(double scale = 1) const { return base_ + sum_ * scale; }

 private:
  Vec3 base_;
  Vec3 sum_ = Vec3::Zero();
};

/// Child lattices are the parent's doubled: child (I,J,K) is at (I,J,K)/2 of the parent's block.
class VolumeRefinement {
 public:
  VolumeRefinement(const BlockMesh& parent, BlockMesh& child)
      : parent_(parent), child_(child), near_(incidence_of(parent.complex())), out_(child.mutable_points()) {
    for (int a = 0; a < 3; ++a) {
      for (int b = 0; b < 3; ++b) {
        for (int c = 0; c < 3; ++c) regular_[a][b][c] = cell_mask({a, b, c}, 4);
      }
    }
  }

  void run() {
    const HexComplex& c = parent_.complex();
    const auto each = [](Offset count, Offset grain, auto&& one) {
      parallel_for(count, grain, [&](Offset begin, Offset end) {
        for (Offset n = begin; n < end; ++n) one(static_cast<Index>(n));
      });
    };
    each(static_cast<Offset>(c.points.size()), 64, [&](Index v) { corner(v); });
    each(static_cast<Offset>(c.edges.size()), 16,
         [&](Index e) { near_.edge_boundary_quads.row_size(e) > 0 ? boundary_edge(e) : inner_edge(e); });
    each(static_cast<Offset>(c.quads.size()), 4,
         [&](Index q) { c.quad_patch[q] != no_index ? boundary_quad(q) : inner_quad(q); });
    std::vector<Offset> first_layer{
        0};  // of each block, in the list of all child layers between the surfaces
    for (Index b = 0; b < child_.block_count(); ++b)
      first_layer.push_back(first_layer.back() + child_.dims(b)[2] - 1);
    parallel_for(first_layer.back(), 8, [&](Offset begin, Offset end) {
      Layers layers;
      auto block = static_cast<Index>(std::upper_bound(first_layer.begin(), first_layer.end(), begin) -
                                      first_layer.begin() - 1);
      for (Offset n = begin; n < end; ++n) {
        while (n >= first_layer[block + 1]) ++block;
        block_layer(block, static_cast<Index>(n - first_layer[block]) + 1, layers);
      }
    });
  }

 private:
  using Lattice = std::array<Index, 3>;

  const Vec3& point(Index block, const Lattice& at) const {
    return parent_.points()[parent_.point_number(block, at[0], at[1], at[2])];
  }

  /// Adds what the block's cells at child point `at` give to it; returns their number.
  int add_cells(Index block, const Lattice& at, Index cells_at_edge, Combination& sum) const {
    const auto n = parent_.dims(block);
    std::array<Index, 3> low{};
    std::array<Index, 3> high{};
    for (int axis = 0; axis < 3; ++axis) {
      low[axis] = std::max<Index>(0, (at[axis] - 1) / 2);  // odd: the one cell; even: the cells on both sides
      high[axis] = std::min<Index>(n[axis] - 1, at[axis] / 2);
    }
    int cells = 0;
    for (Index k = low[2]; k <= high[2]; ++k) {
      for (Index j = low[1]; j <= high[1]; ++j) {
        for (Index i = low[0]; i <= high[0]; ++i, ++cells) {
          const std::array<int, 3> site{at[0] - 2 * i, at[1] - 2 * j, at[2] - 2 * k};
          const auto mask =
              cells_at_edge == 4 ? regular_[site[0]][site[1]][site[2]] : cell_mask(site, cells_at_edge);
          for (int c = 0; c < 8; ++c) {
            const auto& s = hex_corner_ijk[c];
            sum.add(mask[c], point(block, {i + s[0], j + s[1], k + s[2]}));
          }
        }
      }
    }
    return cells;
  }

  /// Child lattice of the point at t on a block's edge `slot`, t running as the block's axis does.
  Lattice on_edge(Index block, int slot, Index t) const {
    const auto n = child_.dims(block);
    Lattice at{};
    const auto& low = hex_corner_ijk[hex_edges[slot][0]];
    for (int axis = 0; axis < 3; ++axis) at[axis] = axis == slot / 4 ? t : low[axis] * n[axis];
    return at;
  }

  bool runs_forward(Index edge, Index block, int slot) const {
    const HexComplex& c = parent_.complex();
    return c.edges[edge][0] == c.hexes[block][hex_edges[slot][0]];
  }

  void inner_edge(Index e) {
    const auto blocks = near_.edge_hexes[e];
    const Index n = child_.dims(blocks[0].element)[blocks[0].place / 4];
    for (Index t = 1; t < n; ++t) {
      Combination sum(point_on_edge(e, t / 2));
      int cells = 0;
      for (const auto& [block, slot] : blocks) {
        const Index along = runs_forward(e, block, slot) ? t : n - t;
        cells += add_cells(block, on_edge(block, slot, along), static_cast<Index>(blocks.size()), sum);
      }
      out_[child_.edge_points(e) + t - 1] = sum.value(1.0 / cells);
    }
  }

  const Vec3& point_on_edge(Index e, Index t) const {  // of the parent
    const auto& [block, slot] = near_.edge_hexes[e][0];
    const Index n = parent_.dims(block)[slot / 4];
    const auto& low = hex_corner_ijk[hex_edges[slot][0]];
    Lattice at{};
    const auto dims = parent_.dims(block);
    for (int axis = 0; axis < 3; ++axis) at[axis] = low[axis] * dims[axis];
    at[slot / 4] = runs_forward(e, block, slot) ? t : n - t;
    return point(block, at);
  }

  void inner_quad(Index q) {
    const HexComplex& c = parent_.complex();
    const QuadLattice own = child_.quad_lattice(q);
    // The other block sees the same points in a lattice of its own.
    const QuadLattice other = lattice_in(q, c.quad_hexes[q][1]);
    for (Index v = 1; v < own.nv; ++v) {
      for (Index u = 1; u < own.nu; ++u) {
        const Lattice here = at(own, u, v);
        Combination sum(point(own.block, {here[0] / 2, here[1] / 2, here[2] / 2}));
        int cells = add_cells(own.block, here, 4, sum);
        cells += add_cells(other.block, at(other, u, v), 4, sum);
        out_[child_.point_number(own, u, v)] = sum.value(1.0 / cells);
      }
    }
  }

  static Lattice at(const QuadLattice& lattice, Index u, Index v) {
    Lattice result{};
    for (int axis = 0; axis < 3; ++axis) {
      result[axis] = lattice.origin[axis] + u * lattice.du[axis] + v * lattice.dv[axis];
    }
    return result;
  }

  QuadLattice lattice_in(Index q, Index block) const {
    const HexComplex& c = parent_.complex();
    const HexPoints& hex = c.hexes[block];
    const auto corner = [&](int n) {
      return hex_corner_ijk[std::find(hex.begin(), hex.end(), c.quads[q][n]) - hex.begin()];
    };
    QuadLattice lattice;
    lattice.block = block;
    const auto dims = child_.dims(block);
    for (int axis = 0; axis < 3; ++axis) {
      lattice.origin[axis] = corner(0)[axis] * dims[axis];
      lattice.du[axis] = corner(1)[axis] - corner(0)[axis];
      lattice.dv[axis] = corner(3)[axis] - corner(0)[axis];
    }
    return lattice;
  }

  // ---- the boundary surface ----

  /// A boundary quad seen from its corner `turn`: u along the side that leaves that corner, v along the side
  /// that enters it.
  struct TurnedQuad {
    QuadLattice lattice;
    int turn = 0;
    Index nu = 1, nv = 1;
  };
  TurnedQuad turned(Index q, int turn) const {
    TurnedQuad result{parent_.quad_lattice(q), turn, 1, 1};
    result.nu = turn % 2 == 0 ? result.lattice.nu : result.lattice.nv;
    result.nv = turn % 2 == 0 ? result.lattice.nv : result.lattice.nu;
    return result;
  }
  const Vec3& quad_point(const TurnedQuad& q, Index u, Index v) const {
    const Index nu = q.lattice.nu;
    const Index nv = q.lattice.nv;
    Index a = u;
    Index b = v;
    if (q.turn == 1) {
      a = nu - v;
      b = u;
    }
    if (q.turn == 2) {
      a = nu - u;
      b = nv - v;
    }
    if (q.turn == 3) {
      a = v;
      b = nv - u;
    }
    return parent_.points()[parent_.point_number(q.lattice, a, b)];
  }

  void boundary_quad(Index q) {
    const TurnedQuad quad = turned(q, 0);
    const QuadLattice own = child_.quad_lattice(q);
    const auto vertex_mask = quad_vertex_mask(4);
    const auto edge_mask = quad_edge_mask();
    const auto add = [&](Combination& sum, const std::array<double, 4>& mask, Lattice uv, Lattice step) {
      // The quad's cell with corner 0 at uv, its first side along step[0] of u or v.
      const auto [u, v, unused] = uv;
      const auto [du, dv, swapped] = step;
      sum.add(mask[0], quad_point(quad, u, v));
      sum.add(mask[2], quad_point(quad, u + du, v + dv));
      sum.add(mask[swapped != 0 ? 3 : 1], quad_point(quad, u + du, v));
      sum.add(mask[swapped != 0 ? 1 : 3], quad_point(quad, u, v + dv));
    };
    for (Index v = 1; v < own.nv; ++v) {
      for (Index u = 1; u < own.nu; ++u) {
        const Index pu = u / 2;
        const Index pv = v / 2;
        Combination sum(quad_point(quad, pu, pv));
        double scale = 1;
        if (u % 2 != 0 && v % 2 != 0) {
          add(sum, {0.25, 0.25, 0.25, 0.25}, {pu, pv, 0}, {1, 1, 0});
        } else if (u % 2 != 0) {
          for (const Index dv : {1, -1}) add(sum, edge_mask, {pu, pv, 0}, {1, dv, 0});
          scale = 0.5;
        } else if (v % 2 != 0) {
          for (const Index du : {1, -1}) add(sum, edge_mask, {pu, pv, 0}, {du, 1, 1});
          scale = 0.5;
        } else {
          for (const Index dv : {1, -1}) {
            for (const Index du : {1, -1}) add(sum, vertex_mask, {pu, pv, 0}, {du, dv, 0});
          }
          scale = 0.25;
        }
        out_[child_.point_number(own, u, v)] = sum.value(scale);
      }
    }
  }

  void boundary_edge(Index e) {
    const HexComplex& c = parent_.complex();
    const double sharpness = c.edge_sharpness[e];
    const auto quads = near_.edge_boundary_quads[e];
    const auto& [block, slot] = near_.edge_hexes[e][0];
    const Index n = child_.dims(block)[slot / 4];
    std::array<TurnedQuad, 2> side{turned(quads[0].element, quads[0].place),
                                   turned(quads[1].element, quads[1].place)};
    // A quad's side runs from its corner `place`; t from edges[e][0].
    const auto cross = [&](int s, Index t, Index depth) -> const Vec3& {
      const bool forward = c.quads[quads[s].element][quads[s].place] == c.edges[e][0];
      return quad_point(side[s], forward ? t : n / 2 - t, depth);
    };
    for (Index t = 1; t < n; ++t) {
      const Index p = t / 2;
      Combination sum(point_on_edge(e, p));
      if (t % 2 != 0) {
        const double sharp = std::min(1.0, sharpness);
        const auto mask = quad_edge_mask();
        sum.add(sharp / 2, point_on_edge(e, p));
        sum.add(sharp / 2, point_on_edge(e, p + 1));
        for (int s = 0; s < 2 && sharp < 1; ++s) {
          const double w = (1 - sharp) / 2;
          sum.add(w * mask[0], point_on_edge(e, p));
          sum.add(w * mask[1], point_on_edge(e, p + 1));
          sum.add(w * mask[2], cross(s, p + 1, 1));
          sum.add(w * mask[3], cross(s, p, 1));
        }
      } else {
        const std::array<double, 4> around{sharpness, 0, sharpness, 0};
        const VertexRule rule = vertex_rule(around, 0);
        sum.add(rule.crease / 8, point_on_edge(e, p - 1));
        sum.add(rule.crease / 8, point_on_edge(e, p + 1));
        const auto mask = quad_vertex_mask(4);
        for (int s = 0; s < 2 && rule.smooth > 0; ++s) {
          for (const Index step : {-1, 1}) {
            const double w = rule.smooth / 4;
            sum.add(w * mask[1], point_on_edge(e, p + step));
            sum.add(w * mask[2], cross(s, p + step, 1));
            sum.add(w * mask[3], cross(s, p, 1));
          }
        }
      }
      out_[child_.edge_points(e) + t - 1] = sum.value();
    }
  }

  void corner(Index v) {
    const HexComplex& c = parent_.complex();
    const Vec3 here = parent_.points()[v];
    const auto quads = near_.corner_boundary_quads[v];
    Combination sum(here);
    if (quads.empty()) {
      int cells = 0;
      for (const auto& [block, place] : near_.corner_hexes[v]) {
        const auto n = child_.dims(block);
        const auto& s = hex_corner_ijk[place];
        cells += add_cells(block, {s[0] * n[0], s[1] * n[1], s[2] * n[2]}, 4, sum);
      }
      out_[v] = sum.value(1.0 / cells);
      return;
    }
    const auto edges = near_.corner_boundary_edges[v];
    std::vector<double> sharpness;
    for (const Index e : edges) sharpness.push_back(c.edge_sharpness[e]);
    const VertexRule rule = vertex_rule(sharpness, c.corner_sharpness[v]);
    if (rule.crease > 0) {
      for (const Index place : rule.crease_edges) {
        const Index e = edges[place];
        const Index n = edge_divisions(e);
        sum.add(rule.crease / 8, point_on_edge(e, c.edges[e][0] == v ? 1 : n - 1));
      }
    }
    if (rule.smooth > 0) {
      const auto mask = quad_vertex_mask(static_cast<Index>(quads.size()));
      const double w = rule.smooth / static_cast<double>(quads.size());
      for (const auto& [q, place] : quads) {
        const TurnedQuad quad = turned(q, place);
        sum.add(w * mask[1], quad_point(quad, 1, 0));
        sum.add(w * mask[2], quad_point(quad, 1, 1));
        sum.add(w * mask[3], quad_point(quad, 0, 1));
      }
    }
    out_[v] = sum.value();
  }

  Index edge_divisions(Index e) const { return parent_.chord_divisions()[parent_.complex().edge_chord[e]]; }

  // ---- the inside of blocks: regular, so the rules are tensor products of (1 6 1)/8 and (1 1)/2 ----

  struct Layers {
    std::vector<Vec3> across;  ///< the parent's layers combined along k
    std::vector<Vec3> row;     ///< and along j
  };

  void block_layer(Index block, Index k, Layers& buffers) {
    const auto n = parent_.dims(block);
    const Index width = n[0] + 1;
    const auto points = parent_.points();
    const auto weights = [](Index at) {
      return at % 2 != 0 ? std::array<double, 3>{0, 0.5, 0.5} : std::array<double, 3>{0.125, 0.75, 0.125};
    };
    buffers.across.assign(static_cast<std::size_t>(width) * (n[1] + 1), Vec3::Zero());
    buffers.row.resize(width);
    const auto wk = weights(k);
    for (int s = 0; s < 3; ++s) {
      if (wk[s] == 0) continue;
      for (Index j = 0; j <= n[1]; ++j) {
        for (Index i = 0; i <= n[0]; ++i) {
          buffers.across[i + width * j] += wk[s] * points[parent_.point_number(block, i, j, k / 2 + s - 1)];
        }
      }
    }
    for (Index j = 1; j < 2 * n[1]; ++j) {
      const auto wj = weights(j);
      for (Index i = 0; i < width; ++i) {
        Vec3 p =
            wj[1] * buffers.across[i + width * (j / 2)] + wj[2] * buffers.across[i + width * (j / 2 + 1)];
        if (wj[0] != 0) p += wj[0] * buffers.across[i + width * (j / 2 - 1)];
        buffers.row[i] = p;
      }
      Vec3* out = &out_[child_.hex_points(block) + (2 * n[0] - 1) * ((j - 1) + (2 * n[1] - 1) * (k - 1))];
      for (Index i = 1; i < 2 * n[0]; ++i) {
        const Vec3* at = &buffers.row[i / 2];
        *out++ = i % 2 != 0 ? Vec3((at[0] + at[1]) / 2) : Vec3(0.75 * at[0] + 0.125 * (at[-1] + at[1]));
      }
    }
  }

  const BlockMesh& parent_;
  BlockMesh& child_;
  ComplexIncidence near_;
  std::vector<Vec3>& out_;
  std::array<std::array<std::array<std::array<double, 8>, 3>, 3>, 3> regular_{};
};

std::shared_ptr<const HexComplex> decayed_complex(const BlockMesh& parent) {
  const HexComplex& c = parent.complex();
  const auto semi_sharp = [](double s) { return s > 0 && s < infinitely_sharp; };
  if (std::none_of(c.edge_sharpness.begin(), c.edge_sharpness.end(), semi_sharp) &&
      std::none_of(c.corner_sharpness.begin(), c.corner_sharpness.end(), semi_sharp)) {
    return parent.shared_complex();
  }
  auto copy = std::make_shared<HexComplex>(c);
  for (double& s : copy->edge_sharpness) s = decayed(s);
  for (double& s : copy->corner_sharpness) s = decayed(s);
  return copy;
}

}  // namespace

BlockMesh refine_volume(const BlockMesh& parent) {
  std::vector<Index> divisions = parent.chord_divisions();
  for (Index& d : divisions) d *= 2;
  const auto complex = decayed_complex(parent);
  std::vector<Vec3> points(BlockMesh::point_count(*complex, divisions));
  BlockMesh child(complex, std::move(divisions), std::move(points));
  VolumeRefinement(parent, child).run();
  return child;
}

}  // namespace flowcage
