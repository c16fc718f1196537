#pragma once
#include <array>
#include <vector>

#include "core/blocks/shell.hpp"
#include "core/mesh/block_mesh.hpp"

namespace flowcage {

/// The lines of a shell's block mesh, each once, and the wall's net between them: what re-spacing and turning
/// work on. Lines are numbered by the first block that sees them, i fastest.
struct ShellColumns {
  std::vector<ShellLine> lines;
  std::vector<std::array<Index, 4>>
      faces;  ///< lines at the corners of each wall face, block by block, i fastest
  std::vector<std::array<Index, 2>> edges;  ///< pairs of neighbouring lines, each once, ascending
  Index layers = 1;                         ///< cells along a line
};
ShellColumns shell_columns(const BlockMesh& mesh, const Shell& shell);

/// Puts the points of symmetry patches exactly into the plane.
void flatten_symmetry(BlockMesh& mesh, const Shell& shell);

}  // namespace flowcage
