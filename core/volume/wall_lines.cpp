#include "core/volume/wall_lines.hpp"

#include <cmath>

#include "core/base/parallel.hpp"
#include "core/volume/shell_columns.hpp"

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
std::vector<double> wall_cell_sizes(const BlockMesh& mesh, const ShellColumns& columns) {
  const std::size_t n = columns.lines.size();
  const auto foot = [&](Index l) -> const Vec3& {
    const ShellLine& line = columns.lines[l];
    return mesh.points()[mesh.point_number(line.block, line.i, line.j, 0)];
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
  constexpr int smoothing_steps = 10;
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

/// A C1 cubic through points, by chord length (Hermite, slopes from the parabola through three neighbours).
class LineCurve {
 public:
  explicit LineCurve(std::vector<Vec3> points) : points_(std::move(points)), s_(points_.size(), 0) {
    const std::size_t n = points_.size();
    for (std::size_t k = 1; k < n; ++k) s_[k] = s_[k - 1] + (points_[k] - points_[k - 1]).norm();
    slopes_.resize(n);
    for (std::size_t k = 0; k < n; ++k) {
      if (k == 0 || k + 1 == n) continue;
      const double h0 = s_[k] - s_[k - 1];
      const double h1 = s_[k + 1] - s_[k];
      slopes_[k] = (secant(k - 1) * h1 + secant(k) * h0) / std::max(h0 + h1, 1e-300);
    }
    slopes_.front() = n > 2 ? Vec3(2 * secant(0) - slopes_[1]) : secant(0);
    slopes_.back() = n > 2 ? Vec3(2 * secant(n - 2) - slopes_[n - 2]) : secant(0);
  }
  double length() const { return s_.back(); }
  Vec3 at(double s) const {
    const auto above = std::upper_bound(s_.begin() + 1, s_.end() - 1, s);
    const auto k = static_cast<std::size_t>(above - s_.begin()) - 1;
    const double h = s_[k + 1] - s_[k];
    if (!(h > 0)) return points_[k];
    const double t = (s - s_[k]) / h;
    const double u = 1 - t;
    // From the nearer end, so that a shared coordinate stays exact.
    return points_[k] + (points_[k + 1] - points_[k]) * (t * t * (3 - 2 * t)) + slopes_[k] * (h * t * u * u) -
           slopes_[k + 1] * (h * t * t * u);
  }

 private:
  Vec3 secant(std::size_t k) const {
    const double h = s_[k + 1] - s_[k];
    return h > 0 ? Vec3((points_[k + 1] - points_[k]) / h) : Vec3::Zero();
  }
  std::vector<Vec3> points_;
  std::vector<double> s_;
  std::vector<Vec3> slopes_;
};

}  // namespace

void place_boundary(BlockMesh& mesh, const Shell& shell, const SurfaceLevel& level,
                    const BoundaryPlaces& places) {
  const Index layers = mesh.chord_divisions()[shell.k_chord];
  const std::vector<ShellLine> lines = shell_lines(shell, level);
  std::vector<Vec3>& points = mesh.mutable_points();
  const auto displacement = [&](std::span<const Vec3> target, Index layer) {
    std::vector<Vec3> d(level.vertex_count(), Vec3::Zero());
    if (target.empty()) return d;
    const std::vector<Index> at = layer_points(mesh, lines, layer);
    for (std::size_t v = 0; v < d.size(); ++v) d[v] = target[v] - points[at[v]];
    return d;
  };
  const std::vector<Vec3> at_wall = displacement(places.wall, 0);
  const std::vector<Vec3> at_outer = displacement(places.outer, layers);
  for (Index k = 0; k <= layers; ++k) {
    const double t = static_cast<double>(k) / layers;
    const std::vector<Index> at = layer_points(mesh, lines, k);
    for (std::size_t v = 0; v < at.size(); ++v) points[at[v]] += (1 - t) * at_wall[v] + t * at_outer[v];
    if (k == 0 && !places.wall.empty()) {
      for (std::size_t v = 0; v < at.size(); ++v) points[at[v]] = places.wall[v];
    }
    if (k == layers && !places.outer.empty()) {
      for (std::size_t v = 0; v < at.size(); ++v) points[at[v]] = places.outer[v];
    }
  }
  flatten_symmetry(mesh, shell);
}

Index layers_for_growth(const Shell& shell, int refinements, const LineSpacing& spacing, double growth) {
  const auto median = [](std::vector<double> values) {
    const auto middle = values.begin() + static_cast<long>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
  };
  std::vector<double> lengths;
  for (std::size_t v = 0; v < shell.inner_points.size(); ++v) {
    lengths.push_back((shell.outer_points[v] - shell.inner_points[v]).norm());
  }
  std::vector<double> edges;
  for (const auto& [a, b] : shell.inner.edge_vertices) {
    edges.push_back((shell.inner_points[a] - shell.inner_points[b]).norm());
  }
  const Index cells = Index{1} << refinements;
  const double first = spacing.first_height > 0 ? spacing.first_height : median(std::move(edges)) / cells;
  const double length = median(std::move(lengths));
  constexpr Index max_layers = 16;
  for (Index layers = 1; layers < max_layers; ++layers) {
    if (first * (2 + powers(growth, layers * cells - 2)) >= length) return layers;
  }
  return max_layers;
}

std::vector<double> geometric_cells(double length, Index count, const LineSpacing& spacing) {
  std::vector<double> cells(count, length / count);
  double first = spacing.first_height;
  if (count < 3 || !(first > 0) || first * count >= length) return cells;
  const Index layers = std::clamp<Index>(spacing.layers, 0, count - 1);
  Index done = std::max<Index>(2, layers);
  double filled = 2 * first;
  cells[0] = cells[1] = first;
  for (Index k = 2; k < done; ++k) {
    cells[k] = cells[k - 1] * spacing.growth;
    filled += cells[k];
    if (filled + cells[k] * (count - 1 - k) > length) {  // no room: the rest is even
      done = k;
      filled -= cells[k];
      break;
    }
  }
  const double rest = length - filled;
  double ratio = solve_ratio(cells[done - 1], count - done, rest);
  if (ratio <= 1) {
    for (Index k = done; k < count; ++k) cells[k] = rest / (count - done);
    return cells;
  }
  if (layers == 0 && ratio > spacing.max_growth && spacing.max_growth > 1) {
    ratio = spacing.max_growth;
    first = length / (2 + powers(ratio, count - 2));
    cells[0] = cells[1] = first;
    done = 2;
  }
  for (Index k = done; k < count; ++k) cells[k] = cells[k - 1] * ratio;
  // Rounding of the ratio goes into the last cell.
  double sum = 0;
  for (Index k = 0; k + 1 < count; ++k) sum += cells[k];
  cells[count - 1] = length - sum;
  return cells;
}

SpacingReport respace_lines(BlockMesh& mesh, const Shell& shell, const LineSpacing& spacing) {
  const ShellColumns columns = shell_columns(mesh, shell);
  const Index layers = columns.layers;
  const std::vector<double> sizes =
      spacing.first_height > 0 ? std::vector<double>{} : wall_cell_sizes(mesh, columns);
  std::vector<Vec3>& points = mesh.mutable_points();
  const SpacingReport none{std::numeric_limits<double>::infinity(), 0, 1};
  const SpacingReport report = parallel_reduce(
      static_cast<Offset>(columns.lines.size()), 64, none,
      [&](Offset begin, Offset end) {
        SpacingReport part = none;
        for (Offset n = begin; n < end; ++n) {
          const auto& [block, i, j] = columns.lines[n];
          std::vector<Index> at(layers + 1);
          std::vector<Vec3> line(layers + 1);
          for (Index k = 0; k <= layers; ++k) {
            at[k] = mesh.point_number(block, i, j, k);
            line[k] = points[at[k]];
          }
          const LineCurve curve(line);
          LineSpacing local = spacing;
          if (spacing.first_height > 0) {
            local.max_growth = 0;  // the asked height counts
          } else {
            local.first_height = sizes[n];
            local.layers = 0;
          }
          const std::vector<double> cells = geometric_cells(curve.length(), layers, local);
          double s = 0;
          for (Index k = 1; k < layers; ++k) {
            s += cells[k - 1];
            points[at[k]] = curve.at(s);
          }
          part.min_first = std::min(part.min_first, cells[0]);
          part.max_first = std::max(part.max_first, cells[0]);
          for (Index k = 1; k < layers; ++k)
            part.max_growth = std::max(part.max_growth, cells[k] / cells[k - 1]);
        }
        return part;
      },
      [](SpacingReport a, const SpacingReport& b) {
        return SpacingReport{std::min(a.min_first, b.min_first), std::max(a.max_first, b.max_first),
                             std::max(a.max_growth, b.max_growth)};
      });
  flatten_symmetry(mesh, shell);
  return report;
}

}  // namespace flowcage
