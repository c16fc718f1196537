#include "core/volume/corner_fan.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace flowcage {

FanCorner fan_corner(std::span<const Vec3> points, Index at, Index after, Index before) {
  const Vec3 a = points[after] - points[at];
  const Vec3 b = points[before] - points[at];
  const Vec3 normal = a.cross(b);
  return {before, after, normal.norm() > 0 ? Vec3(normal.normalized()) : Vec3(Vec3::Zero()),
          std::atan2(normal.norm(), a.dot(b))};
}

std::vector<double> best_sines(std::span<const FanCorner> corners, double crease_degrees) {
  const double least_cosine = std::cos(crease_degrees * std::numbers::pi / 180);
  const std::size_t n = corners.size();
  std::vector<std::size_t> sector(n);
  for (std::size_t i = 0; i < n; ++i) sector[i] = i;
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const FanCorner& a = corners[i];
      const FanCorner& b = corners[j];
      const bool neighbours = a.after == b.before || a.before == b.after;
      if (!neighbours || a.normal.dot(b.normal) < least_cosine || sector[i] == sector[j]) continue;
      const std::size_t from = sector[i];
      std::replace(sector.begin(), sector.end(), from, sector[j]);
    }
  }
  std::vector<double> angle(n, 0);
  std::vector<int> count(n, 0);
  for (std::size_t i = 0; i < n; ++i) {
    angle[sector[i]] += corners[i].angle;
    ++count[sector[i]];
  }
  std::vector<double> sines(n);
  for (std::size_t i = 0; i < n; ++i) {
    sines[i] = std::max(0.0, std::sin(std::min(angle[sector[i]] / count[sector[i]], std::numbers::pi)));
  }
  return sines;
}

Vec3 nearest_in_hull(std::span<const Vec3> points) {
  Vec3 p = points.front();
  for (const Vec3& q : points) {
    if (q.squaredNorm() < p.squaredNorm()) p = q;
  }
  constexpr int most_steps = 2000;
  for (int step = 0; step < most_steps && p.squaredNorm() > 0; ++step) {
    const auto least = std::min_element(points.begin(), points.end(),
                                        [&](const Vec3& a, const Vec3& b) { return a.dot(p) < b.dot(p); });
    if (p.squaredNorm() - least->dot(p) <= 1e-6 * p.squaredNorm()) break;
    const Vec3 toward = *least - p;
    p += std::clamp(-p.dot(toward) / toward.squaredNorm(), 0.0, 1.0) * toward;
  }
  return p;
}

}  // namespace flowcage
