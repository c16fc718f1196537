#include "core/blocks/enclosure.hpp"

#include <fmt/format.h>
#include <numbers>

#include "core/base/error.hpp"
#include "core/base/parallel.hpp"
#include "core/project/winding_number.hpp"

namespace flowcage {
namespace {

/// Whether segment ab passes through the triangle: b and a on different sides, and the line inside of all
/// three edges (signed volumes of tetrahedra).
bool crosses(const Vec3& a, const Vec3& b, const std::array<Vec3, 3>& t) {
  const auto volume = [](const Vec3& p, const Vec3& q, const Vec3& r, const Vec3& s) {
    return (q - p).cross(r - p).dot(s - p);
  };
  const double side_a = volume(t[0], t[1], t[2], a);
  const double side_b = volume(t[0], t[1], t[2], b);
  if ((side_a > 0) == (side_b > 0)) return false;
  const bool s0 = volume(a, b, t[0], t[1]) > 0;
  const bool s1 = volume(a, b, t[1], t[2]) > 0;
  const bool s2 = volume(a, b, t[2], t[0]) > 0;
  return s0 == s1 && s1 == s2;
}

/// First edge of `of` that passes through a triangle; no_index if none does.
Index first_crossing(const Polyhedron& of, const TriangleSoup& surface, Vec3& where) {
  std::vector<Box3> boxes;
  for (const auto& t : surface.triangles) {
    Box3 box(t[0]);
    box.extend(t[1]);
    box.extend(t[2]);
    boxes.push_back(box);
  }
  constexpr Index none = std::numeric_limits<Index>::max();
  const Index first = parallel_reduce(
      of.level.edge_count(), 64, none,
      [&](Offset begin, Offset end) {
        for (Offset e = begin; e < end; ++e) {
          const auto& [v, w] = of.level.edge_vertices[e];
          Box3 box(of.points[v]);
          box.extend(of.points[w]);
          for (std::size_t t = 0; t < boxes.size(); ++t) {
            if (boxes[t].intersects(box) && crosses(of.points[v], of.points[w], surface.triangles[t])) {
              return static_cast<Index>(e);
            }
          }
        }
        return none;
      },
      [](Index a, Index b) { return std::min(a, b); });
  if (first == none) return no_index;
  const auto& [v, w] = of.level.edge_vertices[first];
  where = (of.points[v] + of.points[w]) / 2;
  return first;
}

std::string extents(const Polyhedron& p) {
  Box3 box;
  for (const Vec3& x : p.points) box.extend(x);
  const Vec3 d = box.diagonal();
  return fmt::format("{:.4g} x {:.4g} x {:.4g} m", d.x(), d.y(), d.z());
}

/// First vertex whose winding number about the surface is (or is not) above one half.
Index first_vertex(const Polyhedron& of, const TriangleSoup& surface, bool inside) {
  constexpr Index none = std::numeric_limits<Index>::max();
  const Index first = parallel_reduce(
      static_cast<Offset>(of.points.size()), 16, none,
      [&](Offset begin, Offset end) {
        for (Offset v = begin; v < end; ++v) {
          if ((winding_number(surface, of.points[v]) > 0.5) == inside) return static_cast<Index>(v);
        }
        return none;
      },
      [](Index a, Index b) { return std::min(a, b); });
  return first == none ? no_index : first;
}

}  // namespace

TriangleSoup closed_triangles(const Polyhedron& polyhedron, const std::optional<SymmetryPlane>& plane) {
  TriangleSoup soup;
  const auto& p = polyhedron.points;
  for (Index f = 0; f < polyhedron.level.face_count(); ++f) {
    const auto corners = polyhedron.level.face_vertices[f];
    Vec3 centre = Vec3::Zero();
    for (const Index v : corners) centre += p[v] / static_cast<double>(corners.size());
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const Vec3& a = p[corners[i]];
      const Vec3& b = p[corners[(i + 1) % corners.size()]];
      soup.triangles.push_back({a, b, centre});
      if (plane) soup.triangles.push_back({plane->mirrored(b), plane->mirrored(a), plane->mirrored(centre)});
    }
  }
  return soup;
}

double signed_volume(const TriangleSoup& surface) {
  if (surface.triangles.empty()) return 0;
  const Vec3 origin = surface.triangles[0][0];
  double six = 0;
  for (const auto& [a, b, c] : surface.triangles) six += (a - origin).dot((b - origin).cross(c - origin));
  return six / 6;
}

double winding_number(const TriangleSoup& surface, const Vec3& p) {
  double sum = 0;
  for (const auto& [a, b, c] : surface.triangles) sum += solid_angle(a - p, b - p, c - p);
  return sum / (4 * std::numbers::pi);
}

std::optional<std::string> enclosure_defect(const Polyhedron& inner, const Polyhedron& outer,
                                            const std::optional<SymmetryPlane>& plane) {
  const TriangleSoup inner_surface = closed_triangles(inner, plane);
  const TriangleSoup outer_surface = closed_triangles(outer, plane);
  const std::string sizes =
      fmt::format("the outer polyhedron measures {}, the cage {}", extents(outer), extents(inner));
  const Index inside = first_vertex(outer, inner_surface, true);
  const Index outside = first_vertex(inner, outer_surface, false);
  if (inside != no_index && outside != no_index && first_vertex(outer, inner_surface, false) == no_index) {
    return fmt::format("it lies inside of the cage: {}", sizes);
  }
  if (outside != no_index) {
    return fmt::format("vertex {} of the cage at {} lies outside of it: {}", outside + 1,
                       place(inner.points[outside]), sizes);
  }
  if (inside != no_index) {
    return fmt::format("its vertex {} at {} lies inside of the cage: {}", inside + 1,
                       place(outer.points[inside]), sizes);
  }
  Vec3 where;
  if (first_crossing(inner, outer_surface, where) != no_index) {
    return fmt::format("an edge of the cage near {} passes through it", place(where));
  }
  if (first_crossing(outer, inner_surface, where) != no_index) {
    return fmt::format("its edge near {} passes through the cage", place(where));
  }
  return std::nullopt;
}

}  // namespace flowcage
