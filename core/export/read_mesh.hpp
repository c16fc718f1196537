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

/// Reads a VTK multi-block dataset as write_vtm makes it: structured blocks that number the points they share
/// (`pointId`) and their cells (`cellId`), and a patch a PolyData piece of quads.
HexMesh read_vtm(const std::filesystem::path& file);

/// Reads a Gmsh mesh, ASCII, format 2 or 4.1: linear hexes and quads; points and lines are passed over, other
/// elements are refused. Patches are the quads' physical groups (without one: "surfaceN" of the entity), in
/// the order of their numbers; points come in the order of their numbers. Types of patches by
/// foreign_patch_type; faces without a quad as in read_vtu.
HexMesh read_gmsh(const std::filesystem::path& file);

/// Reads an SU2 mesh, three-dimensional, one zone. Patches are its markers, their types as in read_gmsh.
HexMesh read_su2(const std::filesystem::path& file);

/// Reads a CGNS file with one base: structured zones, whose points become one where 1-to-1 interfaces join
/// them, with boundary conditions as point ranges; or one unstructured zone of HEXA_8 and QUAD_4, in
/// sections of their own or MIXED, with conditions at elements. Patches are the families of the conditions
/// (without one: the condition; a quad without a condition: its section). Zones must be right-handed.
HexMesh read_cgns(const std::filesystem::path& file);

/// Any of the above, by what `path` is: a folder or .foam, .vtu, .vtm, .cgns, .msh or .su2 in any case.
HexMesh read_mesh(const std::filesystem::path& path);

}  // namespace flowcage
