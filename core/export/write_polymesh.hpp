#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "core/base/progress.hpp"
#include "core/mesh/hex_adjacency.hpp"

namespace flowcage {

struct PolyMeshSettings {
  bool binary = true;
  bool block_zones = false;             ///< a cellZone for each block: block0, block1, ...
  bool case_files = true;               ///< system/controlDict, fvSchemes, fvSolution and the .foam file
  std::string foam_file = "case.foam";  ///< empty file that ParaView opens
};

/// Writes an OpenFOAM case: constant/polyMesh (points, faces, owner, neighbour, boundary, cellZones) and the
/// few files without which checkMesh and ParaView do not start. 32-bit labels, doubles, little-endian; ASCII
/// numbers read back as the same bits.
///
/// `folder` is created if need be; files of these names in it are replaced. Whether the case appears whole or
/// not at all is the caller's: give a temporary folder and rename it.
/// Patch types: wall -> wall; symmetry -> symmetryPlane where it is flat as OpenFOAM demands (unit normals
/// within 3e-8), else symmetry, with a note; farfield, inlet, outlet -> patch with that physicalType.
/// Returns notes for the user: renamed and bent patches. Throws Error(output) for a file that cannot be
/// written, Error(gate) for a point that is not finite (OpenFOAM cannot read one).
std::vector<std::string> write_polymesh(const std::filesystem::path& folder, const HexView& mesh,
                                        const HexAdjacency& adjacency, const PolyMeshSettings& settings = {},
                                        Progress* progress = nullptr);

}  // namespace flowcage
