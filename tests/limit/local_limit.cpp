#include "tests/limit/local_limit.hpp"

#include <algorithm>
#include <cmath>

namespace flowcage {
namespace {

// The faces at `vertex` as a cage of their own. Its outer edges are cut, which the next ring does not see.
LocalRing cut_out(const SurfaceLevel& level, const std::vector<Vec3>& points, Index vertex) {
  std::vector<Index> numbers{vertex};
  const auto local = [&](Index v) {
    const auto found = std::find(numbers.begin(), numbers.end(), v);
    if (found != numbers.end()) return static_cast<Index>(found - numbers.begin());
    numbers.push_back(v);
    return static_cast<Index>(numbers.size() - 1);
  };
  Cage cage;
  for (const Index f : level.vertex_faces[vertex]) {
    std::vector<Index> row;
    for (const Index v : level.face_vertices[f]) row.push_back(local(v));
    cage.faces.push_row(row);
  }
  for (const Index e : level.vertex_edges[vertex]) {
    const auto [a, b] = level.edge_vertices[e];
    cage.creases.push_back({local(a), local(b), level.edge_sharpness[e]});
  }
  cage.corners.push_back({0, level.vertex_sharpness[vertex]});
  LocalRing ring;
  for (const Index v : numbers) {
    // After many refinements points coincide, which a cage's points must not.
    cage.points.emplace_back(static_cast<double>(cage.points.size()), 0, 0);
    ring.points.push_back(points[v]);
  }
  ring.level = build_surface_level(cage);
  return ring;
}

}  // namespace

LocalRing refined_ring(const SurfaceLevel& level, const std::vector<Vec3>& points,
                       const RingRequest& request) {
  if (request.depth == 0) return cut_out(level, points, request.vertex);
  // Only below level 0 is every ring free of contact with itself.
  LocalRing ring{level, points};
  Index vertex = request.vertex;
  for (int k = 0; k < request.depth; ++k) {
    const std::vector<SurfaceLevel> levels{ring.level, build_child_level(ring.level)};
    ring = cut_out(levels[1], refine_points(levels, ring.points), vertex);
    vertex = 0;
    if (!request.zoom) continue;
    const Vec3 origin = ring.points[0];
    double size = 0;
    for (Vec3& p : ring.points) size = std::max(size, (p -= origin).norm());
    int exponent = 0;
    std::frexp(size, &exponent);
    for (Vec3& p : ring.points) p *= std::ldexp(1.0, -exponent);
  }
  return ring;
}

}  // namespace flowcage
