#include "core/volume/shell_columns.hpp"

#include <algorithm>

namespace flowcage {

ShellColumns shell_columns(const BlockMesh& mesh, const Shell& shell) {
  ShellColumns columns;
  columns.layers = mesh.chord_divisions()[shell.k_chord];
  std::vector<Index> line_at(mesh.points().size(), no_index);
  for (Index b = 0; b < mesh.block_count(); ++b) {
    const auto n = mesh.dims(b);
    for (Index j = 0; j <= n[1]; ++j) {
      for (Index i = 0; i <= n[0]; ++i) {
        Index& line = line_at[mesh.point_number(b, i, j, 0)];
        if (line != no_index) continue;
        line = static_cast<Index>(columns.lines.size());
        columns.lines.push_back({b, i, j});
      }
    }
  }
  for (Index b = 0; b < mesh.block_count(); ++b) {
    const auto n = mesh.dims(b);
    const auto at = [&](Index i, Index j) { return line_at[mesh.point_number(b, i, j, 0)]; };
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
  columns.edges.erase(std::unique(columns.edges.begin(), columns.edges.end()), columns.edges.end());
  return columns;
}

void flatten_symmetry(BlockMesh& mesh, const Shell& shell) {
  if (!shell.symmetry) return;
  for (const BoundaryPatch& patch : mesh.patches()) {
    if (patch.type != PatchType::symmetry) continue;
    for (const auto& quad : patch.quads) {
      for (const Index v : quad) shell.symmetry->flatten(mesh.mutable_points()[v]);
    }
  }
}

}  // namespace flowcage
