#include "core/mesh/coarsen_blocks.hpp"

namespace flowcage {

CoarsenedBlocks coarsen_blocks(const BlockMesh& fine) {
  std::vector<Index> divisions = fine.chord_divisions();
  for (Index& n : divisions) n /= 2;
  const Index count = BlockMesh::point_count(fine.complex(), divisions);
  CoarsenedBlocks out{BlockMesh(fine.shared_complex(), divisions, std::vector<Vec3>(count)),
                      std::vector<Index>(count)};
  for (Index b = 0; b < fine.block_count(); ++b) {
    const auto n = out.mesh.dims(b);
    for (Index k = 0; k <= n[2]; ++k) {
      for (Index j = 0; j <= n[1]; ++j) {
        for (Index i = 0; i <= n[0]; ++i) {
          const Index at = fine.point_number(b, 2 * i, 2 * j, 2 * k);
          const Index p = out.mesh.point_number(b, i, j, k);
          out.fine_point[p] = at;
          out.mesh.mutable_points()[p] = fine.points()[at];
        }
      }
    }
  }
  for (std::size_t p = 0; p < fine.patches().size(); ++p) {
    out.mesh.set_patch_type(p, fine.patches()[p].type);
  }
  return out;
}

}  // namespace flowcage
