#include "core/refit/cage_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "core/base/error.hpp"
#include "core/cage/orient_faces.hpp"
#include "core/limit/limit_stencils.hpp"

namespace flowcage {
namespace {

struct UnitStep {
  double factor;  ///< cage coordinates times this would fit
  const char* from;
  const char* to;
};
constexpr std::array<UnitStep, 12> unit_steps{{{1000, "mm", "m"},
                                               {0.001, "m", "mm"},
                                               {25.4, "mm", "in"},
                                               {1 / 25.4, "in", "mm"},
                                               {304.8, "mm", "ft"},
                                               {1 / 304.8, "ft", "mm"},
                                               {12, "in", "ft"},
                                               {1.0 / 12, "ft", "in"},
                                               {1 / 0.3048, "ft", "m"},
                                               {0.3048, "m", "ft"},
                                               {1 / 0.0254, "in", "m"},
                                               {0.0254, "m", "in"}}};

/// Single vertices may be drawn far outside; what is beyond this, in diagonals of the CAD, is a mistake (and
/// leaves the fit no digits).
constexpr double farthest_vertex = 1000;

/// Mean cosine between the normals of cage and target below which one of them is turned inside out.
constexpr double opposite = -0.3;

/// How badly two boxes differ: distance of centres and difference of sides, in diagonals of `b`.
double mismatch(const Box3& a, const Box3& b) {
  const double diagonal = b.diagonal().norm();
  return ((a.center() - b.center()).norm() + (a.sizes() - b.sizes()).norm()) / diagonal;
}

std::string named(const std::string& source) {
  return source.empty() ? "the cage" : source;
}

std::string box_text(const Box3& box) {
  return place(box.min()) + " to " + place(box.max());
}

/// Unit normals of the limit surface at the vertices; zero where there is none.
std::vector<Vec3> limit_normals(const SurfaceLevel& level, std::span<const Vec3> points) {
  const TangentStencils tangents = tangent_stencils(level);
  const std::vector<Vec3> u = apply_stencils(tangents.u, points);
  const std::vector<Vec3> v = apply_stencils(tangents.v, points);
  std::vector<Vec3> normals(u.size());
  for (std::size_t i = 0; i < u.size(); ++i) {
    const double norm = u[i].cross(v[i]).norm();
    normals[i] = norm > 0 ? Vec3(u[i].cross(v[i]) / norm) : Vec3::Zero();
  }
  return normals;
}

/// The faces of each connected part, in ascending order.
std::vector<std::vector<Index>> connected_parts(const SurfaceLevel& level) {
  std::vector<std::vector<Index>> parts;
  std::vector<bool> seen(static_cast<std::size_t>(level.face_count()), false);
  for (Index seed = 0; seed < level.face_count(); ++seed) {
    if (seen[seed]) continue;
    std::vector<Index> part{seed};
    seen[seed] = true;
    for (std::size_t k = 0; k < part.size(); ++k) {
      for (const Index e : level.face_edges[part[k]]) {
        for (const Index f : level.edge_faces[e]) {
          if (f == no_index || seen[f]) continue;
          seen[f] = true;
          part.push_back(f);
        }
      }
    }
    std::sort(part.begin(), part.end());
    parts.push_back(std::move(part));
  }
  return parts;
}

/// By the divergence theorem, about the middle of the part's open edges: a plane cut there adds nothing.
double enclosed_volume(const SurfaceLevel& level, std::span<const Vec3> points, std::span<const Index> part) {
  Vec3 open = Vec3::Zero(), all = Vec3::Zero();
  Index open_count = 0, count = 0;
  for (const Index f : part) {
    for (const Index e : level.face_edges[f]) {
      const Vec3 middle = 0.5 * (points[level.edge_vertices[e][0]] + points[level.edge_vertices[e][1]]);
      all += middle;
      ++count;
      if (!level.is_boundary_edge(e)) continue;
      open += middle;
      ++open_count;
    }
  }
  const Vec3 about = open_count > 0 ? Vec3(open / open_count) : Vec3(all / count);
  double volume = 0;
  for (const Index f : part) {
    const auto face = level.face_vertices[f];
    for (std::size_t i = 1; i + 1 < face.size(); ++i) {
      volume +=
          (points[face[0]] - about).dot((points[face[i]] - about).cross(points[face[i + 1]] - about)) / 6;
    }
  }
  return volume;
}

}  // namespace

void check_cage_belongs(const CageToCheck& cage, const TargetSurface& target) {
  Box3 box;
  for (const Vec3& p : cage.points) box.extend(p);
  const Box3 cad = target.bounds();
  const double diagonal = target.diagonal();
  const std::string boxes =
      fmt::format("the cage spans {}, the CAD {} (metres)", box_text(box), box_text(cad));

  const double size_ratio = box.diagonal().norm() / diagonal;
  const double now = mismatch(box, cad);
  if (size_ratio < 0.4 || size_ratio > 3) {
    const UnitStep* best = nullptr;
    double best_mismatch = 0.8;
    for (const UnitStep& unit : unit_steps) {
      const double scaled = mismatch(Box3(box.min() * unit.factor, box.max() * unit.factor), cad);
      if (scaled < best_mismatch && scaled < 0.5 * now) {
        best = &unit;
        best_mismatch = scaled;
      }
    }
    if (best != nullptr) {
      throw Error(
          ErrorKind::input,
          fmt::format("{}: the cage's size does not agree with the CAD's, but does when it is multiplied "
                      "by {:.6g}: {}",
                      named(cage.source), best->factor, boxes),
          fmt::format("the cage's numbers look like {1} where {0} was assumed (or the other way round in "
                      "the CAD): give the cage's unit with --cage-unit",
                      best->from, best->to));
    }
  }

  const std::size_t count = cage.points.size();
  for (std::size_t v = 0; v < count; ++v) {
    const double off = cad.exteriorDistance(cage.points[v]);
    if (off <= farthest_vertex * diagonal) continue;
    throw Error(ErrorKind::input,
                fmt::format("{}: vertex {} at {} lies {:.3g} diagonals of the CAD away from it; {}",
                            named(cage.source), v + 1, place(cage.points[v]), off / diagonal, boxes),
                "move the cage onto the CAD, or check its unit (--cage-unit) and that both files belong "
                "together");
  }
  std::vector<SurfacePoint> nearest(count);
  target.closest_points(cage.points, {}, nearest);
  std::vector<double> distances;
  double agreement = 0;
  Index used = 0;
  for (std::size_t v = 0; v < count; ++v) {
    if (nearest[v].status == FootStatus::failed) continue;
    distances.push_back(nearest[v].distance);
    if (cage.normals[v].isZero(0)) continue;
    agreement += cage.normals[v].dot(nearest[v].normal);
    ++used;
  }
  if (distances.empty()) {
    throw Error(ErrorKind::input,
                named(cage.source) + ": no point of the CAD was found near the cage; " + boxes,
                "check that both files belong together");
  }
  const auto middle = distances.begin() + static_cast<Offset>(distances.size() / 2);
  std::nth_element(distances.begin(), middle, distances.end());
  const double size = std::min(diagonal, box.diagonal().norm());
  if (*middle > 0.35 * size) {
    throw Error(
        ErrorKind::input,
        fmt::format("{}: the cage lies too far from the CAD: half of its vertices are more than {:.4g} m "
                    "away, {:.2g} times the size of the smaller one; {}",
                    named(cage.source), *middle, *middle / size, boxes),
        "move the cage onto the CAD, or check its unit (--cage-unit) and that both files belong together");
  }
  if (used > 0 && agreement / used < opposite) {
    throw Error(
        ErrorKind::input,
        fmt::format("{}: the cage is turned inside out: its normals point against the CAD's (mean cosine "
                    "{:.2f} over {} vertices)",
                    named(cage.source), agreement / used, used),
        "reverse all faces of the cage: counter-clockwise seen from the fluid's side; or, if they are, those "
        "of the CAD");
  }
}

void check_cage_belongs(const Cage& cage, const TargetSurface& target) {
  const SurfaceLevel level = build_surface_level(cage);
  const std::vector<Vec3> normals = limit_normals(level, cage.points);
  check_cage_belongs({level, cage.points, normals, cage.source}, target);
}

TurnedCage turn_parts_outside(const Cage& cage, const TargetSurface& target) {
  const SurfaceLevel level = build_surface_level(cage);
  const std::vector<Vec3> normals = limit_normals(level, cage.points);
  std::vector<SurfacePoint> nearest(cage.points.size());
  target.closest_points(cage.points, {}, nearest);
  TurnedCage result{cage, {}};
  for (const std::vector<Index>& part : connected_parts(level)) {
    double agreement = 0;
    std::vector<Index> vertices;
    for (const Index f : part) {
      const auto face = level.face_vertices[f];
      vertices.insert(vertices.end(), face.begin(), face.end());
    }
    std::sort(vertices.begin(), vertices.end());
    vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
    Index used = 0;
    for (const Index v : vertices) {
      if (nearest[v].status == FootStatus::failed || normals[v].isZero(0)) continue;
      agreement += normals[v].dot(nearest[v].normal);
      ++used;
    }
    if (used == 0 || agreement / used >= opposite || enclosed_volume(level, cage.points, part) >= 0) continue;
    reverse_faces(part, result.cage.faces);
    const Vec3& at = cage.points[vertices.front()];
    result.findings.push_back(
        {"inside_out",
         LintFinding::Severity::mended,
         fmt::format("{} turned inside out (mean cosine to the CAD's normals {:.2f} over {} "
                     "vertices, vertex {} at {}): its {} faces were reversed",
                     part.size() == static_cast<std::size_t>(level.face_count()) ? "the cage is"
                                                                                 : "a part of the cage is",
                     agreement / used, used, vertices.front() + 1, place(at), part.size()),
         "draw faces counter-clockwise seen from the fluid's side",
         {at}});
  }
  return result;
}

}  // namespace flowcage
