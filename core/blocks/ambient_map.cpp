#include "core/blocks/ambient_map.hpp"

#include <Eigen/IterativeLinearSolvers>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/parallel.hpp"
#include "core/project/winding_number.hpp"

namespace flowcage {
namespace {

/// Eight nodes with the trilinear weights (and their gradients) of a point.
struct Place {
  std::array<Index, 8> node{};
  std::array<double, 8> weight{};
  std::array<Vec3, 8> gradient;
};

bool locate(const std::array<std::vector<double>, 3>& lines, const Vec3& x, Place& place) {
  std::array<Index, 3> cell{};
  std::array<double, 3> t{}, width{};
  for (int axis = 0; axis < 3; ++axis) {
    const std::vector<double>& l = lines[axis];
    if (l.empty() || !(x[axis] >= l.front() && x[axis] <= l.back())) return false;
    width[axis] = (l.back() - l.front()) / static_cast<double>(l.size() - 1);
    const double s = (x[axis] - l.front()) / width[axis];
    cell[axis] = std::min(static_cast<Index>(s), static_cast<Index>(l.size()) - 2);
    t[axis] = s - cell[axis];
  }
  const auto nx = static_cast<Index>(lines[0].size()), ny = static_cast<Index>(lines[1].size());
  for (int n = 0; n < 8; ++n) {
    const std::array<int, 3> bit{n & 1, n >> 1 & 1, n >> 2};
    place.node[n] = cell[0] + bit[0] + nx * (cell[1] + bit[1] + ny * (cell[2] + bit[2]));
    std::array<double, 3> f{}, d{};
    for (int axis = 0; axis < 3; ++axis) {
      f[axis] = bit[axis] == 1 ? t[axis] : 1 - t[axis];
      d[axis] = (bit[axis] == 1 ? 1 : -1) / width[axis];
    }
    place.weight[n] = f[0] * f[1] * f[2];
    place.gradient[n] = Vec3(d[0] * f[1] * f[2], f[0] * d[1] * f[2], f[0] * f[1] * d[2]);
  }
  return true;
}

/// A point of the surface with the area round it.
struct AreaPoint {
  Vec3 position;
  double area;
  Index triangle;
};

class System {
 public:
  System(Index nodes, Index extra) : nodes_(nodes), size_(nodes + extra), rhs_(Eigen::VectorXd::Zero(size_)) {
    fixed_.assign(static_cast<std::size_t>(size_), 0);
  }
  void fix(Index node) { fixed_[node] = 1; }
  bool fixed(Index node) const { return fixed_[node] != 0; }
  void add(Index i, Index j, double value) {
    if (fixed_[i] == 0 && fixed_[j] == 0) entries_.emplace_back(i, j, value);
  }
  /// weight (x + v(place) - c)^2
  void add_value(const Place& place, double x, Index unknown, double weight) {
    const Index c = nodes_ + unknown;
    for (int n = 0; n < 8; ++n) {
      for (int m = 0; m < 8; ++m)
        add(place.node[n], place.node[m], weight * place.weight[n] * place.weight[m]);
      add(place.node[n], c, -weight * place.weight[n]);
      add(c, place.node[n], -weight * place.weight[n]);
      rhs_[place.node[n]] -= weight * x * place.weight[n];
    }
    add(c, c, weight);
    rhs_[c] += weight * x;
  }
  Eigen::VectorXd solve(const Eigen::VectorXd& start) {
    for (Index n = 0; n < size_; ++n) {
      if (fixed_[n] == 0) {
        entries_.emplace_back(n, n, 1e-12);
        continue;
      }
      entries_.emplace_back(n, n, 1);
      rhs_[n] = 0;
    }
    Eigen::SparseMatrix<double, Eigen::RowMajor> matrix(size_, size_);
    matrix.setFromTriplets(entries_.begin(), entries_.end());
    entries_.clear();
    entries_.shrink_to_fit();
    Eigen::ConjugateGradient<Eigen::SparseMatrix<double, Eigen::RowMajor>, Eigen::Lower | Eigen::Upper> cg;
    cg.setTolerance(1e-6);
    cg.setMaxIterations(3000);
    cg.compute(matrix);
    return cg.solveWithGuess(rhs_, start);
  }

