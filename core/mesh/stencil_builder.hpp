#pragma once
#include <algorithm>
#include <utility>
#include <vector>

#include "core/base/parallel.hpp"
#include "core/mesh/stencil_table.hpp"

namespace flowcage {

/// Collects rows of a stencil table, term by term in any order. Terms of the same control vertex add up;
/// terms that end as exactly zero are left out.
class StencilWriter {
 public:
  explicit StencilWriter(Index control_vertex_count)
      : sum_(static_cast<std::size_t>(control_vertex_count)), row_of_(sum_.size(), 0) {
    table_.control_vertex_count = control_vertex_count;
  }
  void add(Index vertex, double weight) {
    if (row_of_[vertex] != row_) {
      row_of_[vertex] = row_;
      sum_[vertex] = weight;
      touched_.push_back(vertex);
    } else {
      sum_[vertex] += weight;
    }
  }
  /// Ends the row under construction (which may be empty).
  void end_row() {
    std::sort(touched_.begin(), touched_.end());
    for (const Index vertex : touched_) {
      if (sum_[vertex] == 0) continue;
      table_.indices.push_back(vertex);
      table_.weights.push_back(sum_[vertex]);
    }
    table_.offsets.push_back(static_cast<Offset>(table_.indices.size()));
    touched_.clear();
    ++row_;
  }
  const StencilTable& table() const { return table_; }
  StencilTable take() { return std::move(table_); }

 private:
  StencilTable table_;
  std::vector<double> sum_;     // by control vertex, valid where row_of_ == row_
  std::vector<Offset> row_of_;  // last row that used the vertex, counted from 1
  std::vector<Index> touched_;
  Offset row_ = 1;
};

/// Joins tables of the same control vertices, in order.
StencilTable join_stencils(std::vector<StencilTable> parts, Index control_vertex_count);

/// A table made in parallel: write(begin, end, writer) ends the rows of items [begin, end), any number an
/// item; rows come out in the items' order.
template <typename Write>
StencilTable build_stencils(Offset item_count, Index control_vertex_count, const Write& write) {
  // A writer costs memory in proportion to the control vertices, hence few of them.
  const Offset grain = std::max<Offset>(1024, (item_count + 63) / 64);
  std::vector<StencilTable> parts(static_cast<std::size_t>((item_count + grain - 1) / grain));
  parallel_for(item_count, grain, [&](Offset begin, Offset end) {
    StencilWriter writer(control_vertex_count);
    write(static_cast<Index>(begin), static_cast<Index>(end), writer);
    parts[begin / grain] = writer.take();
  });
  return join_stencils(std::move(parts), control_vertex_count);
}

}  // namespace flowcage
