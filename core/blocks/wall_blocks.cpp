#include "core/blocks/wall_blocks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "core/base/error.hpp"
#include "core/mesh/hex_numbering.hpp"

namespace flowcage {
namespace {

/// The corner of a hex across from a corner of one of its faces.
int head_of(const WallSeat& seat, int c) {
  const auto& at = hex_corner_ijk[seat.foot[c]];
  const auto& diagonal = hex_corner_ijk[seat.foot[(c + 2) % 4]];
  std::array<int, 3> head = at;
  for (int a = 0; a < 3; ++a) {
    if (at[a] == diagonal[a]) head[a] = 1 - at[a];
  }
  return hex_corner_at(head[0], head[1], head[2]);
}

std::array<Index, 4> sorted(std::array<Index, 4> corners) {
  std::sort(corners.begin(), corners.end());
  return corners;
}

}  // namespace

WallBlocks seat_blocks(std::shared_ptr<const HexComplex> complex, SurfaceLevel wall,
                       std::span<const Index> corner, const std::string& source) {
  const HexComplex& c = *complex;
  std::map<std::array<Index, 4>, Index> boundary;
  for (std::size_t q = 0; q < c.quads.size(); ++q) {
    if (c.quad_hexes[q][1] == no_index) boundary[sorted(c.quads[q])] = static_cast<Index>(q);
  }
  WallBlocks blocks;
  std::vector<Index> face_of(c.hexes.size(), no_index), head(wall.vertex_count(), no_index);
  for (Index f = 0; f < wall.face_count(); ++f) {
    const auto v = wall.face_vertices[f];
    const std::array<Index, 4> at{corner[v[0]], corner[v[1]], corner[v[2]], corner[v[3]]};
    const std::string where = fmt::format("face {} at {}", f, place(c.points[at[0]]));
    const auto quad = boundary.find(sorted(at));
    if (quad == boundary.end()) {
      throw input_error(source, 0, where + " of the wall is no boundary face of a block",
                        "give the wall's faces as they bound the blocks");
    }
    WallSeat seat;
    seat.block = c.quad_hexes[quad->second][0];
    if (face_of[seat.block] != no_index) {
      throw input_error(source, 0,
                        fmt::format("the block at {} stands on two faces of the wall ({} and {})", where,
                                    face_of[seat.block], f),
                        "put a layer of blocks round the wall");
    }
    face_of[seat.block] = f;
    const HexPoints& hex = c.hexes[seat.block];
    for (int n = 0; n < 4; ++n) {
      seat.foot[n] = static_cast<int>(std::find(hex.begin(), hex.end(), at[n]) - hex.begin());
    }
    for (int n = 0; n < 4; ++n) {
      Index& line = head[v[n]];
      const Index end = hex[head_of(seat, n)];
      if (line != no_index && line != end) {
        throw input_error(source, 0,
                          fmt::format("the blocks round vertex {} of the wall at {} do not share one line",
                                      v[n], place(c.points[at[n]])),
                          "put a layer of blocks round the wall");
      }
      line = end;
    }
    blocks.seats.push_back(seat);
  }
  blocks.complex = std::move(complex);
  blocks.wall = std::move(wall);
  return blocks;
}

bool seen_from_block(const WallBlocks& blocks, Index face) {
  const WallSeat& seat = blocks.seats[face];
  const auto at = [](int corner) {
    const auto& ijk = hex_corner_ijk[corner];
    return Vec3(ijk[0], ijk[1], ijk[2]);
  };
  const Vec3 foot = at(seat.foot[0]);
  return (at(seat.foot[1]) - foot).cross(at(seat.foot[3]) - foot).dot(at(head_of(seat, 0)) - foot) > 0;
}

SeatEdge seat_edge(const WallBlocks& blocks, Index face) {
  const WallSeat& seat = blocks.seats[face];
  const int foot = seat.foot[0];
  const int head = head_of(seat, 0);
  for (int e = 0; e < 12; ++e) {
    const auto& [a, b] = hex_edges[e];
    if (std::minmax(a, b) != std::minmax(foot, head)) continue;
    const Index edge = blocks.complex->hex_edges[seat.block][e];
    const Index from = blocks.complex->hexes[seat.block][foot];
    return {edge, blocks.complex->edge_chord[edge], blocks.complex->edges[edge][0] == from};
  }
  return {};
}

std::vector<Index> line_chords(const WallBlocks& blocks) {
  std::vector<Index> chords;
  for (std::size_t f = 0; f < blocks.seats.size(); ++f) {
    chords.push_back(seat_edge(blocks, static_cast<Index>(f)).chord);
  }
  std::sort(chords.begin(), chords.end());
  chords.erase(std::unique(chords.begin(), chords.end()), chords.end());
  return chords;
}

namespace {

/// Where a line stands in its block: the lattice place of its point k, and the axis along which k counts.
struct LineSeat {
  std::array<Index, 3> at{};
  int axis = 0;
  bool forward = true;  ///< k grows as the axis does
};

LineSeat seat_of(const BlockMesh& mesh, const WallBlocks& blocks, const WallLine& line) {
  const WallSeat& seat = blocks.seats[line.face];
  const auto n = mesh.dims(seat.block);
  const auto& origin = hex_corner_ijk[seat.foot[0]];
  const auto& along_i = hex_corner_ijk[seat.foot[1]];
  const auto& along_j = hex_corner_ijk[seat.foot[3]];
  LineSeat out;
  for (int a = 0; a < 3; ++a) {
    const bool is_i = along_i[a] != origin[a];
    if (!is_i && along_j[a] == origin[a]) {
      out.axis = a;
      out.forward = origin[a] == 0;
      continue;
    }
    const Index steps = is_i ? line.i : line.j;
    out.at[a] = origin[a] == 0 ? steps : n[a] - steps;
  }
  return out;
}

}  // namespace

PointRow line_points(const BlockMesh& mesh, const WallBlocks& blocks, const WallLine& line) {
  const LineSeat seat = seat_of(mesh, blocks, line);
  const PointRow row = mesh.point_row(blocks.seats[line.face].block, seat.axis, seat.at);
  return seat.forward ? row : row.reversed();
}

Index line_point(const BlockMesh& mesh, const WallBlocks& blocks, const WallLine& line, Index k) {
  LineSeat seat = seat_of(mesh, blocks, line);
  const Index block = blocks.seats[line.face].block;
  seat.at[seat.axis] = seat.forward ? k : mesh.dims(block)[seat.axis] - k;
  return mesh.point_number(block, seat.at[0], seat.at[1], seat.at[2]);
}

Index line_layers(const BlockMesh& mesh, const WallBlocks& blocks, Index chord) {
  if (chord != no_index) return mesh.chord_divisions()[chord];
  const std::vector<Index> chords = line_chords(blocks);
  Index least = mesh.chord_divisions()[chords.front()];
  for (const Index c : chords) least = std::min(least, mesh.chord_divisions()[c]);
  return least;
}

std::vector<WallLine> wall_lines(const WallBlocks& blocks, const SurfaceLevel& level) {
  // Where a face of some level lies: its face of the wall, and the lattice places of its corners there.
  struct Place {
    Index face;
    std::array<std::array<Index, 2>, 4> corners;
  };
  std::vector<Place> places;
  places.reserve(blocks.wall.face_count());
  for (Index f = 0; f < blocks.wall.face_count(); ++f)
    places.push_back({f, {{{0, 0}, {1, 0}, {1, 1}, {0, 1}}}});
  for (int depth = blocks.cage_level; depth < level.depth; ++depth) {
    std::vector<Place> children;
    children.reserve(4 * places.size());
    for (const Place& p : places) {
      const auto sum = [&](int a, int b) {
        return std::array<Index, 2>{p.corners[a][0] + p.corners[b][0], p.corners[a][1] + p.corners[b][1]};
      };
      for (int i = 0; i < 4; ++i) {  // (corner i, edge point i, face point, edge point i-1)
        children.push_back({p.face, {sum(i, i), sum(i, (i + 1) % 4), sum(0, 2), sum((i + 3) % 4, i)}});
      }
    }
    places = std::move(children);
  }
  if (static_cast<Index>(places.size()) != level.face_count()) {
    throw Error(ErrorKind::internal, "wall_lines: the surface level is not one of the blocks' cage",
                "report this defect");
  }
  std::vector<WallLine> lines(level.vertex_count());
  for (Index f = 0; f < level.face_count(); ++f) {
    for (int c = 0; c < 4; ++c) {
      const auto& [i, j] = places[f].corners[c];
      lines[level.face_vertices[f][c]] = {places[f].face, i, j};
    }
  }
  return lines;
}

std::vector<Index> layer_points(const BlockMesh& mesh, const WallBlocks& blocks,
                                std::span<const WallLine> lines, Index k) {
  std::vector<Index> points;
  points.reserve(lines.size());
  for (const WallLine& line : lines) points.push_back(line_point(mesh, blocks, line, k));
  return points;
}

}  // namespace flowcage
