#pragma once
#include <algorithm>
#include <array>

#include "core/mesh/hex_view.hpp"

namespace flowcage {

/// How many cells a task of a parallel loop over cells takes.
inline constexpr Offset cell_grain = 8192;

/// Calls visit(cell, points) for the cells [begin, end) in their order, read in small batches.
template <typename Visit>
void visit_cells(const HexView& mesh, Offset begin, Offset end, const Visit& visit) {
  constexpr Offset batch = 256;
  std::array<HexPoints, batch> buffer;
  for (Offset c = begin; c < end; c += batch) {
    const auto n = static_cast<std::size_t>(std::min(batch, end - c));
    mesh.read_cells(c, {buffer.data(), n});
    for (std::size_t i = 0; i < n; ++i) visit(c + static_cast<Offset>(i), buffer[i]);
  }
}

/// The positions of a cell's corners.
inline std::array<Vec3, 8> corners_of(const HexView& mesh, const HexPoints& cell) {
  std::array<Vec3, 8> corners;
  const auto points = mesh.points();
  for (int i = 0; i < 8; ++i) corners[i] = points[cell[i]];
  return corners;
}

/// The points of face f of a cell, counter-clockwise seen from outside of it.
inline std::array<Index, 4> face_points(const HexPoints& cell, int face) {
  const auto& corners = hex_faces[face];
  return {cell[corners[0]], cell[corners[1]], cell[corners[2]], cell[corners[3]]};
}

}  // namespace flowcage
