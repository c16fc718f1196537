#pragma once
#include <span>
#include <vector>

#include "core/mesh/block_mesh.hpp"

namespace flowcage {

/// A line of points along a chord: through `block` along `axis`, at (i, j) on the axes axis + 1 and axis + 2
/// (mod 3); from the block's low side on when `forward`.
struct SheetLine {
  Index block = no_index;
  int axis = 0;
  Index i = 0, j = 0;
  bool forward = true;
};

/// The sheet of a chord: every block that has edges of it, seen as a net of lines that run side by side from
/// the sheet's near end (t = 0) to its far end. A wing's layers are one part of such a sheet; behind the
/// trailing edge and past the tip it goes on to the far field.
struct ChordSheet {
  Index chord = no_index;
  std::vector<SheetLine> lines;             ///< each once, by the first block that has it
  std::vector<std::array<Index, 4>> faces;  ///< lines at the corners of each column of cells, cyclic
};

/// An edge of the chord of which the near end is known.
struct SheetStart {
  Index edge = no_index;
  bool forward = true;  ///< edges[edge][0] is the near end
};

/// `starts`: at least one edge of the chord; the others follow. Throws Error(input), naming a place, where
/// the near end cannot be told: two starts contradict each other (walls at both ends of the same sheet), the
/// sheet passes through a block twice, or it is one-sided.
ChordSheet chord_sheet(const BlockMesh& mesh, Index chord, std::span<const SheetStart> starts);

/// The point at t, 0 .. divisions of the chord, on a line. `mesh` may have other divisions along the chord
/// than the one that the sheet was found in.
Index sheet_point(const BlockMesh& mesh, const SheetLine& line, Index t);

/// Points on a line from the near end on.
std::vector<Vec3> sheet_positions(const BlockMesh& mesh, const ChordSheet& sheet, const SheetLine& line);

}  // namespace flowcage
