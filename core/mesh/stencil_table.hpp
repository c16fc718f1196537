#pragma once
#include <span>
#include <vector>

#include "core/base/csr.hpp"

namespace flowcage {

/// The paper's matrix C: each row writes a new point as a linear combination of control vertices.
/// Row r: sum over k in [offsets[r], offsets[r+1]) of weights[k] * points[indices[k]]; indices ascend within
/// a row.
struct StencilTable {
  std::vector<Offset> offsets{0};
  std::vector<Index> indices;
  std::vector<double> weights;
  Index control_vertex_count = 0;

  Index size() const { return static_cast<Index>(offsets.size()) - 1; }
};

/// #rows points. Parallel over rows; the same bits on any number of threads.
/// Precondition: points.size() == table.control_vertex_count.
std::vector<Vec3> apply_stencils(const StencilTable& table, std::span<const Vec3> points);

/// The table that does `first`, then `second`: rows of second written in the control vertices of first.
StencilTable compose(const StencilTable& second, const StencilTable& first);

/// Rows of `a`, then rows of `b` (same control vertices).
StencilTable concatenate(const StencilTable& a, const StencilTable& b);

}  // namespace flowcage
