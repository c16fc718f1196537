#include "core/blocks/cage_of_blocks.hpp"

#include <algorithm>

namespace flowcage {

WallCage cage_of_blocks(const BlockDraft& draft, std::span<const char> is_wall, bool fluid_side) {
  WallCage wall;
  std::vector<Index> vertex(draft.points.size(), no_index);
  for (std::size_t b = 0; b < draft.boundary.size(); ++b) {
    if (is_wall[b] == 0) continue;
    for (const Index v : draft.boundary[b].corners) vertex[v] = 0;
  }
  for (Index v = 0; v < static_cast<Index>(vertex.size()); ++v) {
    if (vertex[v] == no_index) continue;
    vertex[v] = static_cast<Index>(wall.vertex_corner.size());
    wall.vertex_corner.push_back(v);
    wall.cage.points.push_back(draft.points[v]);
  }
  for (Index b = 0; b < static_cast<Index>(draft.boundary.size()); ++b) {
    if (is_wall[b] == 0) continue;
    std::array<Index, 4> face{};
    for (int n = 0; n < 4; ++n) face[n] = vertex[draft.boundary[b].corners[n]];
    if (fluid_side) std::reverse(face.begin() + 1, face.end());
    wall.cage.faces.push_row(face);
    wall.face_boundary.push_back(b);
  }
  wall.cage.patch_names = {""};
  wall.cage.face_patch.assign(wall.face_boundary.size(), 0);
  return wall;
}

}  // namespace flowcage
