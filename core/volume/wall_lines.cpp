#include "core/volume/wall_lines.hpp"

#include <cmath>

#include "core/base/parallel.hpp"
#include "core/volume/line_curve.hpp"
#include "core/volume/wall_columns.hpp"

namespace flowcage {
namespace {

/// Sum of ratio + ratio^2 + ... + ratio^n.
double powers(double ratio, Index n) {
  double sum = 0;
  double term = 1;
  for (Index i = 0; i < n; ++i) sum += term *= ratio;
  return sum;
}

/// The ratio r >= 1 at which last * (r + ... + r^n) = length; 1 when the cells are long enough without
/// growth.
double solve_ratio(double last, Index n, double length) {
  if (n <= 0 || last * n >= length) return 1;
  double low = 1;
  double high = 2;
  while (last * powers(high, n) < length) high *= 2;
  for (int step = 0; step < 200 && high - low > 1e-14 * high; ++step) {
    const double middle = (low + high) / 2;
    (last * powers(middle, n) < length ? low : high) = middle;
  }
  return (low + high) / 2;
}

/// Length of the wall's edges round the foot of each line (their geometric mean), smoothed over the wall so
/// that neighbouring lines get similar first cells.
std::vector<double> wall_cell_sizes(const BlockMesh& mesh, const WallBlocks& blocks,
                                    const WallColumns& columns) {
  const std::size_t n = columns.lines.size();
  const auto foot = [&](Index l) -> const Vec3& {
    return mesh.points()[line_point(mesh, blocks, columns.lines[l], 0)];
  };
  std::vector<double> sum(n, 0);
  std::vector<double> count(n, 0);
  for (const auto& [a, b] : columns.edges) {
    const double size = std::log(std::max((foot(a) - foot(b)).norm(), 1e-300));
    for (const Index l : {a, b}) {
      sum[l] += size;
      ++count[l];
    }
  }
  std::vector<double> value(n);
  for (std::size_t l = 0; l < n; ++l) value[l] = sum[l] / count[l];
  constexpr int smoothing_steps = 40;
  for (int step = 0; step < smoothing_steps; ++step) {
    std::fill(sum.begin(), sum.end(), 0.0);
    for (const auto& [a, b] : columns.edges) {
      sum[a] += value[b];
      sum[b] += value[a];
    }
    for (std::size_t l = 0; l < n; ++l) value[l] = (value[l] + sum[l] / count[l]) / 2;
  }
  for (double& v : value) v = std::exp(v);
  return value;
}

}  // namespace

void place_boundary(BlockMesh& mesh, const WallBlocks& blocks, const SurfaceLevel& level,
                    const BoundaryPlaces& places) {
  const Index layers = line_layers(mesh, blocks);
  const std::vector<WallLine> lines = wall_lines(blocks, level);
  std::vector<Vec3>& points = mesh.mutable_points();
  struct Ends {
    Index wall, outer;
  };
  std::vector<Ends> ends(lines.size());
  const auto displacement = [&](std::span<const Vec3> target, std::size_t v, Index at) {
    return target.empty() ? Vec3(Vec3::Zero()) : Vec3(target[v] - points[at]);
  };
  parallel_for(static_cast<Offset>(lines.size()), 256, [&](Offset begin, Offset end) {
    for (Offset v = begin; v < end; ++v) {
      const PointRow row = line_points(mesh, blocks, lines[v]);
      ends[v] = {row[0], row[layers]};
      const Vec3 at_wall = displacement(places.wall, v, row[0]);
      const Vec3 at_outer = displacement(places.outer, v, row[layers]);
      for (Index k = 1; k < layers; ++k) {
        const double t = static_cast<double>(k) / layers;
        points[row[k]] += (1 - t) * at_wall + t * at_outer;
      }
    }
  });
  // Lines may share an end.
  for (std::size_t v = 0; v < ends.size(); ++v) {
    if (!places.wall.empty()) points[ends[v].wall] = places.wall[v];
    if (!places.outer.empty()) points[ends[v].outer] = places.outer[v];
  }
  flatten_symmetry(mesh, blocks);
}

TypicalLine typical_line(const Shell& shell, int refinements) {
  const auto median = [](std::vector<double> values) {
    const auto middle = values.begin() + static_cast<long>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
  };
  std::vector<double> lengths;
  for (std::size_t v = 0; v < shell.wall_points.size(); ++v) {
    lengths.push_back((shell.outer_points[v] - shell.wall_points[v]).norm());
  }
  std::vector<double> edges;
  for (const auto& [a, b] : shell.wall.edge_vertices) {
    edges.push_back((shell.wall_points[a] - shell.wall_points[b]).norm());
  }
  return {median(std::move(lengths)), std::ldexp(median(std::move(edges)), -refinements)};
}

Index layers_for_growth(const Shell& shell, int refinements, double growth) {
  const TypicalLine line = typical_line(shell, refinements);
  const Index cells = Index{1} << refinements;
  constexpr Index max_layers = 16;
  for (Index layers = 1; layers < max_layers; ++layers) {
    if (line.wall_cell * (2 + powers(growth, layers * cells - 2)) >= line.length) return layers;
  }
  return max_layers;
}

std::vector<double> geometric_cells(double length, Index count, double first, double max_growth) {
  std::vector<double> cells(count, length / count);
  if (count < 3 || !(first > 0) || first * count >= length) return cells;
  double ratio = solve_ratio(first, count - 2, length - 2 * first);
  if (ratio > max_growth) {
    ratio = max_growth;
    first = length / (2 + powers(ratio, count - 2));
  }
  cells[0] = cells[1] = first;
  for (Index k = 2; k < count; ++k) cells[k] = cells[k - 1] * ratio;
  // Rounding of the ratio goes into the last cell.
  double sum = 0;
  for (Index k = 0; k + 1 < count; ++k) sum += cells[k];
  cells[count - 1] = length - sum;
  return cells;
}

void spread_lines(BlockMesh& mesh, const WallBlocks& blocks, double max_growth) {
  const WallColumns columns = wall_columns(mesh, blocks);
  const Index layers = columns.layers;
  const std::vector<double> sizes = wall_cell_sizes(mesh, blocks, columns);
  std::vector<Vec3>& points = mesh.mutable_points();
  parallel_for(static_cast<Offset>(columns.lines.size()), 64, [&](Offset begin, Offset end) {
    for (Offset n = begin; n < end; ++n) {
      const PointRow row = line_points(mesh, blocks, columns.lines[n]);
      const LineCurve curve(line_positions(mesh, blocks, columns.lines[n], layers));
      const std::vector<double> cells = geometric_cells(curve.length(), layers, sizes[n], max_growth);
      double s = 0;
      for (Index k = 1; k < layers; ++k) {
        s += cells[k - 1];
        points[row[k]] = curve.at(s);
      }
    }
  });
  flatten_symmetry(mesh, blocks);
}

}  // namespace flowcage
