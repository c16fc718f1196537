#pragma once
#include "core/mesh/hex_view.hpp"

namespace flowcage {

/// A mesh from what a file says of cells and boundary quads. Quads, in any rotation or orientation, become
/// outward and get their owner; outer faces without a quad go into a patch "boundary" (or, if there are
/// patches, "unassigned") of type wall. Throws Error(input) as match_faces, and for a cell that repeats a
/// point.
HexMesh complete_boundary(std::vector<Vec3> points, std::vector<HexPoints> cells,
                          std::vector<BoundaryPatch> patches);

}  // namespace flowcage
