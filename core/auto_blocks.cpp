#include "core/auto_blocks.hpp"

#include <algorithm>
#include <memory>

namespace flowcage {
namespace {

// What untangling may cost, about a second a million: where it needs more it rarely ends well.
constexpr double most_evaluations = 3e7;

/// Displacements of the fixed corners (`moved`) spread harmonically over the edges of the complex.
void spread(const HexComplex& complex, const std::vector<char>& fixed, std::vector<Vec3>& moved) {
  constexpr int sweeps = 200;
  std::vector<Vec3> sum(moved.size());
  std::vector<double> weight(moved.size());
  for (int sweep = 0; sweep < sweeps; ++sweep) {
    std::fill(sum.begin(), sum.end(), Vec3::Zero());
    std::fill(weight.begin(), weight.end(), 0);
    for (const auto& [a, b] : complex.edges) {
      const double w = 1 / std::max((complex.points[a] - complex.points[b]).squaredNorm(), 1e-300);
      sum[a] += w * moved[b];
      sum[b] += w * moved[a];
      weight[a] += w;
      weight[b] += w;
    }
    for (std::size_t v = 0; v < moved.size(); ++v) {
      if (fixed[v] == 0) moved[v] = sum[v] / weight[v];
    }
  }
}

/// Per corner, the axes (bits) across which the symmetry planes lie that it is in.
std::vector<std::uint8_t> plane_axes(const HexComplex& complex) {
  std::vector<std::uint8_t> axes(complex.points.size(), 0);
  for (std::size_t q = 0; q < complex.quads.size(); ++q) {
    if (complex.quad_patch[q] == no_index) continue;
    if (complex.patches[complex.quad_patch[q]].type != PatchType::symmetry) continue;
    const auto& corners = complex.quads[q];
    for (int axis = 0; axis < 3; ++axis) {
      const double value = complex.points[corners[0]][axis];
      const bool flat = std::all_of(corners.begin(), corners.end(),
                                    [&](Index c) { return complex.points[c][axis] == value; });
      if (!flat) continue;
      for (const Index v : corners) {
        axes[v] = static_cast<std::uint8_t>(axes[v] | in_plane(axis).frozen_axes);
      }
    }
  }
  return axes;
}

/// Which corners may move how: walls and far fields stay, symmetry planes are slid in.
std::vector<PointFreedom> freedoms(const HexComplex& complex, const std::vector<std::uint8_t>& axes) {
  std::vector<PointFreedom> freedom(complex.points.size());
  for (std::size_t v = 0; v < freedom.size(); ++v) freedom[v].frozen_axes = axes[v];
  for (std::size_t q = 0; q < complex.quads.size(); ++q) {
    if (complex.quad_patch[q] == no_index) continue;
    if (complex.patches[complex.quad_patch[q]].type == PatchType::symmetry) continue;
    for (const Index v : complex.quads[q]) freedom[v] = fixed_point;
  }
  return freedom;
}

}  // namespace

PlacedBlocks place_blocks(AmbientBlocks blocks, const TargetSurface& target, Progress& progress) {
  PlacedBlocks result;
  FitSettings settings;
  settings.levels = 0;
  const SurfaceFit fit = fit_surface(blocks.cage, target, settings, progress);
  result.unmatched_chains = fit.unmatched_chains;
  HexComplex& complex = blocks.complex;
  const std::vector<std::uint8_t> planes = plane_axes(complex);
  std::vector<PointFreedom> freedom = freedoms(complex, planes);
  std::vector<Vec3> moved(complex.points.size(), Vec3::Zero());
  std::vector<char> fixed(moved.size(), 0);
  for (std::size_t v = 0; v < moved.size(); ++v) fixed[v] = freedom[v].moves() ? 0 : 1;
  for (std::size_t v = 0; v < blocks.cage.points.size(); ++v) {
    const Index corner = blocks.vertex_corner[v];
    Vec3& p = blocks.cage.points[v];
    p = fit.vertex_targets[v].position;
    for (int axis = 0; axis < 3; ++axis) {  // to the bit in symmetry planes
      if ((planes[corner] >> axis & 1) != 0) p[axis] = complex.points[corner][axis];
    }
    moved[corner] = p - complex.points[corner];
    fixed[corner] = 1;
  }
  spread(complex, fixed, moved);
  for (std::size_t v = 0; v < moved.size(); ++v) {
    for (int axis = 0; axis < 3; ++axis) {
      const bool frozen = (freedom[v].frozen_axes >> axis & 1) != 0 && fixed[v] == 0;
      if (!frozen) complex.points[v][axis] += moved[v][axis];
    }
  }
  for (std::size_t v = 0; v < blocks.cage.points.size(); ++v) {
    complex.points[blocks.vertex_corner[v]] = blocks.cage.points[v];
  }
  const BlockMesh mesh(std::make_shared<const HexComplex>(complex));
  UntangleSettings untangling;
  untangling.max_cell_evaluations = most_evaluations;
  untangling.freedom = std::move(freedom);
  UntangledPoints untangled = untangle(mesh, untangling, progress);
  complex.points = std::move(untangled.points);
  result.untangle = std::move(untangled.report);
  result.blocks = std::move(blocks);
  return result;
}

}  // namespace flowcage
