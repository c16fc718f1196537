#include "core/mesh/stencil_table.hpp"

#include <cassert>

#include "core/mesh/stencil_builder.hpp"

namespace flowcage {

namespace {

// Rows at mirror planes: start + sum of weights by axis times (points - origin).
std::vector<Vec3> apply_folded(const StencilTable& table, std::span<const Vec3> points, const Vec3& origin,
                               const Vec3& start) {
  std::vector<Vec3> result(static_cast<std::size_t>(table.size()));
  parallel_for(table.size(), 4096, [&](Offset begin, Offset end) {
    for (Offset row = begin; row < end; ++row) {
      Vec3 sum = Vec3::Zero();
      for (Offset k = table.offsets[row]; k < table.offsets[row + 1]; ++k) {
        sum += table.term_weights(k).cwiseProduct(points[table.indices[k]] - origin);
      }
      result[row] = start + sum;
    }
  });
  return result;
}

}  // namespace

std::vector<Vec3> apply_stencils(const StencilTable& table, std::span<const Vec3> points) {
  assert(static_cast<Index>(points.size()) == table.control_vertex_count);
  if (table.mirrors.any()) {
    const Vec3& origin = table.mirrors.value;
    return apply_folded(table, points, origin, table.of_vectors ? Vec3(Vec3::Zero()) : origin);
  }
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

std::vector<Vec3> apply_to_vectors(const StencilTable& table, std::span<const Vec3> vectors) {
  return table.mirrors.any() ? apply_folded(table, vectors, Vec3::Zero(), Vec3::Zero())
                             : apply_stencils(table, vectors);
}

StencilTable compose(const StencilTable& second, const StencilTable& first) {
  assert(second.control_vertex_count == first.size() && !first.of_vectors);
  MirrorFold fold;
  fold.planes = unite(second.mirrors, first.mirrors);
  const bool mirrored = fold.planes.any();
  StencilTable result = build_stencils(
      second.size(), first.control_vertex_count,
      [&](Index begin, Index end, StencilWriter& out) {
        for (Index row = begin; row < end; ++row) {
          for (Offset k = second.offsets[row]; k < second.offsets[row + 1]; ++k) {
            const Index middle = second.indices[k];
            for (Offset j = first.offsets[middle]; j < first.offsets[middle + 1]; ++j) {
              const double weight = second.weights[k] * first.weights[j];
              if (mirrored) {
                out.add(first.indices[j], weight, second.term_weights(k).cwiseProduct(first.term_weights(j)));
              } else {
                out.add(first.indices[j], weight);
              }
            }
          }
          out.end_row();
        }
      },
      mirrored ? &fold : nullptr);
  result.of_vectors = second.of_vectors;
  return result;
}

StencilTable concatenate(const StencilTable& a, const StencilTable& b) {
  assert(a.control_vertex_count == b.control_vertex_count && a.of_vectors == b.of_vectors);
  return join_stencils({a, b}, a.control_vertex_count);
}

StencilTable join_stencils(std::vector<StencilTable> parts, Index control_vertex_count) {
  StencilTable all;
  if (parts.size() == 1) all = std::move(parts.front());
  all.control_vertex_count = control_vertex_count;
  if (parts.size() <= 1) return all;

  std::vector<Offset> first_row(parts.size() + 1, 0), first_term(parts.size() + 1, 0);
  for (std::size_t p = 0; p < parts.size(); ++p) {
    all.mirrors = unite(all.mirrors, parts[p].mirrors);
    first_row[p + 1] = first_row[p] + parts[p].size();
    first_term[p + 1] = first_term[p] + parts[p].offsets.back();
  }
  all.of_vectors = parts.front().of_vectors;
  all.offsets.resize(static_cast<std::size_t>(first_row.back() + 1));
  all.indices.resize(static_cast<std::size_t>(first_term.back()));
  all.weights.resize(all.indices.size());
  for (int axis = 0; axis < 3; ++axis) {
    if (all.mirrors.on[axis]) all.mirrored_weights[axis].resize(all.indices.size());
  }
  parallel_for(static_cast<Offset>(parts.size()), 1, [&](Offset begin, Offset end) {
    for (Offset p = begin; p < end; ++p) {
      const StencilTable& part = parts[p];
      std::transform(part.offsets.begin() + 1, part.offsets.end(), all.offsets.begin() + first_row[p] + 1,
                     [&](Offset offset) { return first_term[p] + offset; });
      std::copy(part.indices.begin(), part.indices.end(), all.indices.begin() + first_term[p]);
      std::copy(part.weights.begin(), part.weights.end(), all.weights.begin() + first_term[p]);
      for (int axis = 0; axis < 3; ++axis) {
        if (!all.mirrors.on[axis]) continue;
        const auto weights = part.axis_weights(axis);
        std::copy(weights.begin(), weights.end(), all.mirrored_weights[axis].begin() + first_term[p]);
      }
      parts[p] = {};
    }
  });
  return all;
}

}  // namespace flowcage
