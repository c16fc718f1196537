#pragma once
#include "core/export/write_ranges.hpp"

namespace flowcage {

/// How many lines a task of a text writer makes.
inline constexpr Offset text_grain = 16384;

/// Appends a line of whole numbers, each plus `first`: the format's number of the first point.
template <std::size_t N>
void append_row(std::string& text, const std::array<Index, N>& row, Offset first) {
  for (std::size_t i = 0; i < N; ++i) {
    if (i != 0) text += ' ';
    append_number(text, row[i] + first);
  }
  text += '\n';
}

/// Writes a line "x y z" for each of `count` points; point(i) is the i-th.
template <typename Point>
void write_point_rows(std::ostream& out, Offset count, const Point& point) {
  write_ranges(out, count, text_grain, [&](Offset begin, Offset end, std::string& text) {
    for (Offset i = begin; i < end; ++i) {
      const Vec3& p = point(i);
      for (int d = 0; d < 3; ++d) {
        append_number(text, p[d]);
        text += d < 2 ? ' ' : '\n';
      }
    }
  });
}

}  // namespace flowcage
