#pragma once
#include <algorithm>
#include <array>
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
  std::vector<double> sum_;    // by control vertex, valid where row_of_ == row_
  std::vector<Index> row_of_;  // last row that used the vertex, counted from 1
  std::vector<Index> touched_;
  Index row_ = 1;
};

/// Joins tables of the same control vertices, in order.
StencilTable join_stencils(std::vector<StencilTable> parts, Index control_vertex_count);

/// Tables of the same control vertices made in parallel: write(begin, end, writers) ends the rows of items
/// [begin, end) in each of the writers, any number an item; rows come out in the items' order.
template <std::size_t table_count, typename Write>
std::array<StencilTable, table_count> build_stencil_tables(Offset item_count, Index control_vertex_count,
                                                           const Write& write) {
  // A writer costs memory in proportion to the control vertices, hence few of them.
  const Offset grain = std::max<Offset>(1024, (item_count + 31) / 32);
  std::array<std::vector<StencilTable>, table_count> parts;
  for (auto& part : parts) part.resize(static_cast<std::size_t>((item_count + grain - 1) / grain));
  parallel_for(item_count, grain, [&](Offset begin, Offset end) {
    std::vector<StencilWriter> writers(table_count, StencilWriter(control_vertex_count));
    write(static_cast<Index>(begin), static_cast<Index>(end), std::span<StencilWriter, table_count>(writers));
    for (std::size_t t = 0; t < table_count; ++t) parts[t][begin / grain] = writers[t].take();
  });
  std::array<StencilTable, table_count> tables;
  for (std::size_t t = 0; t < table_count; ++t) {
    tables[t] = join_stencils(std::move(parts[t]), control_vertex_count);
  }
  return tables;
}

/// One table: write(begin, end, writer).
template <typename Write>
StencilTable build_stencils(Offset item_count, Index control_vertex_count, const Write& write) {
  auto tables = build_stencil_tables<1>(
      item_count, control_vertex_count,
      [&](Index begin, Index end, std::span<StencilWriter, 1> writers) { write(begin, end, writers[0]); });
  return std::move(tables[0]);
}

}  // namespace flowcage
