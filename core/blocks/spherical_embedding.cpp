#include "core/blocks/spherical_embedding.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <deque>

#include "core/base/error.hpp"
#include "core/blocks/enclosure.hpp"

namespace flowcage {
namespace {

constexpr double pi = 3.14159265358979323846;

/// Positive and smooth for any D, close to D where it is positive (Garanzha et al., eq. 3).
struct Chi {
  double value, derivative;
};
Chi chi(double d, double epsilon) {
  const double root = std::sqrt(epsilon * epsilon + d * d);
  // For D << 0 the sum cancels: eps^2 / (2 (root - D)) is the same number.
  const double value = d > 0 ? (d + root) / 2 : epsilon * epsilon / (2 * (root - d));
  return {value, root > 0 ? value / root : 0.5};
}

/// The energy of directions a = x / |x|.
class EmbeddingEnergy {
 public:
  EmbeddingEnergy(const Polyhedron& surface, const std::optional<SymmetryPlane>& plane) : plane_(plane) {
    const SurfaceLevel& s = surface.level;
    const double area = (plane ? 2 : 4) * pi / s.face_count();
    area_ = area;
    on_rim_.assign(s.vertex_count(), 0);
    if (plane) {
      for (const Index v : boundary_vertices(s)) on_rim_[v] = 1;
    }
    for (Index f = 0; f < s.face_count(); ++f) {
      for (int c = 0; c < 4; ++c) {
        const std::array<Index, 3> corner{s.face_vertices[f][c], s.face_vertices[f][(c + 1) % 4],
                                          s.face_vertices[f][(c + 3) % 4]};
        const Vec3 normal = (surface.points[corner[1]] - surface.points[corner[0]])
                                .cross(surface.points[corner[2]] - surface.points[corner[0]]);
        corners_.push_back(corner);
        normals_.push_back(normal.norm() > 0 ? Vec3(normal.normalized()) : Vec3::Zero());
      }
    }
  }

  struct Bounds {
    double determinant = 1e300, cosine = 1e300;
  };
  Bounds bounds(std::span<const Vec3> a) const {
    Bounds least;
    for (std::size_t n = 0; n < corners_.size(); ++n) {
      const auto& [o, b, c] = corners_[n];
      least.determinant = std::min(least.determinant, a[o].dot(a[b].cross(a[c])) / area_);
      if (!normals_[n].isZero()) least.cosine = std::min(least.cosine, a[o].dot(normals_[n]));
    }
    return least;
  }

  Index folded_corners(std::span<const Vec3> a) const {
    Index count = 0;
    for (const auto& [o, b, c] : corners_) count += a[o].dot(a[b].cross(a[c])) > 0 ? 0 : 1;
    return count;
  }

  struct Barriers {
    double epsilon = 0, wall_epsilon = 0;
    double wall = 0;  ///< weight of the line's angle with the wall
  };
  /// Mean energy a corner, and its gradient by x.
  double operator()(std::span<const Vec3> x, const Barriers& barriers, std::vector<Vec3>& gradient) const {
    std::vector<Vec3> a(x.size());
    for (std::size_t v = 0; v < x.size(); ++v) a[v] = x[v].normalized();
    std::vector<Vec3> by_a(x.size(), Vec3::Zero());
    double energy = 0;
    for (std::size_t n = 0; n < corners_.size(); ++n) {
      const auto& [o, b, c] = corners_[n];
      const Vec3 e = a[b] - a[o];
      const Vec3 g = a[c] - a[o];
      const Vec3 bc = a[b].cross(a[c]);
      const double d = a[o].dot(bc) / area_;
      const auto [x_d, slope] = chi(d, barriers.epsilon);
      const double size = (e.squaredNorm() + g.squaredNorm()) / (2 * area_);
      const double spread = lambda * (d * d + 1);
      energy += (size + spread) / x_d;
      const double by_d = 2 * lambda * d / x_d - (size + spread) / (x_d * x_d) * slope;
      const double w = 1 / (area_ * x_d);
      by_a[b] += w * e + by_d / area_ * a[c].cross(a[o]);
      by_a[c] += w * g + by_d / area_ * a[o].cross(a[b]);
      by_a[o] += -w * (e + g) + by_d / area_ * bc;
      if (barriers.wall > 0 && !normals_[n].isZero()) {
        const double cosine = a[o].dot(normals_[n]);
        const auto [x_c, slope_c] = chi(cosine, barriers.wall_epsilon);
        energy += barriers.wall / x_c;
        by_a[o] -= barriers.wall / (x_c * x_c) * slope_c * normals_[n];
      }
    }
    const double scale = 1 / static_cast<double>(corners_.size());
    gradient.resize(x.size());
    for (std::size_t v = 0; v < x.size(); ++v) {
      Vec3 g = by_a[v] - a[v] * a[v].dot(by_a[v]);
      if (on_rim_[v] != 0) g -= plane_->normal * plane_->normal.dot(g);
      gradient[v] = g * (scale / x[v].norm());
    }
    return energy * scale;
  }

