#include "core/blocks/swept_section.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

namespace flowcage {
namespace {

/// Pieces of segments whose ends are nearer than `gap`, by cells of that size and their neighbours.
class Pieces {
 public:
  Pieces(const std::vector<std::array<Vec3, 2>>& segments, double gap) : parent_(segments.size()) {
    std::iota(parent_.begin(), parent_.end(), 0);
    std::map<std::array<long, 3>, Index> owner;
    for (std::size_t n = 0; n < segments.size(); ++n) {
      for (const Vec3& p : segments[n]) {
        const std::array<long, 3> cell{std::lround(p.x() / gap), std::lround(p.y() / gap),
                                       std::lround(p.z() / gap)};
        for (int shift = 0; shift < 27; ++shift) {
          const auto near =
              owner.find({cell[0] + shift % 3 - 1, cell[1] + shift / 3 % 3 - 1, cell[2] + shift / 9 - 1});
          if (near != owner.end()) parent_[root(static_cast<Index>(n))] = root(near->second);
        }
        owner.emplace(cell, static_cast<Index>(n));
      }
    }
  }
  Index root(Index n) {
    while (parent_[n] != n) n = parent_[n] = parent_[parent_[n]];
    return n;
  }

 private:
  std::vector<Index> parent_;
};

/// Where a chain's polyline passes the plane at s.
std::vector<Vec3> passages(const FeatureChain& chain, const Vec3& span, double s) {
  std::vector<Vec3> out;
  for (std::size_t n = 0; n + 1 < chain.polyline.size(); ++n) {
    const double a = span.dot(chain.polyline[n]) - s;
    const double b = span.dot(chain.polyline[n + 1]) - s;
    if ((a < 0) == (b < 0)) continue;
    out.push_back(chain.polyline[n] + a / (a - b) * (chain.polyline[n + 1] - chain.polyline[n]));
  }
  return out;
}

}  // namespace

PlaneCut cut_plane(const Tessellation& tessellation, const Vec3& span, double s, double gap) {
  std::vector<double> height(tessellation.points.size());
  for (std::size_t p = 0; p < height.size(); ++p) height[p] = span.dot(tessellation.points[p]) - s;
  PlaneCut cut;
  for (const auto& t : tessellation.triangles) {
    std::array<Vec3, 2> ends;
    int found = 0;
    for (int i = 0; i < 3 && found < 2; ++i) {
      const Index a = t[i];
      const Index b = t[(i + 1) % 3];
      if ((height[a] < 0) == (height[b] < 0)) continue;
      ends[found++] = tessellation.points[a] +
                      height[a] / (height[a] - height[b]) * (tessellation.points[b] - tessellation.points[a]);
    }
    if (found < 2) continue;
    const Vec3 normal = (tessellation.points[t[1]] - tessellation.points[t[0]])
                            .cross(tessellation.points[t[2]] - tessellation.points[t[0]]);
    if (normal.cross(ends[1] - ends[0]).dot(span) < 0) std::swap(ends[0], ends[1]);
    cut.segments.push_back(ends);
    cut.perimeter += (ends[1] - ends[0]).norm();
    cut.area += span.dot(ends[0].cross(ends[1])) / 2;
  }
  cut.area = std::abs(cut.area);
  Pieces pieces(cut.segments, gap);
  std::map<Index, double> length;
  for (std::size_t n = 0; n < cut.segments.size(); ++n) {
    length[pieces.root(static_cast<Index>(n))] += (cut.segments[n][1] - cut.segments[n][0]).norm();
  }
  for (const auto& [piece, l] : length) cut.components += l > 0.02 * cut.perimeter ? 1 : 0;
  return cut;
}

std::optional<std::array<Vec2, 2>> AirfoilSection::across(double fraction) const {
  const Vec2 along = (trailing - leading).normalized();
  const Vec2 up(-along.y(), along.x());
  const double at = fraction * chord();
  double high = 0;
  double low = 0;
  bool found = false;
  for (const auto& [a, b] : segments) {
    const double xa = along.dot(a - leading) - at;
    const double xb = along.dot(b - leading) - at;
    if ((xa < 0) == (xb < 0)) continue;
    const double h = up.dot(a + xa / (xa - xb) * (b - a) - leading);
    high = found ? std::max(high, h) : h;
    low = found ? std::min(low, h) : h;
    found = true;
  }
  if (!found) return std::nullopt;
  const Vec2 foot = leading + at * along;
  return std::array<Vec2, 2>{foot + high * up, foot + low * up};
}

double AirfoilSection::thickness() const {
  double most = 0;
  for (int n = 1; n < 20; ++n) {
    if (const auto sides = across(n / 20.0)) most = std::max(most, ((*sides)[0] - (*sides)[1]).norm());
  }
  return most;
}

std::optional<AirfoilSection> airfoil_section(const TargetSurface& target, const SweptAxes& axes, double s) {
  const PlaneCut cut = cut_plane(target.tessellation(), axes.span, s, 1e-5 * target.diagonal());
  if (cut.segments.empty()) return std::nullopt;
  AirfoilSection section;
  section.s = s;
  for (const auto& [a, b] : cut.segments) {
    section.segments.push_back({axes.section_place(a), axes.section_place(b)});
  }
  double most = -1;
  for (const auto& p : section.segments) {
    for (const auto& q : section.segments) {
      const double d = (p[0] - q[0]).squaredNorm();
      if (d <= most) continue;
      most = d;
      section.leading = p[0].x() < q[0].x() ? p[0] : q[0];
      section.trailing = p[0].x() < q[0].x() ? q[0] : p[0];
    }
  }
  section.base_upper = section.base_lower = section.trailing;
  const Vec2 along = (section.trailing - section.leading).normalized();
  const double chord = section.chord();
  std::vector<Vec2> edges;
  for (const FeatureChain& chain : target.features().chains) {
    if (chain.kind != ChainKind::sharp) continue;
    for (const Vec3& p : passages(chain, axes.span, s)) {
      const Vec2 at = axes.section_place(p);
      if (along.dot(at - section.leading) < 0.92 * chord) continue;
      const bool known = std::any_of(edges.begin(), edges.end(),
                                     [&](const Vec2& e) { return (e - at).norm() < 1e-5 * chord; });
      if (!known) edges.push_back(at);
    }
  }
  if (edges.size() == 1) {
    section.kind = TrailingEdge::sharp;
    section.trailing = section.base_upper = section.base_lower = edges[0];
  } else if (edges.size() >= 2) {
    section.kind = TrailingEdge::blunt;
    const Vec2 up(-along.y(), along.x());
    const auto [low, high] = std::minmax_element(
        edges.begin(), edges.end(), [&](const Vec2& a, const Vec2& b) { return up.dot(a) < up.dot(b); });
    section.base_upper = *high;
    section.base_lower = *low;
    section.trailing = (*high + *low) / 2;
  }
  return section;
}

}  // namespace flowcage
