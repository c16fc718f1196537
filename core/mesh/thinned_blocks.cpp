#include "core/mesh/thinned_blocks.hpp"

#include <algorithm>
#include <limits>

namespace flowcage {
namespace {

// Divisions that are kept of a chord. Of an odd number an odd one: no line falls between two in the middle,
// where the two directions would choose differently.
Index kept_divisions(Index divisions, Index stride) {
  const Index kept = (divisions + stride - 1) / stride;
  return divisions % 2 == 1 && kept % 2 == 0 ? kept + 1 : kept;
}

// The line of `divisions` that line t of `kept` is: t divisions / kept, rounded alike from both ends.
Index line_of(Index t, Index kept, Index divisions) {
  const auto rounded = [&](Offset s) { return static_cast<Index>((s * divisions + kept / 2) / kept); };
  return 2 * t <= kept ? rounded(t) : divisions - rounded(kept - t);
}

std::array<std::vector<Index>, 3> lines_of(const std::array<Index, 3>& kept,
                                           const std::array<Index, 3>& dims) {
  std::array<std::vector<Index>, 3> lines;
  for (int axis = 0; axis < 3; ++axis) {
    for (Index t = 0; t <= kept[axis]; ++t) lines[axis].push_back(line_of(t, kept[axis], dims[axis]));
  }
  return lines;
}

Index least_stride(const BlockMesh& fine, Offset most_cells) {
  const Index most = *std::ranges::max_element(fine.chord_divisions());
  for (Index stride = 1; stride < most; ++stride) {
    Offset cells = 0;
    for (Index b = 0; b < fine.block_count(); ++b) {
      const auto [ni, nj, nk] = fine.dims(b);
      cells += Offset{kept_divisions(ni, stride)} * kept_divisions(nj, stride) * kept_divisions(nk, stride);
    }
    if (cells <= most_cells) return stride;
  }
  return most;
}

}  // namespace

ThinnedBlocks thin_blocks(const BlockMesh& fine, Offset most_cells) {
  const Index stride = least_stride(fine, most_cells);
  std::vector<Index> divisions = fine.chord_divisions();
  for (Index& d : divisions) d = kept_divisions(d, stride);
  const auto count = static_cast<std::size_t>(BlockMesh::point_count(fine.complex(), divisions));
  ThinnedBlocks thinned{{fine.shared_complex(), std::move(divisions), std::vector<Vec3>(count)},
                        std::vector<Index>(count),
                        stride};
  BlockMesh& mesh = thinned.mesh;
  for (Index b = 0; b < mesh.block_count(); ++b) {
    const auto dims = mesh.dims(b);
    const auto lines = lines_of(dims, fine.dims(b));
    for (Index k = 0; k <= dims[2]; ++k) {
      for (Index j = 0; j <= dims[1]; ++j) {
        for (Index i = 0; i <= dims[0]; ++i) {
          thinned.point[mesh.point_number(b, i, j, k)] =
              fine.point_number(b, lines[0][i], lines[1][j], lines[2][k]);
        }
      }
    }
  }
  for (std::size_t p = 0; p < count; ++p) mesh.mutable_points()[p] = fine.points()[thinned.point[p]];
  for (std::size_t p = 0; p < fine.patches().size(); ++p) mesh.set_patch_type(p, fine.patches()[p].type);
  return thinned;
}

std::vector<float> least_of_covered(const BlockMesh& fine, const ThinnedBlocks& thinned,
                                    std::span<const float> values) {
  const BlockMesh& mesh = thinned.mesh;
  std::vector<float> least(static_cast<std::size_t>(mesh.cell_count()), std::numeric_limits<float>::max());
  for (Index b = 0; b < mesh.block_count(); ++b) {
    const auto kept = mesh.dims(b);
    const auto dims = fine.dims(b);
    const auto lines = lines_of(kept, dims);
    std::array<std::vector<Index>, 3> cover;  // the kept cell of each finer one along an axis
    for (int axis = 0; axis < 3; ++axis) {
      for (Index t = 0; t < kept[axis]; ++t)
        cover[axis].resize(static_cast<std::size_t>(lines[axis][t + 1]), t);
    }
    Offset cell = fine.block_begin(b);
    for (Index k = 0; k < dims[2]; ++k) {
      for (Index j = 0; j < dims[1]; ++j) {
        const Offset row =
            mesh.block_begin(b) + Offset{kept[0]} * (cover[1][j] + Offset{kept[1]} * cover[2][k]);
        for (Index i = 0; i < dims[0]; ++i, ++cell) {
          float& covering = least[row + cover[0][i]];
          covering = std::min(covering, values[cell]);
        }
      }
    }
  }
  return least;
}

}  // namespace flowcage
