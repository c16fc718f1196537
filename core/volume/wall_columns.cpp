#include "core/volume/wall_columns.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "core/base/parallel.hpp"
#include "core/mesh/hex_numbering.hpp"

namespace flowcage {
namespace {

/// Scaled Jacobian at the worst corner of the hex over a wall face between layers k and k + 1.
double worst_corner(const std::array<Vec3, 8>& p) {
  double worst = 1;
  for (int c = 0; c < 8; ++c) {
    const auto [i, j, k] = hex_corner_ijk[c];
    Vec3 a = p[hex_corner_at(1 - i, j, k)] - p[c];
    Vec3 b = p[hex_corner_at(i, 1 - j, k)] - p[c];
    Vec3 d = p[hex_corner_at(i, j, 1 - k)] - p[c];
    const double sign = ((i + j + k) % 2 == 0 ? 1 : -1) / (a.norm() * b.norm() * d.norm());
    const double value = sign * a.cross(b).dot(d);
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
  std::map<std::array<Index, 2>, Index> line_at;
  const auto first_points = [&](const WallLine& line) {
    return std::array<Index, 2>{line_point(mesh, blocks, line, 0), line_point(mesh, blocks, line, 1)};
  };
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
        if (line_at.try_emplace(first_points({f, i, j}), number).second) columns.lines.push_back({f, i, j});
      }
    }
  }
  for (const Index f : faces) {
    const auto n = divisions(f);
    const auto at = [&](Index i, Index j) { return line_at.at(first_points({f, i, j})); };
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
  std::vector<Vec3> out(layers + 1);
  for (Index k = 0; k <= layers; ++k) out[k] = mesh.points()[line_point(mesh, blocks, line, k)];
  return out;
}

std::vector<float> column_values(const BlockMesh& mesh, const WallBlocks& blocks,
                                 const WallColumns& columns) {
  const auto faces = static_cast<Offset>(columns.faces.size());
  std::vector<float> values(faces * columns.layers);
  const auto points = mesh.points();
  parallel_for(faces, 64, [&](Offset begin, Offset end) {
    for (Offset f = begin; f < end; ++f) {
      std::array<Vec3, 8> p;
      for (Index k = 0; k <= columns.layers; ++k) {
        for (int c = 0; c < 4; ++c) {
          p[c] = p[c + 4];
          p[c + 4] = points[line_point(mesh, blocks, columns.lines[columns.faces[f][c]], k)];
        }
        if (k > 0) values[f + faces * (k - 1)] = static_cast<float>(worst_corner(p));
      }
    }
  });
  return values;
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
