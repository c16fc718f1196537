#pragma once
#include <span>

#include "core/curve/curved_mesh.hpp"

namespace flowcage {

/// Where a cell is not proved valid (curved_bound.hpp), its nodes go toward their places in `straight`, by a
/// half, three quarters, seven eighths, at last the whole way, and the cells around are looked at again. A
/// node whose places are the same in both (on the CAD) stays; of all rounds the one with the fewest invalid
/// cells counts. Returns how many cells were not valid at first.
/// Precondition: straight.size() == number of nodes. Same bits for any number of threads.
Offset straighten_cells(CurvedMesh& mesh, std::span<const Vec3> straight);

}  // namespace flowcage
