#include "core/blocks/symmetry_plane.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>

#include "core/base/error.hpp"

namespace flowcage {
namespace {

constexpr double planar_tolerance = 1e-4;  // of the diagonal: hand-drawn files carry a few digits

}  // namespace

std::vector<Index> boundary_vertices(const SurfaceLevel& level) {
  std::vector<Index> result;
  for (Index e = 0; e < level.edge_count(); ++e) {
    if (level.is_boundary_edge(e)) {
      result.insert(result.end(), level.edge_vertices[e].begin(), level.edge_vertices[e].end());
    }
  }
  std::sort(result.begin(), result.end());
  result.erase(std::unique(result.begin(), result.end()), result.end());
  return result;
}

std::optional<SymmetryPlane> find_symmetry_plane(const SurfaceLevel& level, std::span<const Vec3> points,
                                                 const std::string& source) {
  const std::vector<Index> rim = boundary_vertices(level);
  if (rim.empty()) return std::nullopt;
  Box3 box;
  for (const Vec3& p : points) box.extend(p);
  const double diagonal = box.diagonal().norm();
  Vec3 centre = Vec3::Zero();
  for (const Index v : rim) centre += points[v] / static_cast<double>(rim.size());
  // Least-squares plane: the direction in which the rim varies least.
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const Index v : rim) spread += (points[v] - centre) * (points[v] - centre).transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(spread);
  SymmetryPlane plane;
  plane.normal = eigen.eigenvectors().col(0);
  for (int axis = 0; axis < 3; ++axis) {
    if (std::abs(plane.normal[axis]) > 1 - planar_tolerance * planar_tolerance) {
      plane.axis = axis;
      plane.normal = Vec3::Unit(axis);
    }
  }
  plane.offset = plane.normal.dot(centre);
  if (plane.axis != no_index) {
    // The middle of the extremes: the exact value where all agree.
    double low = points[rim[0]][plane.axis];
    double high = low;
    for (const Index v : rim) {
      low = std::min(low, points[v][plane.axis]);
      high = std::max(high, points[v][plane.axis]);
    }
    plane.offset = low == high ? low : (low + high) / 2;
    if (std::abs(plane.offset) < 1e-9 * diagonal) plane.offset = 0;
  }
  double above = 0;
  double below = 0;
  Index lowest = 0;
  for (Index v = 0; v < static_cast<Index>(points.size()); ++v) {
    const double d = plane.distance(points[v]);
    above = std::max(above, d);
    if (d < below) {
      below = d;
      lowest = v;
    }
  }
  if (above < -below) {
    plane.normal = -plane.normal;
    plane.offset = -plane.offset;
    std::swap(above, below);
    above = -above;
    below = -below;
    lowest = no_index;
  }
  double worst = 0;
  Index worst_vertex = rim[0];
  for (const Index v : rim) {
    if (std::abs(plane.distance(points[v])) > worst) {
      worst = std::abs(plane.distance(points[v]));
      worst_vertex = v;
    }
  }
  if (worst > planar_tolerance * diagonal) {
    throw input_error(
        source, 0,
        fmt::format("the open boundary is not planar: vertex {} at {} is {:.3g} off the plane of its "
                    "loops ({:.2g} of the diagonal, {:.0e} allowed)",
                    worst_vertex + 1, place(points[worst_vertex]), worst, worst / diagonal, planar_tolerance),
        "an open boundary is taken as the cut of a half model: put all its vertices into one plane, or "
        "close the polyhedron");
  }
  if (below < -planar_tolerance * diagonal) {
    const std::string where = lowest == no_index ? "" : " at " + place(points[lowest]);
    throw input_error(
        source, 0,
        fmt::format("vertices lie on both sides of the plane of the open boundary (from {:.3g} to "
                    "{:.3g}{})",
                    below, above, where),
        "a half model lies on one side of its symmetry plane");
  }
  return plane;
}

}  // namespace flowcage
