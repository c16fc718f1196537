#pragma once
#include <ostream>
#include <span>
#include <string>
#include <vector>

#include "core/base/progress.hpp"
#include "core/mesh/hex_view.hpp"

namespace flowcage {

/// A field on the cells of a VTU file: the hexes and the boundary quads (through all patches in their order).
/// Either span may be empty: then a quad takes its hex's value, and a hex no number (NaN).
struct VtuCellField {
  std::string name;
  std::span<const float> cells;     ///< #cells or empty
  std::span<const float> boundary;  ///< #boundary quads or empty
};

/// A field on the points of a mesh or surface.
struct VtkPointField {
  std::string name;
  std::span<const float> values;  ///< #points
};

struct VtuFields {
  std::vector<VtuCellField> cell_fields;
  std::vector<VtkPointField> point_fields;
};

/// Throws Error(internal) where a field has not the sizes above; `quads`: of the whole boundary.
void check_field_sizes(const VtuFields& fields, const HexView& mesh, Offset quads);

/// Writes a VTK unstructured grid: the hexes, then the boundary quads (outward) patch by patch. Int32 cell
/// array `patchId`: -1 for hexes, else the patch's position. FieldData: one integer `patch:NAME` per patch,
/// its id, and `patchTypes`, the PatchType of each. Numbers are appended raw binary; points are doubles.
/// Read by VTK >= 8 (ParaView 5.5) and meshio.
/// Returns notes for the user: patches renamed by legal_patch_names. Throws Error(output) through the stream;
/// precondition: the fields' sizes are as above (Error(internal) otherwise), fewer than 2^31 cells and quads.
std::vector<std::string> write_vtu(std::ostream& out, const HexView& mesh, const VtuFields& fields = {},
                                   Progress* progress = nullptr);

}  // namespace flowcage
