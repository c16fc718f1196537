#include "core/project/side_normals.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace flowcage {
namespace {

/// The 26 directions to the neighbours in a grid: none is farther than 28 degrees from one of them.
std::vector<Vec3> probe_directions() {
  std::vector<Vec3> directions;
  for (int x = -1; x <= 1; ++x) {
    for (int y = -1; y <= 1; ++y) {
      for (int z = -1; z <= 1; ++z) {
        if (x != 0 || y != 0 || z != 0) directions.push_back(Vec3(x, y, z).normalized());
      }
    }
  }
  return directions;
}

}  // namespace

Csr<Vec3> normals_at(const TargetSurface& target, std::span<const Vec3> points) {
  constexpr double probe_cosine = 0.85, same_cosine = 0.999;
  const double reach = 1e-4 * target.diagonal(), slack = 2e-5 * target.diagonal();
  const std::vector<Vec3> directions = probe_directions();
  std::vector<std::vector<SurfacePoint>> found;
  for (const Vec3& direction : directions) {
    const std::vector<Vec3> normals(points.size(), direction);
    found.emplace_back(points.size());
    target.closest_compatible(points, normals, probe_cosine, reach, found.back());
  }
  Csr<Vec3> result;
  for (std::size_t i = 0; i < points.size(); ++i) {
    double nearest = std::numeric_limits<double>::infinity();
    for (const auto& feet : found) {
      if (feet[i].status != FootStatus::failed) nearest = std::min(nearest, feet[i].distance);
    }
    std::vector<Vec3> row;
    for (const auto& feet : found) {
      if (feet[i].status == FootStatus::failed || feet[i].distance > nearest + slack) continue;
      const Vec3& n = feet[i].normal;
      if (std::none_of(row.begin(), row.end(), [&](const Vec3& m) { return m.dot(n) > same_cosine; })) {
        row.push_back(n);
      }
    }
    result.push_row(row);
  }
  return result;
}

std::vector<SideNormal> face_normals(const SurfaceLevel& level, std::span<const Vec3> points) {
  constexpr double trusted_slenderness = 0.25;
  std::vector<SideNormal> normals(static_cast<std::size_t>(level.face_count()));
  for (Index f = 0; f < level.face_count(); ++f) {
    const auto corners = level.face_vertices[f];
    Vec3 twice_area = Vec3::Zero();
    double longest = 0;
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const Vec3& a = points[corners[i]];
      const Vec3& b = points[corners[(i + 1) % corners.size()]];
      twice_area += (a - points[corners[0]]).cross(b - points[corners[0]]);
      longest = std::max(longest, (a - b).norm());
    }
    const double norm = twice_area.norm();
    if (!(norm > 0)) continue;
    normals[f].normal = twice_area / norm;
    const double height = 0.5 * norm / longest;
    normals[f].weight = std::min(1.0, height / (trusted_slenderness * longest));
  }
  return normals;
}

double normal_mismatch(std::span<const SideNormal> cage, std::span<const Vec3> target) {
  constexpr double tolerated = 0.3;
  double sum = 0, weights = 0;
  for (const SideNormal& side : cage) {
    double best = -1;
    for (const Vec3& n : target) best = std::max(best, side.normal.dot(n));
    sum += side.weight * (1 - best);
    weights += side.weight;
  }
  if (!(weights > 0) || target.empty()) return 0;
  return std::max(0.0, sum / weights - tolerated);
}

}  // namespace flowcage
