#include "core/mesh/stencil_table.hpp"

#include <cassert>

#include "core/mesh/stencil_builder.hpp"

namespace flowcage {

std::vector<Vec3> apply_stencils(const StencilTable& table, std::span<const Vec3> points) {
  assert(static_cast<Index>(points.size()) == table.control_vertex_count);
  std::vector<Vec3> result(static_cast<std::size_t>(table.size()));
  parallel_for(table.size(), 4096, [&](Offset begin, Offset end) {
    for (Offset row = begin; row < end; ++row) {
      Vec3 sum = Vec3::Zero();
      for (Offset k = table.offsets[row]; k < table.offsets[row + 1]; ++k) {
        sum += table.weights[k] * points[table.indices[k]];
      }
      result[row] = sum;
    }
  });
  return result;
}

StencilTable compose(const StencilTable& second, const StencilTable& first) {
  assert(second.control_vertex_count == first.size());
  return build_stencils(second.size(), first.control_vertex_count,
                        [&](Index begin, Index end, StencilWriter& out) {
                          for (Index row = begin; row < end; ++row) {
                            for (Offset k = second.offsets[row]; k < second.offsets[row + 1]; ++k) {
                              const Index middle = second.indices[k];
                              for (Offset j = first.offsets[middle]; j < first.offsets[middle + 1]; ++j) {
                                out.add(first.indices[j], second.weights[k] * first.weights[j]);
                              }
                            }
                            out.end_row();
                          }
                        });
}

StencilTable concatenate(const StencilTable& a, const StencilTable& b) {
  assert(a.control_vertex_count == b.control_vertex_count);
  return join_stencils({a, b}, a.control_vertex_count);
}

StencilTable join_stencils(std::vector<StencilTable> parts, Index control_vertex_count) {
  StencilTable all;
  if (parts.size() == 1) all = std::move(parts.front());
  all.control_vertex_count = control_vertex_count;
  if (parts.size() <= 1) return all;

  std::vector<Offset> first_row(parts.size() + 1, 0), first_term(parts.size() + 1, 0);
  for (std::size_t p = 0; p < parts.size(); ++p) {
    first_row[p + 1] = first_row[p] + parts[p].size();
    first_term[p + 1] = first_term[p] + parts[p].offsets.back();
  }
  all.offsets.resize(static_cast<std::size_t>(first_row.back() + 1));
  all.indices.resize(static_cast<std::size_t>(first_term.back()));
  all.weights.resize(all.indices.size());
  parallel_for(static_cast<Offset>(parts.size()), 1, [&](Offset begin, Offset end) {
    for (Offset p = begin; p < end; ++p) {
      const StencilTable& part = parts[p];
      std::transform(part.offsets.begin() + 1, part.offsets.end(), all.offsets.begin() + first_row[p] + 1,
                     [&](Offset offset) { return first_term[p] + offset; });
      std::copy(part.indices.begin(), part.indices.end(), all.indices.begin() + first_term[p]);
      std::copy(part.weights.begin(), part.weights.end(), all.weights.begin() + first_term[p]);
      parts[p] = {};
    }
  });
  return all;
}

}  // namespace flowcage
