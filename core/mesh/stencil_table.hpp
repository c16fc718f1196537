#pragma once
#include <array>
#include <span>
#include <vector>

#include "core/base/csr.hpp"
#include "core/mesh/mirror_planes.hpp"

namespace flowcage {

/// The paper's matrix C: each row writes a new point as a linear combination of control vertices.
/// Row r: sum over k in [offsets[r], offsets[r+1]) of weights[k] * points[indices[k]]; indices ascend within
/// a row.
/// At mirror planes (mirror_planes.hpp) each coordinate has weights of its own: that of an axis with a plane
/// is value + sum of mirrored_weights[axis][k] * (x - value), without the first term where rows give vectors.
struct StencilTable {
  std::vector<Offset> offsets{0};
  std::vector<Index> indices;
  std::vector<double> weights;  ///< of the axes without a mirror plane
  Index control_vertex_count = 0;
  MirrorPlanes mirrors;
  std::array<std::vector<double>, 3> mirrored_weights;  ///< by axis; empty where there is no plane
  bool of_vectors = false;  ///< rows give vectors (directions, parts of sums), not points

  /// The weights of one coordinate, like `weights`.
  std::span<const double> axis_weights(int axis) const {
    return mirrors.on[axis] ? mirrored_weights[axis] : weights;
  }
  /// Those of term k for all three.
  Vec3 term_weights(Offset k) const {
    Vec3 by_axis;
    for (int axis = 0; axis < 3; ++axis) by_axis[axis] = axis_weights(axis)[k];
    return by_axis;
  }
  Index size() const { return static_cast<Index>(offsets.size()) - 1; }
};

/// #rows points. Parallel over rows; the same bits on any number of threads.
/// Precondition: points.size() == table.control_vertex_count.
std::vector<Vec3> apply_stencils(const StencilTable& table, std::span<const Vec3> points);

/// The linear part: what a displacement of the control vertices changes. The same but at mirror planes, whose
/// `value` plays no part.
std::vector<Vec3> apply_to_vectors(const StencilTable& table, std::span<const Vec3> vectors);

/// The table that does `first`, then `second`: rows of second written in the control vertices of first.
/// Precondition: rows of first give points.
StencilTable compose(const StencilTable& second, const StencilTable& first);

/// Rows of `a`, then rows of `b` (same control vertices, both points or both vectors).
StencilTable concatenate(const StencilTable& a, const StencilTable& b);

}  // namespace flowcage
