#include "core/refit/cage_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "core/base/error.hpp"
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
  if (used > 0 && agreement / used < -0.3) {
    throw Error(
        ErrorKind::input,
        fmt::format("{}: the cage is turned inside out: its normals point against the CAD's (mean cosine "
                    "{:.2f} over {} vertices)",
                    named(cage.source), agreement / used, used),
        "reverse all faces of the cage: counter-clockwise seen from the fluid's side");
  }
}

void check_cage_belongs(const Cage& cage, const TargetSurface& target) {
  const SurfaceLevel level = build_surface_level(cage);
  const TangentStencils tangents = tangent_stencils(level);
  const std::vector<Vec3> u = apply_stencils(tangents.u, cage.points);
  const std::vector<Vec3> v = apply_stencils(tangents.v, cage.points);
  std::vector<Vec3> normals(u.size());
  for (std::size_t i = 0; i < u.size(); ++i) {
    const double norm = u[i].cross(v[i]).norm();
    normals[i] = norm > 0 ? Vec3(u[i].cross(v[i]) / norm) : Vec3::Zero();
  }
  check_cage_belongs({level, cage.points, normals, cage.source}, target);
}

}  // namespace flowcage
