#pragma once
#include <array>
#include <span>
#include <vector>

#include "core/blocks/wall_blocks.hpp"

namespace flowcage {

/// The lines of a block mesh that leave its wall, each once (several from one point where the wall is cut,
/// each with its own neighbours), and the wall's net between them: what spreading, turning and layers work
/// on. Lines are numbered by the first face that sees them, i fastest.
struct WallColumns {
  std::vector<WallLine> lines;
  std::vector<std::array<Index, 4>>
      faces;  ///< lines at the corners of each wall cell face, face by face of the blocks' wall, i fastest
  std::vector<std::array<Index, 2>> edges;  ///< pairs of neighbouring lines, each once, ascending
  std::vector<char> rim;  ///< #lines, 1 at an end of the net off any symmetry plane: other blocks share it
  Index layers = 1;       ///< cells along a line
};
/// `chord`: only the lines along it.
WallColumns wall_columns(const BlockMesh& mesh, const WallBlocks& blocks, Index chord = no_index);

/// Points of one line from the wall on.
std::vector<Vec3> line_positions(const BlockMesh& mesh, const WallBlocks& blocks, const WallLine& line,
                                 Index layers);

/// Scaled Jacobian (least corner) of each cell on the columns, layer by layer of their faces.
std::vector<float> column_values(const BlockMesh& mesh, const WallBlocks& blocks, const WallColumns& columns);

/// Brings column_values up to date after the lines with moved[line] != 0 were moved; empty: all.
void update_column_values(const BlockMesh& mesh, const WallBlocks& blocks, const WallColumns& columns,
                          std::span<const char> moved, std::vector<float>& values);

/// Puts the points of symmetry patches exactly into the plane.
void flatten_symmetry(BlockMesh& mesh, const WallBlocks& blocks);

}  // namespace flowcage
