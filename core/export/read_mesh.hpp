#pragma once
#include <filesystem>

#include "core/mesh/hex_view.hpp"

namespace flowcage {

// Hex meshes from files. Every reader throws Error(input) that names the file as given, the place in it and
// the remedy: for what is missing, cut off, contradicts itself, or is no hex mesh. Claimed sizes are held
// against the bytes that are there before memory is taken.

/// Reads an OpenFOAM mesh: `path` is a polyMesh folder, a case folder, or a .foam file in a case folder.
/// ASCII or binary (little-endian, 32 or 64-bit labels, float or double). Faces and points may have any
/// order; each cell must have six quads. Cells keep their numbers. Patches: wall -> wall; symmetryPlane,
/// symmetry -> symmetry; patch -> its physicalType if that is farfield, inlet or outlet, else farfield; other
/// types (cyclic, wedge, empty) -> farfield, processor is refused.
HexMesh read_polymesh(const std::filesystem::path& path);

/// Reads a VTK unstructured grid with one piece: ASCII, inline or appended, base64 or raw, zlib-compressed if
/// zlib was there when flowcage was built. Hexes and voxels are cells, quads and pixels the boundary,
/// vertices and lines are passed over; other cells are refused. Patches by the cell array `patchId` and
/// FieldData `patch:NAME` and `patchTypes` as write_vtu makes them. Outer faces without a quad become the
/// patch "boundary" (if there are other patches: "unassigned"), type wall.
HexMesh read_vtu(const std::filesystem::path& file);

/// Either of the above, by what `path` is: a folder or .foam, or .vtu.
HexMesh read_mesh(const std::filesystem::path& path);

}  // namespace flowcage
