#include "core/volume/start_swept.hpp"

#include <algorithm>

#include "core/mesh/hex_numbering.hpp"
#include "core/volume/wall_lines.hpp"

namespace flowcage {

BlockMesh start_swept_volume(const SweptBlocks& swept, std::span<const Vec3> level_points, Index layers) {
  const HexComplex& complex = *swept.blocks.complex;
  std::vector<Vec3> corners = complex.points;
  const SurfaceLevel& wall = swept.blocks.wall;
  for (Index f = 0; f < wall.face_count(); ++f) {
    const WallSeat& seat = swept.blocks.seats[f];
    for (int c = 0; c < 4; ++c) {
      corners[complex.hexes[seat.block][seat.foot[c]]] =
          level_points[swept.cage_vertex[wall.face_vertices[f][c]]];
    }
  }
  // Outward chords and their mean lengths; each edge's near end has fewer bits.
  std::vector<double> length(complex.chord_count, 0);
  std::vector<Index> count(complex.chord_count, 0);
  for (std::size_t e = 0; e < complex.edges.size(); ++e) {
    const auto& [a, b] = complex.edges[e];
    if (swept.outward[a] == swept.outward[b]) continue;
    length[complex.edge_chord[e]] += (corners[a] - corners[b]).norm();
    ++count[complex.edge_chord[e]];
  }
  std::vector<double> edges;
  for (const auto& [a, b] : wall.edge_vertices) {
    edges.push_back((level_points[swept.cage_vertex[a]] - level_points[swept.cage_vertex[b]]).norm());
  }
  std::nth_element(edges.begin(), edges.begin() + static_cast<long>(edges.size() / 2), edges.end());
  const double wall_cell = edges[edges.size() / 2];
  std::vector<Index> divisions(complex.chord_count, 1);
  std::vector<std::vector<double>> along(complex.chord_count, {0, 1});
  for (Index c = 0; c < complex.chord_count; ++c) {
    if (count[c] == 0) continue;
    divisions[c] = layers;
    along[c] = {0};
    const double mean = length[c] / count[c];
    for (const double cell : geometric_cells(mean, layers, wall_cell, 3)) {
      along[c].push_back(along[c].back() + cell / mean);
    }
  }
  const Index points = BlockMesh::point_count(complex, divisions);
  BlockMesh mesh(swept.blocks.complex, divisions, std::vector<Vec3>(points, Vec3::Zero()));
  std::vector<Vec3>& places = mesh.mutable_points();
  for (std::size_t h = 0; h < complex.hexes.size(); ++h) {
    const HexPoints& hex = complex.hexes[h];
    // A parameter along each axis, from the near end.
    std::array<std::vector<double>, 3> t;
    for (int axis = 0; axis < 3; ++axis) {
      const int first = 4 * axis;
      t[axis] = along[complex.edge_chord[complex.hex_edges[h][first]]];
      const auto& [a, b] = hex_edges[first];
      if (swept.outward[hex[a]] <= swept.outward[hex[b]]) continue;
      std::reverse(t[axis].begin(), t[axis].end());
      for (double& value : t[axis]) value = 1 - value;
    }
    const auto n = mesh.dims(static_cast<Index>(h));
    for (Index k = 0; k <= n[2]; ++k) {
      for (Index j = 0; j <= n[1]; ++j) {
        for (Index i = 0; i <= n[0]; ++i) {
          Vec3 p = Vec3::Zero();
          for (int c = 0; c < 8; ++c) {
            const auto& at = hex_corner_ijk[c];
            const auto weight = [&](int axis, Index m) {
              return at[axis] == 1 ? t[axis][m] : 1 - t[axis][m];
            };
            p += weight(0, i) * weight(1, j) * weight(2, k) * corners[hex[c]];
          }
          places[mesh.point_number(static_cast<Index>(h), i, j, k)] = p;
        }
      }
    }
  }
  return mesh;
}

}  // namespace flowcage
