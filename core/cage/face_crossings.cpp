#include "core/cage/face_crossings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <numeric>
#include <optional>

#include "core/base/error.hpp"

namespace flowcage {
namespace {

using Triangle = std::array<Vec3, 3>;

/// Where the inside of the segment meets the triangle, its border included (Möller & Trumbore 1997); none
/// where they are parallel.
std::optional<Vec3> crossing(const Vec3& from, const Vec3& to, const Triangle& t) {
  constexpr double slack = 1e-12, end = 1e-9;
  const Vec3 way = to - from, u = t[1] - t[0], v = t[2] - t[0];
  const Vec3 p = way.cross(v);
  const double det = u.dot(p);
  if (std::abs(det) <= slack * way.norm() * u.norm() * v.norm()) return std::nullopt;
  const Vec3 off = from - t[0];
  const double a = off.dot(p) / det;
  const Vec3 q = off.cross(u);
  const double b = way.dot(q) / det, s = v.dot(q) / det;
  if (a < -slack || b < -slack || a + b > 1 + slack || s < end || s > 1 - end) return std::nullopt;
  return from + s * way;
}

std::optional<Vec3> crossing(const Triangle& a, const Triangle& b) {
  for (std::size_t i = 0; i < 3; ++i) {
    if (const auto at = crossing(a[i], a[(i + 1) % 3], b)) return at;
    if (const auto at = crossing(b[i], b[(i + 1) % 3], a)) return at;
  }
  return std::nullopt;
}

std::vector<Triangle> fan(const Cage& cage, Index face) {
  const auto corners = cage.faces[face];
  Vec3 centre = Vec3::Zero();
  for (const Index v : corners) centre += cage.points[v] / static_cast<double>(corners.size());
  std::vector<Triangle> triangles;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    triangles.push_back({cage.points[corners[i]], cage.points[corners[(i + 1) % corners.size()]], centre});
  }
  return triangles;
}

bool share_a_vertex(const Cage& cage, Index a, Index b) {
  const auto of_a = cage.faces[a], of_b = cage.faces[b];
  return std::find_first_of(of_a.begin(), of_a.end(), of_b.begin(), of_b.end()) != of_a.end();
}

std::optional<Vec3> crossing(const Cage& cage, Index a, Index b) {
  const std::vector<Triangle> of_b = fan(cage, b);
  for (const Triangle& s : fan(cage, a)) {
    for (const Triangle& t : of_b) {
      if (const auto at = crossing(s, t)) return at;
    }
  }
  return std::nullopt;
}

}  // namespace

std::vector<FaceCrossing> find_face_crossings(const Cage& cage) {
  // Sort and sweep along the longest axis.
  Box3 whole;
  std::vector<Box3> boxes(static_cast<std::size_t>(cage.faces.size()));
  for (Index f = 0; f < cage.faces.size(); ++f) {
    for (const Index v : cage.faces[f]) boxes[f].extend(cage.points[v]);
    whole.extend(boxes[f]);
  }
  if (boxes.empty()) return {};
  Index axis = 0;
  whole.sizes().maxCoeff(&axis);
  std::vector<Index> order(boxes.size()), active;
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](Index a, Index b) {
    return std::pair(boxes[a].min()[axis], a) < std::pair(boxes[b].min()[axis], b);
  });
  std::vector<FaceCrossing> found;
  for (const Index f : order) {
    std::erase_if(active, [&](Index g) { return boxes[g].max()[axis] < boxes[f].min()[axis]; });
    for (const Index g : active) {
      if (!boxes[f].intersects(boxes[g]) || share_a_vertex(cage, f, g)) continue;
      if (const auto at = crossing(cage, f, g)) found.push_back({std::min(f, g), std::max(f, g), *at});
    }
    active.push_back(f);
  }
  std::sort(found.begin(), found.end(), [](const FaceCrossing& x, const FaceCrossing& y) {
    return std::pair(x.a, x.b) < std::pair(y.a, y.b);
  });
  return found;
}

LintReport lint_face_crossings(const Cage& cage) {
  const std::vector<FaceCrossing> crossings = find_face_crossings(cage);
  if (crossings.empty()) return {};
  LintFinding finding{"self_crossing", LintFinding::Severity::warning, {}, {}, {}};
  for (const FaceCrossing& c : crossings) finding.places.push_back(c.place);
  finding.message = fmt::format(
      "{} pair{} of faces without a common vertex pass through each other (faces {} "
      "and {} at {})",
      crossings.size(), crossings.size() > 1 ? "s" : "", crossings[0].a + 1, crossings[0].b + 1,
      place(crossings[0].place));
  finding.remedy = "move their vertices apart, or give each body a closed part of its own";
  return {finding};
}

}  // namespace flowcage
