#include "core/limit/limit_masks.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <numbers>

namespace flowcage {
namespace {

using std::numbers::pi;

// cos(2 pi i / n), exact at quarter turns, so that regular masks stay sparse.
double cos_turn(int i, int n) {
  i %= n;
  if (4 * i == n || 4 * i == 3 * n) return 0;
  return std::cos(2 * pi * i / n);
}
double sin_turn(int i, int n) {
  i %= n;
  if (i == 0 || 2 * i == n) return 0;
  return std::sin(2 * pi * i / n);
}

// The larger eigenvalue of the ring's Fourier mode e^(i theta): 16 lambda = 5 + c + cos(theta/2) sqrt(18+2c).
double mode_eigenvalue(double theta) {
  const double c = std::cos(theta);
  return (5 + c + std::cos(theta / 2) * std::sqrt(18 + 2 * c)) / 16;
}

// E weights from `wave` at edges 0 .. n, F weights by the left eigenvector's face equation
// lambda f_k = (e_k + e_(k+1)) / 16 + f_k / 4.
template <typename Wave>
void set_wave(int first_edge, int n, double lambda, const Wave& wave, RingWeights& weights) {
  const int ring_edges = static_cast<int>(weights.edges.size());
  for (int i = 0; i < n; ++i) {
    const int place = (first_edge + i) % ring_edges;
    weights.edges[place] = (16 * lambda - 4) * wave(i);
    weights.faces[place] = wave(i) + wave(i + 1);
  }
}

void smooth_tangents(int n, int first_edge, RingWeights& u, RingWeights& v) {
  if (n == 2) {  // the antisymmetric mode lives on the faces: eigenvalue 1/4 for both
    u.edges[first_edge] = 1;
    u.edges[1 - first_edge] = -1;
    v.faces[first_edge] = 1;
    v.faces[1 - first_edge] = -1;
    return;
  }
  const double lambda = n == 4 ? 0.5 : mode_eigenvalue(2 * pi / n);
  set_wave(
      first_edge, n, lambda, [n](int i) { return cos_turn(i, n); }, u);
  set_wave(
      first_edge, n, lambda, [n](int i) { return sin_turn(i, n); }, v);
}

// Position at a dart, the sharp edge being E[0]. With r + 1/r = 7, the left eigenvector's equations
//   7 e_i - e_(i-1) - e_(i+1) = 20 p / n^2  (0 < i < n, e_0 and e_n read as 0),
//   e_0 = 10 p / (3 n^2) + (e_1 + e_(n-1)) / 6,   f_k = p / (3 n^2) + (e_k + e_(k+1)) / 12 (same reading)
// have the solution below.
void dart_position(int n, int sharp, RingWeights& position) {
  const double r = (7 - std::sqrt(45.0)) / 2;
  const double nn = static_cast<double>(n) * n;
  const auto smooth_edge = [&](int i) {
    if (i == 0 || i == n) return 0.0;
    return 4 / nn * (1 - (std::pow(r, i) + std::pow(r, n - i)) / (1 + std::pow(r, n)));
  };
  position.vertex = 1;
  double sum = 1;
  for (int i = 0; i < n; ++i) {
    const int place = (sharp + i) % n;
    position.edges[place] =
        i > 0 ? smooth_edge(i) : 10 / (3 * nn) + (smooth_edge(1) + smooth_edge(n - 1)) / 6;
    position.faces[place] = 1 / (3 * nn) + (smooth_edge(i) + smooth_edge(i + 1)) / 12;
    sum += position.edges[place] + position.faces[place];
  }
  position.vertex /= sum;
  for (double& weight : position.edges) weight /= sum;
  for (double& weight : position.faces) weight /= sum;
}

// The subdivision matrix of a dart's ring on points symmetric about the sharp edge E[0]:
// unknowns P, E[0] .. E[n/2], F[0] .. F[(n-1)/2].
Eigen::MatrixXd symmetric_dart_matrix(int n) {
  const int edge_count = n / 2 + 1, size = 1 + edge_count + (n + 1) / 2;
  const auto edge = [&](int i) { return 1 + std::min(i % n, n - i % n); };
  const auto face = [&](int k) { return 1 + edge_count + std::min(k, n - 1 - k); };
  Eigen::MatrixXd centroid = Eigen::MatrixXd::Zero(n, size);
  for (int k = 0; k < n; ++k) {
    for (const int j : {0, edge(k), edge(k + 1), face(k)}) centroid(k, j) += 0.25;
  }
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(size, size);
  const double nn = static_cast<double>(n) * n;
  matrix(0, 0) = (n - 2.0) / n;
  for (int i = 0; i < n; ++i) {
    matrix(0, edge(i)) += 1 / nn;
    matrix.row(0) += centroid.row(i) / nn;
  }
  matrix(1, 0) = matrix(1, 1) = 0.5;
  for (int i = 1; i < edge_count; ++i) {
    matrix.row(edge(i)) = 0.25 * (centroid.row(i - 1) + centroid.row(i));
    matrix(edge(i), 0) += 0.25;
    matrix(edge(i), edge(i)) += 0.25;
  }
  for (int k = 0; k < (n + 1) / 2; ++k) matrix.row(face(k)) = centroid.row(k);
  return matrix;
}

void dart_tangents(int n, int sharp, RingWeights& u, RingWeights& v) {
  smooth_tangents(n, sharp, u, v);  // v is right: antisymmetric points do not feel the crease

  const Eigen::EigenSolver<Eigen::MatrixXd> solver(symmetric_dart_matrix(n).transpose());
  // Largest eigenvalue below 1; the eigenvalue 1 is simple.
  int dominant = 0, second = -1;
  const auto& values = solver.eigenvalues();
  for (int k = 1; k < values.size(); ++k) {
    if (values[k].real() > values[dominant].real()) dominant = k;
  }
  for (int k = 0; k < values.size(); ++k) {
    if (k != dominant && (second < 0 || values[k].real() > values[second].real())) second = k;
  }
  Eigen::VectorXd left = solver.eigenvectors().col(second).real();
  left *= (left[1] < 0 ? -1 : 1) / left.cwiseAbs().maxCoeff();
  const int edge_count = n / 2 + 1;
  // A folded unknown that stands for two ring points shares its weight between them.
  u.vertex = left[0];
  for (int i = 0; i < n; ++i) {
    const int mirror = std::min(i, n - i), face_mirror = std::min(i, n - 1 - i);
    const bool own_mirror = i == 0 || 2 * i == n, own_face_mirror = i == n - 1 - i;
    u.edges[(sharp + i) % n] = left[1 + mirror] * (own_mirror ? 1 : 0.5);
    u.faces[(sharp + i) % n] = left[1 + edge_count + face_mirror] * (own_face_mirror ? 1 : 0.5);
  }
}

void crease_tangents(const SmoothSector& sector, RingWeights& u, RingWeights& v) {
  const int ring_edges = static_cast<int>(u.edges.size());
  const int k = sector.face_count;
  const int first = sector.first_edge, last = (first + k) % ring_edges;
  u.edges[first] = 1;
  u.edges[last] = -1;
  if (k == 1) {
    v.vertex = -2;
    v.edges[first] = v.edges[last] = 1;
    return;
  }
  // Inside the sector the left eigenvector is sin(i pi / k); P and the two crease ends follow from their
  // columns: (lambda - 1/2) e - p / 8 = a,  -2 e / 2 + (lambda - 3/4) p = b.
  const double theta = pi / k;
  const double lambda = k == 2 ? 0.5 : mode_eigenvalue(theta);
  set_wave(
      first, k, lambda, [&](int i) { return i % k == 0 ? 0 : std::sin(i * theta); }, v);
  double edge_sum = 0, face_sum = 0;
  for (int i = 0; i < k; ++i) {
    edge_sum += v.edges[(first + i) % ring_edges];
    face_sum += v.faces[(first + i) % ring_edges];
  }
  const double a = v.edges[(first + 1) % ring_edges] / 16 + v.faces[first] / 4;
  const double b = 3 * edge_sum / 8 + face_sum / 4;
  const double determinant = (lambda - 0.5) * (lambda - 0.75) - 0.125;
  v.edges[first] = v.edges[last] = (a * (lambda - 0.75) + b / 8) / determinant;
  v.vertex = ((lambda - 0.5) * b + a) / determinant;
}

void corner_tangents(const SmoothSector& sector, RingWeights& u, RingWeights& v) {
  const int ring_edges = static_cast<int>(u.edges.size());
  const int k = sector.face_count;
  // A model fan: right angles, squeezed where that would exceed three of them.
  const double angle = std::min(pi / 2, 1.5 * pi / k);
  for (int i = 0; i <= k; ++i) {
    const int place = (sector.first_edge + i) % ring_edges;
    u.edges[place] = i == 1 && k <= 3 ? 0 : std::cos(i * angle);
    v.edges[place] = i == 0 || (i == 2 && k <= 3) ? 0 : std::sin(i * angle);
    u.vertex -= u.edges[place];
    v.vertex -= v.edges[place];
  }
}

}  // namespace

void RingWeights::reset(int edge_count, int face_count) {
  vertex = 0;
  edges.assign(static_cast<std::size_t>(edge_count), 0);
  faces.assign(static_cast<std::size_t>(face_count), 0);
}

void list_sectors(const LimitRing& ring, std::vector<SmoothSector>& sectors) {
  sectors.clear();
  const auto& sharp = ring.sharp_edges;
  if (sharp.empty()) {
    sectors.push_back({0, ring.face_count});
    return;
  }
  for (std::size_t k = 0; k + 1 < sharp.size(); ++k) sectors.push_back({sharp[k], sharp[k + 1] - sharp[k]});
  if (ring.face_count == ring.edge_count) {
    sectors.push_back({sharp.back(), sharp.front() + ring.edge_count - sharp.back()});
  }
}

bool is_regular(const LimitRing& ring, const SmoothSector& sector) {
  switch (ring.rule) {
    case VertexRule::smooth:
      return sector.face_count == 4;
    case VertexRule::crease:
      return sector.face_count == 2;
    case VertexRule::corner:
      return sector.face_count == 1;
    case VertexRule::dart:
      break;
  }
  return false;
}

void limit_position_mask(const LimitRing& ring, RingWeights& position) {
  position.reset(ring.edge_count, ring.face_count);
  const double n = ring.edge_count;
  switch (ring.rule) {
    case VertexRule::smooth:
      position.vertex = n / (n + 5);
      position.edges.assign(position.edges.size(), 4 / (n * (n + 5)));
      position.faces.assign(position.faces.size(), 1 / (n * (n + 5)));
      break;
    case VertexRule::dart:
      dart_position(ring.edge_count, ring.sharp_edges[0], position);
      break;
    case VertexRule::crease:
      position.vertex = 2.0 / 3;
      for (const int i : ring.sharp_edges) position.edges[i] = 1.0 / 6;
      break;
    case VertexRule::corner:
      position.vertex = 1;
      break;
  }
}

void limit_tangent_masks(const LimitRing& ring, const SmoothSector& sector, RingWeights& u, RingWeights& v) {
  u.reset(ring.edge_count, ring.face_count);
  v.reset(ring.edge_count, ring.face_count);
  if (ring.rule == VertexRule::crease) {
    crease_tangents(sector, u, v);
  } else if (ring.rule == VertexRule::dart) {
    dart_tangents(ring.edge_count, sector.first_edge, u, v);
  } else if (ring.rule == VertexRule::smooth || sector.face_count == ring.edge_count) {
    smooth_tangents(ring.edge_count, sector.first_edge, u, v);
  } else {
    corner_tangents(sector, u, v);
  }
}

void pull_back_to_centroids(double vertex_sharpness, std::span<const double> edge_sharpness,
                            RingWeights& weights) {
  const VertexMask mask = vertex_mask(vertex_sharpness, edge_sharpness);
  const double child_vertex = weights.vertex;
  weights.vertex = child_vertex * mask.vertex;
  for (double& face : weights.faces) face += child_vertex * mask.face;
  for (std::size_t i = 0; i < edge_sharpness.size(); ++i) {
    const double child_edge = weights.edges[i];
    const EdgeMask rule = edge_mask(edge_sharpness[i]);
    weights.vertex += child_edge * rule.end;
    weights.edges[i] = child_edge * rule.end + child_vertex * mask.edge;
    if (rule.face == 0) continue;  // boundary edges among others
    weights.faces[i] += child_edge * rule.face;
    weights.faces[i == 0 ? weights.faces.size() - 1 : i - 1] += child_edge * rule.face;
  }
  if (mask.crease != 0) {
    for (const int i : mask.crease_edges) weights.edges[i] += child_vertex * mask.crease;
  }
}

void spread_centroids_of_quads(RingWeights& weights) {
  for (std::size_t k = 0; k < weights.faces.size(); ++k) {
    const double quarter = weights.faces[k] / 4;
    weights.vertex += quarter;
    weights.edges[k] += quarter;
    weights.edges[k + 1 == weights.edges.size() ? 0 : k + 1] += quarter;
    weights.faces[k] = quarter;
  }
}

}  // namespace flowcage
