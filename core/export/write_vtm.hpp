#pragma once
#include <filesystem>
#include <ostream>
#include <string>
#include <vector>

#include "core/base/atomic_file.hpp"
#include "core/export/structured_blocks.hpp"
#include "core/export/write_vtu.hpp"

namespace flowcage {

/// Writes a VTK multi-block dataset: `index` gets the XML that names the pieces, `folder` the pieces, which
/// it calls `folder_name`/PIECE: of each structured block a grid block1.vts, block2.vts, ... (group
/// "blocks"), of each patch its quads, outward, as NAME.vtp (group "patches"; its cell array `patchId` and
/// FieldData as write_vtu has them). Points that pieces share have the same number in the point array
/// `pointId`, cells keep theirs in `cellId` (both Int32, VTK's GlobalIds), so that the mesh reads back as it
/// was (read_vtm). Fields as in write_vtu. Numbers are appended raw binary; points are doubles. Returns notes
/// for the user: patches renamed by legal_patch_names. Throws Error(output) through the streams;
/// precondition: as write_vtu. The caller commits, the folder first.
std::vector<std::string> write_vtm(std::ostream& index, AtomicFolder& folder, const std::string& folder_name,
                                   const BlockMesh& mesh, const StructuredBlocks& blocks,
                                   const VtuFields& fields = {}, Progress* progress = nullptr);

/// The folder of the pieces beside `file`: "wing_vtm" of "wing.vtm".
std::filesystem::path vtm_folder(const std::filesystem::path& file);

/// The pieces of an older mesh in that folder, which a new one replaces (for AtomicFolder's `replaced`).
std::vector<std::string> vtm_entries(const std::filesystem::path& folder);

}  // namespace flowcage
