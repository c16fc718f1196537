#pragma once
#include <span>
#include <vector>

#include "core/base/types.hpp"

namespace flowcage {

/// Rows of different length in two flat arrays.
/// Row r is values[offsets[r] .. offsets[r+1]); offsets has one entry more than there are rows.
/// Example: rows (7 8) () (9) are offsets 0 2 2 3, values 7 8 9.
template <typename T>
struct Csr {
  std::vector<Offset> offsets{0};
  std::vector<T> values;

  Index size() const { return static_cast<Index>(offsets.size()) - 1; }
  Index row_size(Index r) const { return static_cast<Index>(offsets[r + 1] - offsets[r]); }
  std::span<const T> operator[](Index r) const {
    return {values.data() + offsets[r], static_cast<std::size_t>(offsets[r + 1] - offsets[r])};
  }
  std::span<T> operator[](Index r) {
    return {values.data() + offsets[r], static_cast<std::size_t>(offsets[r + 1] - offsets[r])};
  }
  /// Appends a row.
  template <typename Range>
  void push_row(const Range& row) {
    values.insert(values.end(), std::begin(row), std::end(row));
    offsets.push_back(static_cast<Offset>(values.size()));
  }
  bool operator==(const Csr&) const = default;
};

}  // namespace flowcage
