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
/// With a fold the vertices may be mirror images: their terms go to the originals. (It must outlive this.)
class StencilWriter {
 public:
  explicit StencilWriter(Index control_vertex_count, const MirrorFold* fold = nullptr)
      : fold_(fold), sum_(static_cast<std::size_t>(control_vertex_count)), row_of_(sum_.size(), 0) {
    table_.control_vertex_count = control_vertex_count;
    if (fold_ == nullptr) return;
    table_.mirrors = fold_->planes;
    mirrored_sum_.resize(sum_.size());
  }
  void add(Index vertex, double weight) {
    if (fold_ != nullptr) {
      add(fold_->original_of(vertex), weight, weight * fold_->factors(vertex));
      return;
    }
    if (row_of_[vertex] != row_) {
      row_of_[vertex] = row_;
      sum_[vertex] = weight;
      touched_.push_back(vertex);
    } else {
      sum_[vertex] += weight;
    }
  }
  /// The same with weights by axis; those of axes without a plane are taken from `weight`.
  /// Preconditions: a fold; no image.
  void add(Index vertex, double weight, const Vec3& axis_weights) {
    if (row_of_[vertex] != row_) {
      row_of_[vertex] = row_;
      sum_[vertex] = weight;
      mirrored_sum_[vertex] = axis_weights;
      touched_.push_back(vertex);
    } else {
      sum_[vertex] += weight;
      mirrored_sum_[vertex] += axis_weights;
    }
  }
  /// Ends the row under construction (which may be empty). `lies_in`, bit a: the row's point lies in the
  /// plane of axis a, so that what its terms leave there is rounding.
  void end_row(unsigned lies_in = 0) {
    std::sort(touched_.begin(), touched_.end());
    for (const Index vertex : touched_) {
      if (fold_ != nullptr) {
        Vec3& by_axis = mirrored_sum_[vertex];
        bool empty = sum_[vertex] == 0;
        for (int axis = 0; axis < 3; ++axis) {
          if ((lies_in >> axis & 1U) != 0) by_axis[axis] = 0;
          if (fold_->planes.on[axis] && by_axis[axis] != 0) empty = false;
        }
        if (empty) continue;
        for (int axis = 0; axis < 3; ++axis) {
          if (fold_->planes.on[axis]) table_.mirrored_weights[axis].push_back(by_axis[axis]);
        }
      } else if (sum_[vertex] == 0) {
        continue;
      }
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
  const MirrorFold* fold_;
  std::vector<double> sum_;         // by control vertex, valid where row_of_ == row_
  std::vector<Vec3> mirrored_sum_;  // the same by axis, with a fold
  std::vector<Index> row_of_;       // last row that used the vertex, counted from 1
  std::vector<Index> touched_;
  Index row_ = 1;
};

/// Joins tables of the same control vertices, in order.
StencilTable join_stencils(std::vector<StencilTable> parts, Index control_vertex_count);

/// Tables of the same control vertices made in parallel: write(begin, end, writers) ends the rows of items
/// [begin, end) in each of the writers, any number an item; rows come out in the items' order.
/// `fold` is the writers'.
template <std::size_t table_count, typename Write>
std::array<StencilTable, table_count> build_stencil_tables(Offset item_count, Index control_vertex_count,
                                                           const Write& write,
                                                           const MirrorFold* fold = nullptr) {
  // A writer costs memory in proportion to the control vertices, hence few of them.
  const Offset grain = std::max<Offset>(1024, (item_count + 31) / 32);
  std::array<std::vector<StencilTable>, table_count> parts;
  for (auto& part : parts) part.resize(static_cast<std::size_t>((item_count + grain - 1) / grain));
  parallel_for(item_count, grain, [&](Offset begin, Offset end) {
    std::vector<StencilWriter> writers(table_count, StencilWriter(control_vertex_count, fold));
    write(static_cast<Index>(begin), static_cast<Index>(end), std::span<StencilWriter, table_count>(writers));
    for (std::size_t t = 0; t < table_count; ++t) parts[t][begin / grain] = writers[t].take();
  });
  std::array<StencilTable, table_count> tables;
  for (std::size_t t = 0; t < table_count; ++t) {
    tables[t] = join_stencils(std::move(parts[t]), control_vertex_count);
    if (fold != nullptr) tables[t].mirrors = fold->planes;
  }
  return tables;
}

/// One table: write(begin, end, writer).
template <typename Write>
StencilTable build_stencils(Offset item_count, Index control_vertex_count, const Write& write,
                            const MirrorFold* fold = nullptr) {
  auto tables = build_stencil_tables<1>(
      item_count, control_vertex_count,
      [&](Index begin, Index end, std::span<StencilWriter, 1> writers) { write(begin, end, writers[0]); },
      fold);
  return std::move(tables[0]);
}

}  // namespace flowcage
