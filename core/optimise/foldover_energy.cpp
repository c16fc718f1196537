#include "core/optimise/foldover_energy.hpp"

#include "core/base/parallel.hpp"

namespace flowcage {
namespace {

// Notation: E the derivative of position by the unit cube's coordinates (columns: edge vectors at a corner),
// w = 1 / target length of each column, J = E diag(w), D = det J, C = its cofactors (dD/dJ).

constexpr Offset cell_grain = 1024;
constexpr Offset point_grain = 2048;
constexpr double infinity = std::numeric_limits<double>::infinity();

/// A further sample of thorough cells: derivatives of the eight trilinear shape functions at a node of the
/// 3x3x3 grid, and which edges (of each axis) its target length averages.
struct Sample {
  std::array<Vec3, 8> shape;
  std::array<std::array<double, 4>, 3> edge_share;
};

std::vector<Sample> make_further_samples() {
  std::vector<Sample> out;
  for (int n = 0; n < 27; ++n) {
    const std::array<int, 3> node{n % 3, n / 3 % 3, n / 9};
    if (node[0] != 1 && node[1] != 1 && node[2] != 1) continue;  // a corner
    const auto weight = [&](int axis, int end) { return end == 1 ? 0.5 * node[axis] : 1 - 0.5 * node[axis]; };
    Sample sample;
    for (int c = 0; c < 8; ++c) {
      for (int a = 0; a < 3; ++a) {
        double value = hex_corner_ijk[c][a] == 1 ? 1.0 : -1.0;
        for (int b = 0; b < 3; ++b) {
          if (b != a) value *= weight(b, hex_corner_ijk[c][b]);
        }
        sample.shape[c][a] = value;
      }
    }
    for (int e = 0; e < 12; ++e) {
      double share = 1;
      for (int b = 0; b < 3; ++b) {
        if (b != e / 4) share *= weight(b, hex_corner_ijk[hex_edges[e][0]][b]);
      }
      sample.edge_share[e / 4][e % 4] = share;
    }
    out.push_back(sample);
  }
  return out;
}

const std::vector<Sample>& further_samples() {
  static const std::vector<Sample> samples = make_further_samples();
  return samples;
}

struct Chi {
  double value, slope;
};

Chi chi(double epsilon, double determinant) {
  const double root = std::sqrt(epsilon * epsilon + determinant * determinant);
  if (root == 0) return {0, 0};
  // The sum cancels for negative determinants: use eps^2 / (root - det).
  const double value =
      determinant > 0 ? 0.5 * (determinant + root) : 0.5 * epsilon * epsilon / (root - determinant);
  return {value, value / root};
}

/// (phi / m)^(p - 1)
double power_factor(double phi, const EnergyParameters& parameters) {
  const double ratio = phi / (3 + 2 * parameters.lambda);
  double out = 1;
  for (int n = 1; n < parameters.exponent; ++n) out *= ratio;
  return out;
}

/// Energy of one sample; `derivative`: by J.
double sample_energy(const Eigen::Matrix3d& j, const EnergyParameters& parameters, double& determinant,
                     Eigen::Matrix3d* derivative) {
  const double lambda = parameters.lambda;
  const double epsilon = parameters.epsilon;
  Eigen::Matrix3d cofactors;
  cofactors.col(0) = j.col(1).cross(j.col(2));
  cofactors.col(1) = j.col(2).cross(j.col(0));
  cofactors.col(2) = j.col(0).cross(j.col(1));
  determinant = j.col(0).dot(cofactors.col(0));
  if (epsilon == 0 && !(determinant > 0)) return infinity;
  const Chi x = chi(epsilon, determinant);
  if (!(x.value > 0)) return infinity;
  const double root = std::cbrt(x.value);
  const double power = 1 / (root * root);  // chi^(-2/3)
  const double shape = j.squaredNorm() * power;
  const double volume = (determinant * determinant + 1) / x.value;
  const double phi = shape + lambda * volume;
  const double factor = power_factor(phi, parameters);
  if (derivative != nullptr) {
    const double by_determinant =
        -(2.0 / 3.0) * shape * x.slope / x.value + lambda * (2 * determinant - volume * x.slope) / x.value;
    *derivative = (parameters.exponent * factor) * (2 * power * j + by_determinant * cofactors);
  }
  return phi * factor;
}

HexCornerPoints gather(std::span<const Vec3> positions, const HexPoints& cell) {
  HexCornerPoints p;
  for (int c = 0; c < 8; ++c) p[c] = positions[cell[c]];
  return p;
}

Eigen::Matrix3d corner_map(const HexCornerPoints& p, const std::array<float, 12>& inverse_lengths, int c) {
  Eigen::Matrix3d j;
  for (int a = 0; a < 3; ++a) {
    const double w = inverse_lengths[hex_corner_edge(c, a)];
    j.col(a) = (hex_corner_ijk[c][a] == 0 ? w : -w) * (p[hex_corner_neighbour(c, a)] - p[c]);
  }
  return j;
}

struct CellEnergy {
  double energy = 0, min_determinant = infinity;
};

/// Adds a cell's samples; `gradient`: by its eight corners, or null.
CellEnergy cell_energy(const HexCornerPoints& p, const std::array<float, 12>& inverse_lengths, bool thorough,
                       const EnergyParameters& parameters, HexCornerPoints* gradient) {
  CellEnergy out;
  Eigen::Matrix3d derivative;
  const auto add = [&](const Eigen::Matrix3d& j) {
    double determinant = 0;
    out.energy +=
        0.125 * sample_energy(j, parameters, determinant, gradient != nullptr ? &derivative : nullptr);
    out.min_determinant = std::min(out.min_determinant, determinant);
    derivative *= 0.125;
    return out.energy < infinity;
  };
  for (int c = 0; c < 8; ++c) {
    if (!add(corner_map(p, inverse_lengths, c))) return out;
    if (gradient == nullptr) continue;
    for (int a = 0; a < 3; ++a) {
      const double w = inverse_lengths[hex_corner_edge(c, a)];
      const Vec3 g = (hex_corner_ijk[c][a] == 0 ? w : -w) * derivative.col(a);
      (*gradient)[hex_corner_neighbour(c, a)] += g;
      (*gradient)[c] -= g;
    }
  }
  if (!thorough) return out;
  for (const Sample& sample : further_samples()) {
    Eigen::Matrix3d j = Eigen::Matrix3d::Zero();
    for (int c = 0; c < 8; ++c) j += p[c] * sample.shape[c].transpose();
    Vec3 w;
    for (int a = 0; a < 3; ++a) {
      double length = 0;
      for (int n = 0; n < 4; ++n) {
        length += sample.edge_share[a][n] / static_cast<double>(inverse_lengths[4 * a + n]);
      }
      w[a] = 1 / length;
    }
    if (!add(j * w.asDiagonal())) return out;
    if (gradient == nullptr) continue;
    for (int c = 0; c < 8; ++c) (*gradient)[c] += derivative * w.cwiseProduct(sample.shape[c]);
  }
  return out;
}

EnergyParameters parameters_of(const FoldoverProblem& problem, Offset cell, EnergyParameters parameters) {
  if (problem.kinds[cell].hopeless) {
    parameters.epsilon = parameters.hopeless_epsilon;
    parameters.exponent = 1;
  }
  return parameters;
}

}  // namespace

Csr<Offset> corners_of_points(std::span<const HexPoints> cells, std::span<const Index> moving,
                              Index point_count) {
  std::vector<Index> row(static_cast<std::size_t>(point_count), no_index);
  for (std::size_t m = 0; m < moving.size(); ++m) row[moving[m]] = static_cast<Index>(m);
  Csr<Offset> out;
  out.offsets.assign(moving.size() + 1, 0);
  for (const HexPoints& cell : cells) {
    for (const Index p : cell) {
      if (row[p] != no_index) ++out.offsets[row[p] + 1];
    }
  }
  for (std::size_t m = 0; m < moving.size(); ++m) out.offsets[m + 1] += out.offsets[m];
  out.values.resize(static_cast<std::size_t>(out.offsets.back()));
  std::vector<Offset> next(out.offsets.begin(), out.offsets.end() - 1);
  for (std::size_t n = 0; n < cells.size(); ++n) {
    for (int c = 0; c < 8; ++c) {
      const Index m = row[cells[n][c]];
      if (m != no_index) out.values[next[m]++] = static_cast<Offset>(8 * n) + c;
    }
  }
  return out;
}

EnergyValue evaluate_energy(const FoldoverProblem& problem, std::span<const Vec3> positions,
                            const EnergyParameters& parameters, std::span<Vec3> gradient) {
  const auto count = static_cast<Offset>(problem.cells.size());
  std::vector<HexCornerPoints> cell_gradients(gradient.empty() ? 0 : problem.cells.size());
  const auto body = [&](Offset begin, Offset end) {
    EnergyValue part{0, infinity};
    for (Offset n = begin; n < end; ++n) {
      HexCornerPoints* by_corner = nullptr;
      if (!gradient.empty()) {
        by_corner = &cell_gradients[n];
        by_corner->fill(Vec3::Zero());
      }
      const CellEnergy cell =
          cell_energy(gather(positions, problem.cells[n]), problem.inverse_lengths[n],
                      problem.kinds[n].thorough, parameters_of(problem, n, parameters), by_corner);
      part.energy += cell.energy;
      if (!problem.kinds[n].hopeless)
        part.min_determinant = std::min(part.min_determinant, cell.min_determinant);
    }
    return part;
  };
  EnergyValue out = parallel_reduce(
      count, cell_grain, EnergyValue{0, infinity}, body, [](const EnergyValue& a, const EnergyValue& b) {
        return EnergyValue{a.energy + b.energy, std::min(a.min_determinant, b.min_determinant)};
      });
  const double scale = 1 / static_cast<double>(std::max<Offset>(1, count));
  out.energy *= scale;
  if (gradient.empty()) return out;
  parallel_for(static_cast<Offset>(problem.moving.size()), point_grain, [&](Offset begin, Offset end) {
    for (Offset m = begin; m < end; ++m) {
      Vec3 sum = Vec3::Zero();
      for (const Offset at : problem.moving_corners[static_cast<Index>(m)])
        sum += cell_gradients[at / 8][at % 8];
      gradient[m] = scale * sum;
    }
  });
  return out;
}

std::vector<Eigen::Matrix3d> energy_blocks(const FoldoverProblem& problem, std::span<const Vec3> positions,
                                           const EnergyParameters& parameters) {
  std::vector<Eigen::Matrix3d> blocks(problem.moving.size());
  const double scale = 0.125 / static_cast<double>(std::max<std::size_t>(1, problem.cells.size()));
  // A point alone moves a sample's J by delta n^T (n: gradient of its shape function in target coordinates)
  // and D linearly, by delta . C n; so the block is 2 chi^(-2/3) |n|^2 I + k (C n)(C n)^T and mixed terms,
  // dropped.
  const auto add_corner = [&](Offset cell, int corner, int sample, Eigen::Matrix3d& block) {
    const HexCornerPoints p = gather(positions, problem.cells[cell]);
    const std::array<float, 12>& lengths = problem.inverse_lengths[cell];
    Vec3 n = Vec3::Zero();
    for (int a = 0; a < 3; ++a) {
      const double w = lengths[hex_corner_edge(sample, a)];
      const double signed_w = hex_corner_ijk[sample][a] == 0 ? w : -w;
      if (corner == sample) n[a] = -signed_w;
      if (corner == hex_corner_neighbour(sample, a)) n[a] = signed_w;
    }
    if (n.isZero(0)) return;
    const Eigen::Matrix3d j = corner_map(p, lengths, sample);
    Eigen::Matrix3d cofactors;
    cofactors << j.col(1).cross(j.col(2)), j.col(2).cross(j.col(0)), j.col(0).cross(j.col(1));
    const double d = j.determinant();
    const EnergyParameters own = parameters_of(problem, cell, parameters);
    const Chi x = chi(own.epsilon, d);
    if (!(x.value > 0)) return;
    const double power = 1 / std::cbrt(x.value * x.value);
    const double steepness = x.slope * x.slope / (x.value * x.value);
    const double k = (10.0 / 9.0) * j.squaredNorm() * power * steepness +
                     2 * own.lambda * ((d * d + 1) * steepness + 1) / x.value;
    const Vec3 cn = cofactors * n;
    const double phi = j.squaredNorm() * power + own.lambda * (d * d + 1) / x.value;
    const double weight = scale * own.exponent * power_factor(phi, own);
    block += weight * (2 * power * n.squaredNorm() * Eigen::Matrix3d::Identity() + k * cn * cn.transpose());
  };
  parallel_for(static_cast<Offset>(problem.moving.size()), point_grain, [&](Offset begin, Offset end) {
    for (Offset m = begin; m < end; ++m) {
      blocks[m].setZero();
      for (const Offset at : problem.moving_corners[static_cast<Index>(m)]) {
        for (int sample = 0; sample < 8; ++sample) {
          add_corner(at / 8, static_cast<int>(at % 8), sample, blocks[m]);
        }
      }
    }
  });
  return blocks;
}

}  // namespace flowcage
