#include "core/mesh/chord_sheet.hpp"

#include <fmt/format.h>

#include <map>

#include "core/base/error.hpp"
#include "core/mesh/hex_numbering.hpp"

namespace flowcage {
namespace {

/// Which of the chord's edges run away from the near end (1) or toward it (0), by edge; 2 off the chord.
class EdgeDirections {
 public:
  EdgeDirections(const HexComplex& complex, Index chord) : complex_(complex), chord_(chord) {
    for (std::size_t e = 0; e < complex.edges.size(); ++e) {
      const auto [low, high] = std::minmax(complex.edges[e][0], complex.edges[e][1]);
      edge_of_[{low, high}] = static_cast<Index>(e);
    }
    quads_of_.resize(complex.edges.size());
    for (std::size_t q = 0; q < complex.quads.size(); ++q) {
      for (int c = 0; c < 4; ++c) {
        const Index e = side(static_cast<Index>(q), c);
        if (complex.edge_chord[e] == chord) quads_of_[e].push_back(static_cast<Index>(q));
      }
    }
    direction_.assign(complex.edges.size(), 2);
  }

  std::vector<std::uint8_t> spread(std::span<const SheetStart> starts) {
    for (const SheetStart& start : starts) set(start.edge, start.forward);
    while (!front_.empty()) {
      const Index e = front_.back();
      front_.pop_back();
      for (const Index q : quads_of_[e]) {
        for (int c = 0; c < 4; ++c) {
          if (side(q, c) != e) continue;
          const Index opposite = side(q, (c + 2) % 4);
          // Round the quad the two run against each other.
          const bool along = complex_.edges[e][0] == complex_.quads[q][c];
          const bool opposite_along = complex_.edges[opposite][0] == complex_.quads[q][(c + 2) % 4];
          set(opposite, (direction_[e] == 1) == (along != opposite_along));
        }
      }
    }
    return direction_;
  }

 private:
  Index side(Index q, int c) const {
    const auto [low, high] = std::minmax(complex_.quads[q][c], complex_.quads[q][(c + 1) % 4]);
    return edge_of_.at({low, high});
  }
  void set(Index e, bool forward) {
    if (complex_.edge_chord[e] != chord_) {
      throw Error(ErrorKind::internal, "chord_sheet: a start is no edge of the chord", "report this defect");
    }
    const std::uint8_t value = forward ? 1 : 0;
    if (direction_[e] == 2) {
      direction_[e] = value;
      front_.push_back(e);
    } else if (direction_[e] != value) {
      throw Error(ErrorKind::input,
                  fmt::format("the sheet of blocks at {} has a wall at both of its ends, or is one-sided",
                              place(complex_.points[complex_.edges[e][0]])),
                  "divide the blocks there, so that no chain of opposite edges joins two walls");
    }
  }

  const HexComplex& complex_;
  Index chord_;
  std::map<std::array<Index, 2>, Index> edge_of_;
  std::vector<std::vector<Index>> quads_of_;
  std::vector<std::uint8_t> direction_;
  std::vector<Index> front_;
};

/// Through which axis of a block the chord passes; no_index: none.
int chord_axis(const HexComplex& complex, Index block, Index chord) {
  int axis = no_index;
  for (int a = 0; a < 3; ++a) {
    if (complex.edge_chord[complex.hex_edges[block][4 * a]] != chord) continue;
    if (axis != no_index) {
      throw Error(ErrorKind::input,
                  fmt::format("a sheet of blocks passes twice through the block at {}",
                              place(complex.points[complex.hexes[block][0]])),
                  "layers cannot be graded on such blocks: divide them so that no sheet crosses itself");
    }
    axis = a;
  }
  return axis;
}

}  // namespace

Index sheet_point(const BlockMesh& mesh, const SheetLine& line, Index t) {
  std::array<Index, 3> at{};
  at[line.axis] = line.forward ? t : mesh.dims(line.block)[line.axis] - t;
  at[(line.axis + 1) % 3] = line.i;
  at[(line.axis + 2) % 3] = line.j;
  return mesh.point_number(line.block, at[0], at[1], at[2]);
}

std::vector<Vec3> sheet_positions(const BlockMesh& mesh, const ChordSheet& sheet, const SheetLine& line) {
  std::vector<Vec3> out(mesh.chord_divisions()[sheet.chord] + 1);
  for (std::size_t t = 0; t < out.size(); ++t) {
    out[t] = mesh.points()[sheet_point(mesh, line, static_cast<Index>(t))];
  }
  return out;
}

ChordSheet chord_sheet(const BlockMesh& mesh, Index chord, std::span<const SheetStart> starts) {
  const HexComplex& complex = mesh.complex();
  const std::vector<std::uint8_t> direction = EdgeDirections(complex, chord).spread(starts);
  ChordSheet sheet;
  sheet.chord = chord;
  // By a line's first two points: several lines may leave the same one.
  std::map<std::array<Index, 2>, Index> line_at;
  for (Index b = 0; b < mesh.block_count(); ++b) {
    const int axis = chord_axis(complex, b, chord);
    if (axis == no_index) continue;
    const Index edge = complex.hex_edges[b][4 * axis];
    const bool with_block = complex.edges[edge][0] == complex.hexes[b][hex_edges[4 * axis][0]];
    const bool forward = (direction[edge] == 1) == with_block;
    const auto n = mesh.dims(b);
    const Index nu = n[(axis + 1) % 3];
    const Index nv = n[(axis + 2) % 3];
    std::vector<Index> number;
    for (Index j = 0; j <= nv; ++j) {
      for (Index i = 0; i <= nu; ++i) {
        const SheetLine line{b, axis, i, j, forward};
        const auto next = static_cast<Index>(sheet.lines.size());
        const auto [at, fresh] =
            line_at.try_emplace({sheet_point(mesh, line, 0), sheet_point(mesh, line, 1)}, next);
        if (fresh) sheet.lines.push_back(line);
        number.push_back(at->second);
      }
    }
    for (Index j = 0; j < nv; ++j) {
      for (Index i = 0; i < nu; ++i) {
        const Index first = i + (nu + 1) * j;
        sheet.faces.push_back(
            {number[first], number[first + 1], number[first + nu + 2], number[first + nu + 1]});
      }
    }
  }
  return sheet;
}

}  // namespace flowcage