  bool on_rim(Index v) const { return on_rim_[v] != 0; }

 private:
  static constexpr double lambda = 0.25;  // of even sizes against square shapes
  const std::optional<SymmetryPlane>& plane_;
  double area_ = 1;
  std::vector<char> on_rim_;
  std::vector<std::array<Index, 3>> corners_;
  std::vector<Vec3> normals_;
};

double dot(std::span<const Vec3> a, std::span<const Vec3> b) {
  double sum = 0;
  for (std::size_t v = 0; v < a.size(); ++v) sum += a[v].dot(b[v]);
  return sum;
}

/// L-BFGS (Nocedal & Wright, algorithm 7.5) with backtracking; at most `iterations` steps. Returns the
/// energy.
template <typename Function>
double minimise(std::vector<Vec3>& x, int iterations, const Function& f) {
  struct Pair {
    std::vector<Vec3> step, change;
    double rho;
  };
  std::deque<Pair> memory;
  std::vector<Vec3> gradient;
  double energy = f(x, gradient);
  for (int n = 0; n < iterations; ++n) {
    std::vector<Vec3> direction = gradient;
    std::vector<double> alpha(memory.size());
    for (std::size_t m = memory.size(); m-- > 0;) {
      alpha[m] = memory[m].rho * dot(memory[m].step, direction);
      for (std::size_t v = 0; v < x.size(); ++v) direction[v] -= alpha[m] * memory[m].change[v];
    }
    const double gamma = memory.empty()
                             ? 0.1 / std::max(std::sqrt(dot(gradient, gradient)), 1e-300)
                             : 1 / (memory.back().rho * dot(memory.back().change, memory.back().change));
    for (Vec3& d : direction) d *= gamma;
    for (std::size_t m = 0; m < memory.size(); ++m) {
      const double beta = memory[m].rho * dot(memory[m].change, direction);
      for (std::size_t v = 0; v < x.size(); ++v) direction[v] += (alpha[m] - beta) * memory[m].step[v];
    }
    const double slope = -dot(gradient, direction);
    if (!(slope < 0)) {
      if (memory.empty()) break;
      memory.clear();  // no descent: start again along the gradient
      continue;
    }
    double step = 1;
    std::vector<Vec3> next(x.size());
    std::vector<Vec3> next_gradient;
    double next_energy = energy;
    bool found = false;
    for (int halving = 0; halving < 40 && !found; ++halving, step /= 2) {
      for (std::size_t v = 0; v < x.size(); ++v) next[v] = x[v] - step * direction[v];
      next_energy = f(next, next_gradient);
      found = next_energy <= energy + 1e-4 * step * slope;
    }
    if (!found) break;
    Pair pair{std::vector<Vec3>(x.size()), std::vector<Vec3>(x.size()), 0};
    for (std::size_t v = 0; v < x.size(); ++v) {
      pair.step[v] = next[v] - x[v];
      pair.change[v] = next_gradient[v] - gradient[v];
    }
    const double curvature = dot(pair.step, pair.change);
    if (curvature > 1e-12 * dot(pair.change, pair.change)) {
      pair.rho = 1 / curvature;
      memory.push_back(std::move(pair));
      if (memory.size() > 12) memory.pop_front();
    }
    const double decrease = energy - next_energy;
    x = std::move(next);
    gradient = std::move(next_gradient);
    energy = next_energy;
    if (decrease < 1e-9 * std::abs(energy)) break;
  }
  return energy;
}

/// The symmetric matrix that makes the surface round: inverse square root of its covariance, so no rotation.
struct Rounding {
  Vec3 centroid;
  Eigen::Matrix3d matrix;
};
Rounding make_round(const Polyhedron& surface, const std::optional<SymmetryPlane>& plane) {
  const SurfaceLevel& s = surface.level;
  const auto& p = surface.points;
  Vec3 centre = Vec3::Zero();
  double area = 0;
  std::vector<double> areas;
  for (Index f = 0; f < s.face_count(); ++f) {
    const auto v = s.face_vertices[f];
    areas.push_back((p[v[2]] - p[v[0]]).cross(p[v[3]] - p[v[1]]).norm() / 2);
    centre += areas.back() * (p[v[0]] + p[v[1]] + p[v[2]] + p[v[3]]) / 4;
    area += areas.back();
  }
  centre /= area;
  if (plane) centre -= plane->distance(centre) * plane->normal;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (Index f = 0; f < s.face_count(); ++f) {
    for (const Index v : s.face_vertices[f]) {
      const Vec3 d = p[v] - centre;
      covariance += areas[f] / area / 4 * d * d.transpose();
      if (plane) {  // and the mirror image, so that the plane's normal is one of the axes
        const Vec3 m = d - 2 * plane->normal.dot(d) * plane->normal;
        covariance += areas[f] / area / 4 * m * m.transpose();
      }
    }
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(covariance);
  const Vec3 least = eigen.eigenvalues().cwiseMax(1e-12 * eigen.eigenvalues().maxCoeff());
  return {centre, eigen.eigenvectors() * least.cwiseSqrt().cwiseInverse().asDiagonal() *
                      eigen.eigenvectors().transpose()};
}

/// Directions of the places relative to a centre inside of the body, after the surface was made round. Any
/// centre inside gives a map that covers the sphere once, folds aside (outside: none can be unfolded); of the
/// centroid and midpoints between vertices (of the rim) the one with the fewest folded corners is taken.
std::vector<Vec3> round_directions(const Polyhedron& surface, const std::optional<SymmetryPlane>& plane,
                                   const EmbeddingEnergy& energy) {
  const Rounding round = make_round(surface, plane);
  const TriangleSoup closed = closed_triangles(surface, plane);
  std::vector<Index> ends;
  if (plane) {
    ends = boundary_vertices(surface.level);
  } else {
    for (Index v = 0; v < surface.level.vertex_count(); ++v) ends.push_back(v);
  }
  constexpr std::size_t max_candidates = 400;
  const std::size_t pairs = ends.size() * (ends.size() - 1) / 2;
  const std::size_t stride = pairs / max_candidates + 1;
  std::vector<Vec3> candidates{round.centroid};
  std::size_t pair = 0;
  for (std::size_t i = 0; i < ends.size(); ++i) {
    for (std::size_t j = i + 1; j < ends.size(); ++j, ++pair) {
      if (pair % stride == 0) candidates.push_back((surface.points[ends[i]] + surface.points[ends[j]]) / 2);
    }
  }
  std::vector<Vec3> best;
  Index fewest = std::numeric_limits<Index>::max();
  for (const Vec3& centre : candidates) {
    if (!(winding_number(closed, centre) > 0.5)) continue;
    std::vector<Vec3> directions;
    for (const Vec3& p : surface.points) {
      const Vec3 d = round.matrix * (p - centre);
      directions.push_back(d.norm() > 1e-9 ? Vec3(d.normalized()) : Vec3::UnitZ());
    }
    const Index folded = energy.folded_corners(directions);
    if (folded < fewest) {
      fewest = folded;
      best = std::move(directions);
    }
    if (fewest == 0) break;
  }
  return best;
}

/// How often the quads cover the sphere (half sphere), from the solid angles of their triangles.
double coverage(const SurfaceLevel& s, std::span<const Vec3> a, bool half) {
  double sum = 0;
  const auto solid_angle = [](const Vec3& p, const Vec3& q, const Vec3& r) {
    return 2 * std::atan2(p.dot(q.cross(r)), 1 + p.dot(q) + q.dot(r) + r.dot(p));
  };
  for (Index f = 0; f < s.face_count(); ++f) {
    const auto v = s.face_vertices[f];
    sum += solid_angle(a[v[0]], a[v[1]], a[v[2]]) + solid_angle(a[v[0]], a[v[2]], a[v[3]]);
  }
  return sum / ((half ? 2 : 4) * pi);
}

}  // namespace

SphericalEmbedding embed_on_sphere(const Polyhedron& surface, const std::optional<SymmetryPlane>& plane,
                                   const std::string& source) {
  const EmbeddingEnergy energy(surface, plane);
  std::vector<Vec3> x = round_directions(surface, plane, energy);
  if (x.empty()) {
    throw input_error(source, 0, "no point inside of the cage was found to grow a far field from",
                      "draw an outer polyhedron (--outer)");
  }
  const auto to_sphere = [&] {
    for (std::size_t v = 0; v < x.size(); ++v) {
      if (energy.on_rim(static_cast<Index>(v))) {
        if (plane->axis != no_index) {
          x[v][plane->axis] = 0;
        } else {
          x[v] -= plane->normal * plane->normal.dot(x[v]);
        }
      }
      x[v].normalize();
    }
  };
  to_sphere();
  SphericalEmbedding result;
  constexpr int max_passes = 60;
  constexpr int iterations_per_pass = 60;
  double last = std::numeric_limits<double>::infinity();
  for (int pass = 0; pass < max_passes; ++pass) {
    const auto least = energy.bounds(x);
    // As in the paper's published code: the barrier stands a fifth of the worst fold away.
    const auto epsilon = [](double worst) {
      return std::sqrt(1e-12 + 0.04 * std::pow(std::min(worst, 0.0), 2));
    };
    // First unfold; then the wall's normals join in, held back by the barrier that is now a true one.
    const bool unfolded = least.determinant > 0;
    EmbeddingEnergy::Barriers barriers;
    // Not above 0.1: on the free sphere a weaker barrier lets the map shrink to a point.
    barriers.epsilon = std::min(0.1, epsilon(least.determinant));
    barriers.wall_epsilon = std::max(0.03, epsilon(least.cosine));
    barriers.wall = unfolded ? 0.25 : 0;
    const double value =
        minimise(x, iterations_per_pass, [&](std::span<const Vec3> at, std::vector<Vec3>& gradient) {
          return energy(at, barriers, gradient);
        });
    to_sphere();
    result.iterations += iterations_per_pass;
    if (unfolded && value > last * (1 - 1e-4)) break;
    last = unfolded ? value : std::numeric_limits<double>::infinity();
  }
  const auto least = energy.bounds(x);
  result.min_determinant = least.determinant;
  result.min_wall_cosine = least.cosine;
  const double covered = coverage(surface.level, x, plane.has_value());
  if (!(least.determinant > 0) || std::abs(covered - 1) > 0.01) {
    Index worst = 0;
    double value = 1e300;
    for (Index f = 0; f < surface.level.face_count(); ++f) {
      const auto v = surface.level.face_vertices[f];
      for (int c = 0; c < 4; ++c) {
        const double d = x[v[c]].dot(x[v[(c + 1) % 4]].cross(x[v[(c + 3) % 4]]));
        if (d < value) {
          value = d;
          worst = v[c];
        }
      }
    }
    throw input_error(
        source, 0,
        fmt::format("the far field cannot be grown from this cage: its map to a sphere folds near {}",
                    place(surface.points[worst])),
        "draw an outer polyhedron (--outer), or even out the cage's faces there");
  }
  result.directions = std::move(x);
  return result;
}

}  // namespace flowcage
