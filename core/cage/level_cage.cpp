#include "core/cage/level_cage.hpp"

namespace flowcage {

Cage cage_of_level(const SurfaceLevel& level, std::vector<Vec3> points,
                   std::vector<std::string> patch_names) {
  Cage cage;
  cage.points = std::move(points);
  cage.faces = level.face_vertices;
  cage.face_patch = level.face_patch;
  cage.patch_names = std::move(patch_names);
  for (Index e = 0; e < level.edge_count(); ++e) {
    if (level.is_boundary_edge(e) || !(level.edge_sharpness[e] > 0)) continue;
    cage.creases.push_back({level.edge_vertices[e][0], level.edge_vertices[e][1], level.edge_sharpness[e]});
  }
  for (Index v = 0; v < level.vertex_count(); ++v) {
    const bool single_face = level.vertex_faces.row_size(v) == 1;  // a boundary's own corner
    if (single_face || !(level.vertex_sharpness[v] > 0)) continue;
    cage.corners.push_back({v, level.vertex_sharpness[v]});
  }
  return cage;
}

}  // namespace flowcage
