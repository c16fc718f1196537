#pragma once
#include <filesystem>
#include <ostream>
#include <string>
#include <vector>

#include "core/curve/curved_mesh.hpp"
#include "core/export/write_cgns.hpp"

namespace flowcage {

// Curved hexes and their boundary quads, patches as in the linear writers; nodes keep their numbers (but in
// Gmsh). All return notes for the user: patches renamed by legal_patch_names.

/// VTU with VTK_LAGRANGE_HEXAHEDRON and VTK_LAGRANGE_QUADRILATERAL, file version 2.2: VTK >= 9.1 (ParaView
/// 5.10). Throws Error(output) through the stream.
std::vector<std::string> write_curved_vtu(std::ostream& out, const CurvedMesh& mesh,
                                          Progress* progress = nullptr);

/// Gmsh 4.1, ASCII: elements of 27, 64 or 125 nodes.
std::vector<std::string> write_curved_gmsh(std::ostream& out, const CurvedMesh& mesh,
                                           Progress* progress = nullptr);

/// CGNS, one unstructured zone: HEXA_27, HEXA_64 or HEXA_125 and QUAD_9, QUAD_16 or QUAD_25. Throws
/// Error(output).
std::vector<std::string> write_curved_cgns(const std::filesystem::path& file, const CurvedMesh& mesh,
                                           const CgnsSettings& settings = {}, Progress* progress = nullptr);

}  // namespace flowcage
