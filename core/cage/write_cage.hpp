#pragma once
#include <filesystem>
#include <ostream>

#include "core/mesh/cage.hpp"

namespace flowcage {

/// Writes a cage as OBJ so that read_cage gives it back: order, every bit of the coordinates, creases and
/// corners with their sharpness, and patches as `g` lines (face by face, in the cage's order). Patches
/// without a face are left out. What OBJ cannot hold in a name (a line break, a leading `#`) is replaced.
void write_cage(const Cage& cage, std::ostream& out);

/// The same to a file, whole or not at all. Throws Error(output).
void write_cage(const Cage& cage, const std::filesystem::path& file);

}  // namespace flowcage
