#pragma once
#include <ostream>
#include <vector>

#include "core/export/write_vtu.hpp"
#include "core/mesh/cage.hpp"

namespace flowcage {

// Surfaces: a Cage is a polygon mesh with patches, whatever its size. Its OBJ form, patches as groups, is
// write_cage (core/cage/write_cage.hpp).

/// Writes VTK PolyData: polygons, Int32 cell array `patchId` and FieldData `patch:NAME` as write_vtu, point
/// fields as given (#points values each). Appended raw binary. Returns notes of renamed patches.
std::vector<std::string> write_vtp(std::ostream& out, const Cage& surface,
                                   const std::vector<VtkPointField>& point_fields = {});

/// Writes binary STL (single precision; patches are lost, STL has none). A quad is cut along its shorter
/// diagonal, a larger polygon as a fan from its first corner. Throws Error(output) beyond 2^32 triangles.
void write_stl(std::ostream& out, const Cage& surface);

}  // namespace flowcage
