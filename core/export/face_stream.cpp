#include "core/export/face_stream.hpp"

#include <utility>

namespace flowcage {

void read_internal_faces(const HexView& mesh, const HexAdjacency& adjacency, Offset begin, Offset end,
                         std::vector<InternalFace>& faces) {
  faces.clear();
  visit_neighbours(mesh, adjacency, begin, end,
                   [&](Offset cell, const HexPoints& points, const CellNeighbours& neighbours) {
                     const std::size_t first = faces.size();
                     for (int f = 0; f < 6; ++f) {
                       const Index across = neighbours[f];
                       if (across <= cell) continue;
                       // At most six, mostly in order already: put in its place.
                       faces.push_back({face_points(points, f), static_cast<Index>(cell), across});
                       for (std::size_t n = faces.size() - 1;
                            n > first && faces[n].neighbour < faces[n - 1].neighbour; --n) {
                         std::swap(faces[n], faces[n - 1]);
                       }
                     }
                   });
}

}  // namespace flowcage
