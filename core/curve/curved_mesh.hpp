#pragma once
#include <span>
#include <vector>

#include "core/base/progress.hpp"
#include "core/mesh/block_mesh.hpp"
#include "core/target/target_surface.hpp"

namespace flowcage {

/// A block mesh of Lagrange hexes of order 2 to 4 with equally spaced nodes. Its nodes are the points of
/// `nodes`, the same complex divided `order` times finer: neighbours share them by construction. Cells are
/// those of the linear mesh and have its numbers.
struct CurvedMesh {
  int order = 2;
  BlockMesh nodes;

  Offset cell_count() const { return nodes.cell_count() / (order * order * order); }
  int nodes_per_cell() const { return (order + 1) * (order + 1) * (order + 1); }
  int nodes_per_quad() const { return (order + 1) * (order + 1); }
  /// Node numbers of a cell, i fastest: (i,j,k) is entry i + (order + 1) (j + (order + 1) k).
  void read_cell(Offset cell, std::span<Index> out) const;
  /// Node numbers of a patch's quads, outward, one after the other, each with its u fastest; u along the
  /// first side, v along the last.
  std::vector<Index> patch_quads(std::size_t patch) const;
};

struct CurveReport {
  double max_wall_distance = 0;  ///< of a node of the CAD's patches from the CAD, metres
  Vec3 worst_place = Vec3::Zero();
  double max_correction = 0;  ///< largest way of such a node from its interpolated place, metres
  Offset straightened = 0;    ///< cells that were not valid until their inner nodes were straightened
};

/// The curved mesh of a linear one whose walls lie on `target`. Nodes first follow the lattice lines of each
/// block: cubic Hermite interpolation along i, then j, then k, parameter: the index, slopes by central
/// differences, limited (Fritsch & Carlson, SIAM J. Numer. Anal. 17, 1980) so that thin layers keep their
/// order. Then the nodes of walls, inlets and outlets go to their nearest points of the CAD, those of sharp
/// edges of the blocks to the CAD's feature chain along which the edge runs (where there is one), those in a
/// symmetry plane to the CAD's trace in it; the lines of nodes that leave them follow, by a share that falls
/// from 1 to 0 along the line's length. Where a cell is not valid then, its inner nodes go back toward the
/// places that the linear mesh and the curved walls alone give them (curve/straighten). The linear mesh's own
/// points stay. Same bits for any number of threads. Precondition: 2 <= order <= 4. Throws Error(input) when
/// Index cannot number the nodes.
CurvedMesh make_curved_mesh(const BlockMesh& mesh, const TargetSurface& target, int order,
                            CurveReport& report, Progress& progress);

/// The first step alone: no CAD. Not `smooth`: the nodes lie on the linear cells.
CurvedMesh interpolated_mesh(const BlockMesh& mesh, int order, bool smooth = true);

}  // namespace flowcage
