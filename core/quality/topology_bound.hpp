#pragma once
#include <vector>

#include "core/mesh/block_mesh.hpp"

namespace flowcage {

/// What no smoothing of a mesh's inside can beat: from how the blocks meet and the shape of its boundary.
struct TopologyBound {
  std::vector<float>
      points;  ///< #points, scaled Jacobian that the cells at a point can reach together; 1 inside
  double min = 1;
  Vec3 place = Vec3::Zero();  ///< of the least
};

/// At a point of the boundary where one line of cell edges leaves it, the corner over boundary quad i has the
/// scaled Jacobian sin(alpha_i) n_i . d, alpha_i the quad's angle there, n_i its normal, d the line's
/// direction. With alpha_i at best equal within each sector between sharp edges (s_i its sine), all corners
/// together reach at most
///   max over |d| <= 1 of min_i s_i n_i . d,
/// the distance of the origin from the convex hull of the s_i n_i (volume/corner_fan): .707 at a
/// right-angled edge, .577 at a cube's corner, sin(delta / 2) at an edge of angle delta. In a symmetry plane
/// d lies in it. Along an inner edge of the blocks with N hexes: sin(2 pi / N) for N != 4. Corners with two
/// or more boundary quads have no free line and no bound here. `crease_degrees`: quads that meet at more are
/// in different sectors. Parallel; the same bits for any number of threads.
TopologyBound topology_bound(const BlockMesh& mesh, double crease_degrees = 30);

}  // namespace flowcage
