#pragma once
#include <cstdint>
#include <string>

namespace flowcage::occ {

enum class CadFormat : std::uint8_t { unknown, step, iges, brep };

struct Sniff {
  CadFormat format = CadFormat::unknown;
  std::string problem;  ///< why it is unknown
};

/// The format of a CAD file by its content: STEP (ISO 10303-21 clear text) by its first line, IGES by the
/// section letters in column 73, BREP by OpenCASCADE's header line. Throws Error(input) for a file that is
/// missing, not readable, a folder or empty, and for a STEP or IGES file whose last line is missing (cut
/// off).
Sniff sniff_cad_file(const std::string& file);

}  // namespace flowcage::occ
