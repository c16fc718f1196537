#include "core/optimise/point_freedom.hpp"

namespace flowcage {

std::vector<PointFreedom> patch_freedom(const HexView& mesh, std::span<const PointFreedom> per_patch) {
  std::vector<PointFreedom> out(mesh.points().size());
  const std::vector<BoundaryPatch>& patches = mesh.patches();
  for (std::size_t n = 0; n < patches.size(); ++n) {
    const PointFreedom own = per_patch.empty() ? fixed_point : per_patch[n];
    for (const std::array<Index, 4>& quad : patches[n].quads) {
      for (const Index p : quad) {
        PointFreedom& freedom = out[p];
        freedom.frozen_axes |= own.frozen_axes;
        if (own.projector == no_index || own.projector == freedom.projector) continue;
        if (freedom.projector == no_index) {
          freedom.projector = own.projector;
        } else {
          freedom = fixed_point;
        }
      }
    }
  }
  return out;
}

}  // namespace flowcage
