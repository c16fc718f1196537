#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "core/mesh/hex_view.hpp"

namespace flowcage {

/// The blocks of an OpenFOAM blockMeshDict, one hex each.
struct DictBlocks {
  HexMesh mesh;
  bool in_metres = false;          ///< the file has `scale` or `convertToMeters`, which is applied
  std::vector<std::string> notes;  ///< one sentence for each thing that was passed over
};

/// Reads vertices, blocks, patches (`boundary`, or the older `patches`) and scale of a blockMeshDict with
/// straight edges. Passed over, with a note: numbers of cells and grading (a mesh is refined by level),
/// names of zones. Types of patches: wall -> wall; symmetryPlane, symmetry -> symmetry; others by their
/// names (foreign_patch_type), farfield where that says wall. Faces of no patch become the one of
/// `defaultPatch`, else as in read_vtu. Vertices that no block uses are left out.
/// Throws Error(input) with the line for what is damaged, and for what is no straight block: curved or
/// projected edges, faces and vertices, merged patch pairs, macros and directives ($, #).
DictBlocks read_block_dict(const std::filesystem::path& file);

}  // namespace flowcage
