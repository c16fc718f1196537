#include "core/volume/complex_incidence.hpp"

#include <algorithm>

namespace flowcage {
namespace {

template <typename T>
struct Entry {
  Index row;
  T value;
};

/// Entries sorted into rows; the order within a row is that of the entries.
template <typename T>
Csr<T> rows_of(const std::vector<Entry<T>>& entries, std::size_t row_count) {
  Csr<T> csr;
  csr.offsets.assign(row_count + 1, 0);
  for (const auto& e : entries) ++csr.offsets[e.row + 1];
  for (std::size_t r = 0; r < row_count; ++r) csr.offsets[r + 1] += csr.offsets[r];
  csr.values.resize(entries.size());
  std::vector<Offset> next(csr.offsets.begin(), csr.offsets.end() - 1);
  for (const auto& e : entries) csr.values[next[e.row]++] = e.value;
  return csr;
}

}  // namespace

ComplexIncidence incidence_of(const HexComplex& c) {
  using Slot = ComplexIncidence::Slot;
  std::vector<Entry<Slot>> edge_hexes;
  std::vector<Entry<Slot>> corner_hexes;
  for (Index h = 0; h < static_cast<Index>(c.hexes.size()); ++h) {
    for (int s = 0; s < 12; ++s) edge_hexes.push_back({c.hex_edges[h][s], {h, s}});
    for (int s = 0; s < 8; ++s) corner_hexes.push_back({c.hexes[h][s], {h, s}});
  }
  std::vector<Entry<Slot>> edge_quads;
  std::vector<Entry<Slot>> corner_quads;
  for (Index q = 0; q < static_cast<Index>(c.quads.size()); ++q) {
    if (c.quad_patch[q] == no_index) continue;
    for (int s = 0; s < 4; ++s) {
      const Index a = c.quads[q][s];
      const Index b = c.quads[q][(s + 1) % 4];
      corner_quads.push_back({a, {q, s}});
      const auto& edges = c.hex_edges[c.quad_hexes[q][0]];
      const auto edge = std::find_if(edges.begin(), edges.end(), [&](Index e) {
        return c.edges[e] == std::array<Index, 2>{std::min(a, b), std::max(a, b)};
      });
      edge_quads.push_back({*edge, {q, s}});
    }
  }
  ComplexIncidence result;
  result.edge_hexes = rows_of(edge_hexes, c.edges.size());
  result.corner_hexes = rows_of(corner_hexes, c.points.size());
  result.edge_boundary_quads = rows_of(edge_quads, c.edges.size());
  result.corner_boundary_quads = rows_of(corner_quads, c.points.size());
  std::vector<Entry<Index>> corner_edges;
  for (Index e = 0; e < static_cast<Index>(c.edges.size()); ++e) {
    if (result.edge_boundary_quads.row_size(e) == 0) continue;
    for (const Index v : c.edges[e]) corner_edges.push_back({v, e});
  }
  result.corner_boundary_edges = rows_of(corner_edges, c.points.size());
  return result;
}

}  // namespace flowcage
