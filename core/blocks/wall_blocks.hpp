#pragma once
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/blocks/symmetry_plane.hpp"
#include "core/mesh/block_mesh.hpp"
#include "core/mesh/surface_level.hpp"

namespace flowcage {

/// How a block stands on a face of the wall: its corners (VTK numbers) at the face's corners 0 to 3.
struct WallSeat {
  Index block = no_index;
  std::array<int, 4> foot{0, 1, 2, 3};
};

/// Blocks round a wall that is fitted to CAD, whatever they come from: what everything behind the blocks
/// works on. One line of points leaves the wall at each of its vertices and runs through the block that
/// stands there to its other end (of a shell: the outer boundary; of pillowed blocks: the layer's top).
struct WallBlocks {
  std::shared_ptr<const HexComplex> complex;
  SurfaceLevel wall;            ///< quads only, counter-clockwise seen from the fluid
  std::vector<WallSeat> seats;  ///< #F of wall; no block stands on two faces
  int cage_level = 0;           ///< which level of the fitted cage `wall` is: 0, or 1 where it has n-gons
  std::optional<SymmetryPlane> symmetry;  ///< of an open wall
};

/// Finds the seats: `corner` gives the complex's corner of each vertex of `wall`. Throws Error(input), naming
/// `source` and the place, where a face of the wall is no boundary quad, a block would stand on two faces, or
/// the blocks round a vertex do not share one line.
WallBlocks seat_blocks(std::shared_ptr<const HexComplex> complex, SurfaceLevel wall,
                       std::span<const Index> corner, const std::string& source);

/// Whether a face of the wall is counter-clockwise seen from the block that stands on it, as WallBlocks asks.
bool seen_from_block(const WallBlocks& blocks, Index face);

/// The edge of the complex that leaves the wall at a face's first corner, with its chord; `outward` when the
/// edge runs away from the wall.
struct SeatEdge {
  Index edge = no_index, chord = no_index;
  bool outward = true;
};
SeatEdge seat_edge(const WallBlocks& blocks, Index face);

/// Chords of the lines, ascending: one for each part of the wall that lines leave together.
std::vector<Index> line_chords(const WallBlocks& blocks);

/// A line: where it leaves the wall, as lattice place (i along the face's first side, j along its last) on a
/// face of blocks.wall.
struct WallLine {
  Index face = no_index, i = 0, j = 0;
};

/// The points of a line from the wall (0) to its other end.
PointRow line_points(const BlockMesh& mesh, const WallBlocks& blocks, const WallLine& line);

/// The point of layer k (0: the wall) on a line; of more than a few layers, line_points is cheaper.
Index line_point(const BlockMesh& mesh, const WallBlocks& blocks, const WallLine& line, Index k);

/// Cells along the lines of a chord; with no chord those of all lines, the least where chords differ.
Index line_layers(const BlockMesh& mesh, const WallBlocks& blocks, Index chord = no_index);

/// The line of each vertex of a surface level (the cage refined level.depth times, numbered as in
/// mesh/surface_level), by construction, without coordinates. Lattice places are those of the mesh that was
/// refined level.depth - cage_level times.
std::vector<WallLine> wall_lines(const WallBlocks& blocks, const SurfaceLevel& level);

/// Points of layer k of the block mesh by surface vertex.
std::vector<Index> layer_points(const BlockMesh& mesh, const WallBlocks& blocks,
                                std::span<const WallLine> lines, Index k);

}  // namespace flowcage
