#include "core/export/face_stream.hpp"

#include "core/mesh/visit_cells.hpp"

namespace flowcage {

void read_internal_faces(const HexView& mesh, const HexAdjacency& adjacency, Offset begin, Offset end,
                         std::vector<InternalFace>& faces) {
  faces.clear();
  visit_cells(mesh, begin, end, [&](Offset cell, const HexPoints& points) {
    const std::size_t first = faces.size();
    for (int f = 0; f < 6; ++f) {
      const Index across = adjacency.across[6 * cell + f];
      if (across > cell) faces.push_back({face_points(points, f), static_cast<Index>(cell), across});
    }
    std::stable_sort(faces.begin() + static_cast<std::ptrdiff_t>(first), faces.end(),
                     [](const InternalFace& a, const InternalFace& b) { return a.neighbour < b.neighbour; });
  });
}

}  // namespace flowcage
