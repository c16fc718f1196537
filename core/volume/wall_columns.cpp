#include "core/volume/wall_columns.hpp"

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "core/base/parallel.hpp"
#include "core/mesh/hex_numbering.hpp"

namespace flowcage {
namespace {

/// Scaled Jacobian at the worst corner of the hex over a wall face between layers k and k + 1.
double worst_corner(const std::array<Vec3, 8>& p) {
  std::array<Vec3, 12> edge;
  std::array<double, 12> square;
  for (int e = 0; e < 12; ++e) {
    edge[e] = p[hex_edges[e][1]] - p[hex_edges[e][0]];
    square[e] = edge[e].squaredNorm();
  }
  double worst = 1;
  for (int c = 0; c < 8; ++c) {
    const auto [i, j, k] = hex_corner_ijk[c];
    const int a = j + 2 * k, b = 4 + i + 2 * k, d = 8 + i + 2 * j;
    // Edges run along their axis: right-handed at every corner, as both ends see the same three directions.
    const double value = edge[a].cross(edge[b]).dot(edge[d]) / std::sqrt(square[a] * square[b] * square[d]);
    worst = std::min(worst, std::isfinite(value) ? value : -1);
  }
  return worst;
}

}  // namespace

WallColumns wall_columns(const BlockMesh& mesh, const WallBlocks& blocks, Index chord) {
  WallColumns columns;
  columns.layers = line_layers(mesh, blocks, chord);
  std::vector<Index> faces;
  for (Index f = 0; f < blocks.wall.face_count(); ++f) {
    if (chord == no_index || seat_edge(blocks, f).chord == chord) faces.push_back(f);
  }
  // By a line's first two points: where the wall is cut, several lines leave one of its points.
  std::unordered_map<std::uint64_t, Index> line_at;
  const auto first_points = [&](const WallLine& line) {
    const PointRow row = line_points(mesh, blocks, line);
    return static_cast<std::uint64_t>(row[0]) << 32 | static_cast<std::uint64_t>(row[1]);
  };
  std::vector<Index> lattice;  // lines at the lattice places of each face, i fastest
  const auto divisions = [&](Index f) {
    // Chords of the face's first and last side.
    const auto n = mesh.dims(blocks.seats[f].block);
    const WallSeat& seat = blocks.seats[f];
    std::array<Index, 2> out{1, 1};
    for (int a = 0; a < 3; ++a) {
      const auto at = [&](int c) { return hex_corner_ijk[seat.foot[c]][a]; };
      if (at(1) != at(0)) out[0] = n[a];
      if (at(3) != at(0)) out[1] = n[a];
    }
    return out;
  };
  for (const Index f : faces) {
    const auto n = divisions(f);
    for (Index j = 0; j <= n[1]; ++j) {
      for (Index i = 0; i <= n[0]; ++i) {
        const auto number = static_cast<Index>(columns.lines.size());
        const auto [found, fresh] = line_at.try_emplace(first_points({f, i, j}), number);
        if (fresh) columns.lines.push_back({f, i, j});
        lattice.push_back(found->second);
      }
    }
  }
  std::size_t first = 0;
  for (const Index f : faces) {
    const auto n = divisions(f);
    const auto at = [&](Index i, Index j) { return lattice[first + i + (n[0] + 1) * std::size_t(j)]; };
    for (Index j = 0; j < n[1]; ++j) {
      for (Index i = 0; i < n[0]; ++i) {
        const std::array<Index, 4> face{at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)};
        columns.faces.push_back(face);
        for (int c = 0; c < 4; ++c) {
          const auto [low, high] = std::minmax(face[c], face[(c + 1) % 4]);
          columns.edges.push_back({low, high});
        }
      }
    }
    first += static_cast<std::size_t>(n[0] + 1) * (n[1] + 1);
  }
  std::sort(columns.edges.begin(), columns.edges.end());
  columns.rim.assign(columns.lines.size(), 0);
  const auto in_plane = [&](Index l) {
    const Vec3& p = mesh.points()[line_point(mesh, blocks, columns.lines[l], 0)];
    return blocks.symmetry && blocks.symmetry->distance(p) == 0;
  };
  for (std::size_t e = 0; e < columns.edges.size(); ++e) {
    const bool paired = (e > 0 && columns.edges[e - 1] == columns.edges[e]) ||
                        (e + 1 < columns.edges.size() && columns.edges[e + 1] == columns.edges[e]);
    const auto& [a, b] = columns.edges[e];
    if (paired || (in_plane(a) && in_plane(b))) continue;
    columns.rim[a] = columns.rim[b] = 1;
  }
  columns.edges.erase(std::unique(columns.edges.begin(), columns.edges.end()), columns.edges.end());
  return columns;
}

std::vector<Vec3> line_positions(const BlockMesh& mesh, const WallBlocks& blocks, const WallLine& line,
                                 Index layers) {
  const PointRow row = line_points(mesh, blocks, line);
  std::vector<Vec3> out(layers + 1);
  for (Index k = 0; k <= layers; ++k) out[k] = mesh.points()[row[k]];
  return out;
}

std::vector<float> column_values(const BlockMesh& mesh, const WallBlocks& blocks,
                                 const WallColumns& columns) {
  std::vector<float> values(columns.faces.size() * static_cast<std::size_t>(columns.layers));
  update_column_values(mesh, blocks, columns, {}, values);
  return values;
}

void update_column_values(const BlockMesh& mesh, const WallBlocks& blocks, const WallColumns& columns,
                          std::span<const char> moved, std::vector<float>& values) {
  const auto faces = static_cast<Offset>(columns.faces.size());
  const auto points = mesh.points();
  parallel_for(faces, 64, [&](Offset begin, Offset end) {
    for (Offset f = begin; f < end; ++f) {
      const std::array<Index, 4>& face = columns.faces[f];
      if (!moved.empty() && std::none_of(face.begin(), face.end(), [&](Index l) { return moved[l] != 0; })) {
        continue;
      }
      std::array<PointRow, 4> rows;
      std::array<Vec3, 8> p;
      for (int c = 0; c < 4; ++c) {
        rows[c] = line_points(mesh, blocks, columns.lines[face[c]]);
        p[c + 4] = points[rows[c][0]];
      }
      for (Index k = 1; k <= columns.layers; ++k) {
        for (int c = 0; c < 4; ++c) {
          p[c] = p[c + 4];
          p[c + 4] = points[rows[c][k]];
        }
        values[f + faces * (k - 1)] = static_cast<float>(worst_corner(p));
      }
    }
  });
}

void flatten_symmetry(BlockMesh& mesh, const WallBlocks& blocks) {
  if (!blocks.symmetry) return;
  for (const BoundaryPatch& patch : mesh.patches()) {
    if (patch.type != PatchType::symmetry) continue;
    for (const auto& quad : patch.quads) {
      for (const Index v : quad) blocks.symmetry->flatten(mesh.mutable_points()[v]);
    }
  }
}

}  // namespace flowcage
