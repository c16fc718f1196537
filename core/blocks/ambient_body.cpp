#include "core/blocks/ambient_body.hpp"

#include <cmath>

#include "core/base/parallel.hpp"
#include "core/project/winding_number.hpp"

namespace flowcage {

AmbientBody ambient_body(const TargetSurface& target) {
  const Tessellation& cad = target.tessellation();
  AmbientBody body{cad.points, cad.triangles, cad.triangle_face};
  close_rims(body.points, body.triangles);
  return body;
}

std::vector<double> body_fractions(const VoxelGrid& grid, std::span<const Vec3> points,
                                   std::span<const std::array<Index, 3>> triangles, int samples) {
  const WindingTree tree = build_winding_tree(points, triangles);
  Box3 bounds;
  for (const auto& t : triangles) {
    for (const Index v : t) bounds.extend(points[v]);
  }
  std::vector<double> fraction(static_cast<std::size_t>(grid.cell_count()), 0);
  constexpr Offset grain = 64;
  parallel_for(grid.cell_count(), grain, [&](Offset begin, Offset end) {
    for (Offset c = begin; c < end; ++c) {
      const std::array<Index, 3> at = grid.cell_at(static_cast<Index>(c));
      const Vec3 low = grid.point(at), high = grid.point({at[0] + 1, at[1] + 1, at[2] + 1});
      if (!bounds.intersects(Box3(low, high))) continue;
      int inside = 0;
      for (int n = 0; n < samples * samples * samples; ++n) {
        const Vec3 t(n % samples + 0.5, n / samples % samples + 0.5, n / (samples * samples) + 0.5);
        const Vec3 p = low + (high - low).cwiseProduct(t) / samples;
        inside += std::abs(winding_number(tree, p)) > 0.5 ? 1 : 0;
      }
      fraction[c] = static_cast<double>(inside) / (samples * samples * samples);
    }
  });
  return fraction;
}

}  // namespace flowcage
