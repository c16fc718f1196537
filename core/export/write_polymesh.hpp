#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "core/base/atomic_file.hpp"
#include "core/base/progress.hpp"
#include "core/mesh/hex_adjacency.hpp"

namespace flowcage {

struct PolyMeshSettings {
  bool binary = true;
  bool block_zones = false;  ///< a cellZone for each block: block0, block1, ...
};

/// Writes an OpenFOAM polyMesh into a folder: points, faces, owner, neighbour, boundary, and cellZones if
/// asked for. 32-bit labels, doubles, little-endian; ASCII numbers read back as the same bits. The caller
/// commits.
///
/// Patch types: wall -> wall; symmetry -> symmetryPlane where it is flat as OpenFOAM demands (unit normals
/// within 3e-8), else symmetry, with a note; farfield, inlet, outlet -> patch with that physicalType.
/// Returns notes for the user: renamed and bent patches. Throws Error(output) for a file that cannot be
/// written, Error(gate) for a point that is not finite (OpenFOAM cannot read one).
std::vector<std::string> write_polymesh(AtomicFolder& folder, const HexView& mesh,
                                        const HexAdjacency& adjacency, const PolyMeshSettings& settings = {},
                                        Progress* progress = nullptr);

/// OpenFOAM's type of a patch, as above.
std::string foam_patch_type(const HexView& mesh, const BoundaryPatch& patch);

/// The head of an ASCII file of OpenFOAM ("dictionary", "system", "controlDict").
std::string foam_header(const std::string& kind, const std::string& location, const std::string& object);

/// What write_polymesh replaces of an older polyMesh folder: its own files and those that would refer to the
/// older mesh. For AtomicFolder's `replaced`.
std::vector<std::string> polymesh_entries();

/// Adds what checkMesh, potentialFoam and ParaView need to start on a case folder and what it lacks of it:
/// system/controlDict, fvSchemes, fvSolution and the empty file `foam_file` that ParaView opens. A file that
/// exists stays as it is.
void write_case_files(const std::filesystem::path& case_folder, const std::string& foam_file);

/// A whole case at once: constant/polyMesh below `case_folder`, committed, and its case files.
std::vector<std::string> write_openfoam_case(const std::filesystem::path& case_folder, const HexView& mesh,
                                             const HexAdjacency& adjacency,
                                             const PolyMeshSettings& settings = {},
                                             Progress* progress = nullptr);

}  // namespace flowcage
