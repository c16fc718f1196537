#include "core/grade/blend_layers.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>

namespace flowcage {

std::vector<double> own_shares(const BlockMesh& mesh, const ChordSheet& sheet, std::span<const char> on_wall,
                               const BlendSettings& settings) {
  const std::size_t n = sheet.lines.size();
  std::vector<std::vector<Index>> neighbours(n);
  for (const auto& face : sheet.faces) {
    for (int c = 0; c < 4; ++c) {
      for (int d = 1; d < 4; ++d) neighbours[face[c]].push_back(face[(c + d) % 4]);
    }
  }
  const auto near_end = [&](Index l) -> const Vec3& {
    return mesh.points()[sheet_point(mesh, sheet.lines[l], 0)];
  };
  std::vector<double> distance(n, std::numeric_limits<double>::infinity());
  using Entry = std::pair<double, Index>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> front;
  for (std::size_t l = 0; l < n; ++l) {
    if (on_wall[l] == 0) continue;
    distance[l] = 0;
    front.emplace(0, static_cast<Index>(l));
  }
  while (!front.empty()) {
    const auto [d, l] = front.top();
    front.pop();
    if (d > distance[l] || d >= settings.reach) continue;
    for (const Index m : neighbours[l]) {
      const double next = d + (near_end(m) - near_end(l)).norm();
      if (next >= distance[m]) continue;
      distance[m] = next;
      front.emplace(next, m);
    }
  }
  for (double& d : distance) {
    const double x = std::min(1.0, d / settings.reach);
    d = x * x * (3 - 2 * x);
  }
  return distance;
}

std::vector<double> blended(std::span<const double> layered, std::span<const double> own, double share) {
  std::vector<double> out(layered.begin(), layered.end());
  for (std::size_t k = 1; k + 1 < out.size(); ++k) {
    out[k] = std::pow(layered[k], 1 - share) * std::pow(own[k], share);
  }
  return out;
}

}  // namespace flowcage
