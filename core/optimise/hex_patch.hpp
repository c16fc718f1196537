#pragma once
#include <span>
#include <vector>

#include "core/mesh/hex_view.hpp"
#include "core/optimise/point_freedom.hpp"

namespace flowcage {

/// A region of a mesh, numbered by itself, that can be optimised without touching any other cell.
struct HexPatch {
  std::vector<Offset> cell_of;        ///< the mesh's cell of each cell here, ascending
  std::vector<HexPoints> cells;       ///< into the points here
  std::vector<Index> point_of;        ///< the mesh's point of each point here, ascending
  std::vector<PointFreedom> freedom;  ///< #points here; fixed where a cell outside would change
  std::vector<Index> moving;          ///< points here that may move, ascending
};

/// Which cells may change: everything, or those within `rings` rings (of cells that share a point) of `seeds`
/// (#cells, not 0). Each patch is connected through moving points; cells without a moving point belong to
/// none. Patches are ordered by their first cell.
std::vector<HexPatch> whole_mesh_patches(std::span<const HexPoints> cells,
                                         std::span<const PointFreedom> freedom);
std::vector<HexPatch> patches_round(std::span<const HexPoints> cells, std::span<const PointFreedom> freedom,
                                    std::span<const std::uint8_t> seeds, int rings);

}  // namespace flowcage
