#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "core/base/progress.hpp"
#include "core/export/structured_blocks.hpp"

namespace flowcage {

/// Of the CGNS library: "3.4.0".
std::string cgns_version();

struct CgnsSettings {
  std::string unit = "m";                  ///< of the points: m, mm, in or ft
  std::string shown_as = "the CGNS file";  ///< how messages call the file
};

/// Writes a CGNS file (HDF5) with one structured zone a block: coordinates with data class, units and
/// exponents; an interface 1-to-1 for each window between blocks, on both sides; a BC of type FamilySpecified
/// for each window of a patch. A family a patch has its condition: BCWall, BCFarfield, BCSymmetryPlane,
/// BCInflow, BCOutflow.
/// Returns notes for the user: patches renamed by legal_patch_names. Throws Error(output).
std::vector<std::string> write_cgns(const std::filesystem::path& file, const BlockMesh& mesh,
                                    const StructuredBlocks& blocks, const CgnsSettings& settings = {},
                                    Progress* progress = nullptr);

/// Writes a CGNS file with one unstructured zone: a section HEXA_8, then a section QUAD_4 (outward) and a BC
/// a patch, at the face centres; families as above. Cells and points keep their numbers.
std::vector<std::string> write_cgns_unstructured(const std::filesystem::path& file, const HexView& mesh,
                                                 const CgnsSettings& settings = {},
                                                 Progress* progress = nullptr);

}  // namespace flowcage