 private:
  Index nodes_, size_;
  Eigen::VectorXd rhs_;
  std::vector<char> fixed_;
  std::vector<Eigen::Triplet<double>> entries_;
};

/// int |grad v|^2 over a cell, per pair of its nodes.
std::array<std::array<double, 8>, 8> cell_stiffness(const Vec3& width) {
  std::array<std::array<double, 8>, 8> k{};
  for (int n = 0; n < 8; ++n) {
    for (int m = 0; m < 8; ++m) {
      for (int d = 0; d < 3; ++d) {
        double product = 1;
        for (int axis = 0; axis < 3; ++axis) {
          const bool same = (n >> axis & 1) == (m >> axis & 1);
          product *= axis == d ? (same ? 1 : -1) / width[axis] : (same ? 2 : 1) * width[axis] / 6;
        }
        k[n][m] += product;
      }
    }
  }
  return k;
}

}  // namespace

Vec3 AmbientMap::operator()(const Vec3& x) const {
  Place place;
  if (!locate(lines, x, place)) return x;
  Vec3 result = x;
  for (int n = 0; n < 8; ++n) result += place.weight[n] * displacement[place.node[n]];
  return result;
}

Vec3 AmbientMap::inverse(const Vec3& y, const Vec3& start) const {
  Place place;
  if (!locate(lines, y, place)) return y;
  Vec3 x = start;
  double error = ((*this)(x)-y).norm();
  const double small = 1e-10 * (lines[0].back() - lines[0].front());
  for (int step = 0; step < 60 && error > small; ++step) {
    if (!locate(lines, x, place)) break;
    Eigen::Matrix3d jacobian = Eigen::Matrix3d::Identity();
    for (int n = 0; n < 8; ++n) jacobian += displacement[place.node[n]] * place.gradient[n].transpose();
    const Vec3 residual = y - (*this)(x);
    Vec3 move = jacobian.fullPivLu().solve(residual);
    if (!(jacobian.determinant() > 0.02) || !move.allFinite()) move = 0.5 * residual;
    double length = 1;
    for (int halving = 0; halving < 12; ++halving, length /= 2) {
      Vec3 next = x + length * move;
      for (int axis = 0; axis < 3; ++axis) {
        next[axis] = std::clamp(next[axis], lines[axis].front(), lines[axis].back());
      }
      const double next_error = ((*this)(next)-y).norm();
      if (next_error < error || halving == 11) {
        if (next_error >= error) return x;
        x = next;
        error = next_error;
        break;
      }
    }
  }
  return x;
}

double map_spacing(const AmbientFrame& frame, const MapSettings& settings) {
  return frame.near.sizes().maxCoeff() / settings.nodes;
}

AmbientMap solve_ambient_map(const AmbientBody& body, const SurfaceCharts& charts, const AmbientFrame& frame,
                             const std::vector<KnifeLine>& knives, const MapSettings& settings,
                             Progress& progress) {
  AmbientMap map;
  const Vec3 extent = frame.near.sizes();
  const double spacing = map_spacing(frame, settings);
  std::array<Index, 3> nodes{};
  Vec3 width;
  for (int axis = 0; axis < 3; ++axis) {
    constexpr Index fewest = 6;
    const Index cells = std::max(fewest, static_cast<Index>(std::lround(extent[axis] / spacing)));
    nodes[axis] = cells + 1;
    width[axis] = extent[axis] / cells;
    for (Index n = 0; n <= cells; ++n) {
      map.lines[axis].push_back(frame.near.min()[axis] + width[axis] * n);
    }
    map.lines[axis].back() = frame.near.max()[axis];
  }
  const Index count = nodes[0] * nodes[1] * nodes[2];
  const auto node_of = [&](Index i, Index j, Index k) { return i + nodes[0] * (j + nodes[1] * k); };

  // Cells inside of the body.
  const WindingTree tree = build_winding_tree(body.points, body.triangles);
  const std::array<Index, 3> cells{nodes[0] - 1, nodes[1] - 1, nodes[2] - 1};
  std::vector<Vec3> centres;
  for (Index k = 0; k < cells[2]; ++k) {
    for (Index j = 0; j < cells[1]; ++j) {
      for (Index i = 0; i < cells[0]; ++i) {
        centres.push_back(frame.near.min() + width.cwiseProduct(Vec3(i + 0.5, j + 0.5, k + 0.5)));
      }
    }
  }
  std::vector<double> winding(centres.size());
  winding_numbers(tree, centres, 2, winding);

  std::vector<AreaPoint> samples;
  for (std::size_t t = 0; t < body.triangles.size(); ++t) {
    if (body.parent[t] == no_index) continue;
    const Vec3 &a = body.points[body.triangles[t][0]], &b = body.points[body.triangles[t][1]],
               &c = body.points[body.triangles[t][2]];
    samples.push_back({(a + b + c) / 3, (b - a).cross(c - a).norm() / 2, body.parent[t]});
  }
  const std::array<std::array<double, 8>, 8> stiffness = cell_stiffness(width);
  const auto chart_count = static_cast<Index>(charts.charts.size());
  map.displacement.assign(static_cast<std::size_t>(count), Vec3::Zero());
  map.chart_value.assign(charts.charts.size(), 0);
  map.line_value.assign(knives.size(), {});
  for (int axis = 0; axis < 3; ++axis) {
    progress.step("blocks: map", axis / 3.0);
    System system(count, chart_count + static_cast<Index>(knives.size()));
    for (Index k = 0; k < nodes[2]; ++k) {
      for (Index j = 0; j < nodes[1]; ++j) {
        for (Index i = 0; i < nodes[0]; ++i) {
          const std::array<Index, 3> at{i, j, k};
          for (int d = 0; d < 3; ++d) {
            const bool low = at[d] == 0, high = at[d] == nodes[d] - 1;
            if (!low && !high) continue;
            if (frame.sides[2 * d + (high ? 1 : 0)].at_body && d != axis) continue;
            system.fix(node_of(i, j, k));
          }
        }
      }
    }
    Index cell = 0;
    for (Index k = 0; k < cells[2]; ++k) {
      for (Index j = 0; j < cells[1]; ++j) {
        for (Index i = 0; i < cells[0]; ++i, ++cell) {
          const double weight = std::abs(winding[cell]) > 0.5 ? settings.body_weight : 1;
          std::array<Index, 8> corner{};
          for (int n = 0; n < 8; ++n) corner[n] = node_of(i + (n & 1), j + (n >> 1 & 1), k + (n >> 2));
          for (int n = 0; n < 8; ++n) {
            for (int m = 0; m < 8; ++m) system.add(corner[n], corner[m], weight * stiffness[n][m]);
          }
        }
      }
    }
    Eigen::VectorXd start = Eigen::VectorXd::Zero(count + chart_count + static_cast<Index>(knives.size()));
    Place place;
    for (const AreaPoint& s : samples) {
      if (!locate(map.lines, s.position, place)) continue;
      const Index c = charts.chart[s.triangle];
      const SurfaceCharts::Chart& chart = charts.charts[c];
      if (chart.axis == axis) {
        constexpr double thinnest = 200;
        const double thin = std::min(thinnest, chart.diameter * chart.diameter / chart.area);
        system.add_value(place, s.position[axis], c,
                         settings.chart_weight / spacing * s.area * std::max(1.0, thin / 4));
      } else {
        const double weight = settings.surface_weight * spacing * s.area;
        for (int n = 0; n < 8; ++n) {
          for (int m = 0; m < 8; ++m) {
            system.add(place.node[n], place.node[m], weight * place.gradient[n].dot(place.gradient[m]));
          }
        }
      }
    }
    for (Index c = 0; c < chart_count; ++c) start[count + c] = charts.charts[c].place[axis];
    for (Index l = 0; l < static_cast<Index>(knives.size()); ++l) {
      map.line_value[l][axis] = std::numeric_limits<double>::quiet_NaN();
      if ((knives[l].axes >> axis & 1) == 0) continue;
      Vec3 mean = Vec3::Zero();
      for (const Vec3& p : knives[l].points) {
        mean += p / static_cast<double>(knives[l].points.size());
        if (!locate(map.lines, p, place)) continue;
        system.add_value(
            place, p[axis], chart_count + l,
            settings.chart_weight * knives[l].length / static_cast<double>(knives[l].points.size()));
      }
      start[count + chart_count + l] = mean[axis];
    }
    const Eigen::VectorXd solution = system.solve(start);
    for (Index n = 0; n < count; ++n) map.displacement[n][axis] = solution[n];
    for (Index c = 0; c < chart_count; ++c) {
      if (charts.charts[c].axis == axis) map.chart_value[c] = solution[count + c];
    }
    for (Index l = 0; l < static_cast<Index>(knives.size()); ++l) {
      if ((knives[l].axes >> axis & 1) != 0) map.line_value[l][axis] = solution[count + chart_count + l];
    }
  }
  return map;
}

}  // namespace flowcage
