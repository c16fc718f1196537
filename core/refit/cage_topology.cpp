#include "core/refit/cage_topology.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/base/error.hpp"
#include "core/mesh/manifold_check.hpp"

namespace flowcage {
namespace {

/// Numbers of the points after merging those within `reach`, along x so that only neighbours are compared.
std::vector<Index> merged_numbers(const std::vector<Vec3>& points, double reach) {
  std::vector<Index> by_x(points.size());
  std::iota(by_x.begin(), by_x.end(), 0);
  std::sort(by_x.begin(), by_x.end(),
            [&](Index a, Index b) { return std::pair(points[a].x(), a) < std::pair(points[b].x(), b); });
  std::vector<Index> number(points.size(), no_index);
  for (std::size_t i = 0; i < by_x.size(); ++i) {
    const Index a = by_x[i];
    if (number[a] == no_index) number[a] = a;
    for (std::size_t k = i + 1; k < by_x.size() && points[by_x[k]].x() - points[a].x() <= reach; ++k) {
      const Index b = by_x[k];
      if (number[b] == no_index && (points[a] - points[b]).norm() <= reach) number[b] = number[a];
    }
  }
  return number;
}

/// Somewhere on the open boundary of a cage: the middle of its first open edge.
Vec3 place_on_boundary(const SurfaceLevel& level, const Cage& cage) {
  for (Index e = 0; e < level.edge_count(); ++e) {
    if (!level.is_boundary_edge(e)) continue;
    return 0.5 * (cage.points[level.edge_vertices[e][0]] + cage.points[level.edge_vertices[e][1]]);
  }
  return Vec3::Zero();
}

}  // namespace

std::optional<Topology> target_topology(const TargetSurface& target) {
  const Tessellation& mesh = target.tessellation();
  const std::vector<Index> merged = merged_numbers(mesh.points, 1e-7 * target.diagonal());
  Cage surface;
  std::vector<Index> number(mesh.points.size(), no_index);
  for (const auto& triangle : mesh.triangles) {
    std::array<Index, 3> corners{};
    for (int i = 0; i < 3; ++i) corners[i] = merged[triangle[i]];
    if (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0]) continue;
    for (Index& corner : corners) {
      Index& n = number[corner];
      if (n == no_index) {
        n = static_cast<Index>(surface.points.size());
        surface.points.push_back(mesh.points[corner]);
      }
      corner = n;
    }
    surface.faces.push_row(corners);
  }
  if (surface.faces.size() == 0 || find_manifold_defect(surface)) return std::nullopt;
  return topology_of(build_surface_level(surface));
}

LintReport lint_cage_topology(const Cage& cage, const TargetSurface& target) {
  const std::optional<Topology> cad = target_topology(target);
  if (!cad) return {};
  const SurfaceLevel level = build_surface_level(cage);
  const Topology own = topology_of(level);
  LintReport report;
  const auto warn = [&](std::string message, std::string remedy, const Vec3& at) {
    report.push_back(
        {"open_boundary", LintFinding::Severity::warning, std::move(message), std::move(remedy), {at}});
  };
  if (cad->boundary_loops == 0 && own.boundary_loops > 0) {
    const Vec3 at = place_on_boundary(level, cage);
    warn(fmt::format("the cage has {} open boundar{} (near {}), but the CAD is closed", own.boundary_loops,
                     own.boundary_loops > 1 ? "ies" : "y", place(at)),
         "close the cage there, or give the CAD cut in the symmetry plane", at);
  }
  if (cad->boundary_loops > 0 && own.boundary_loops == 0) {
    for (const FeatureChain& chain : target.features().chains) {
      if (chain.kind != ChainKind::boundary) continue;
      const Vec3& at = chain.polyline.front();
      warn(fmt::format(
               "the CAD is open (near {}), but the cage is closed: its faces there have nothing to follow",
               place(at)),
           "leave out the cage's faces over the opening, or close the CAD", at);
      break;
    }
  }
  const bool comparable =
      cad->components == 1 && own.components == 1 && (cad->boundary_loops == 0) == (own.boundary_loops == 0);
  if (comparable && cad->genus != own.genus) {
    const auto numbers = [](const Topology& t) {
      return fmt::format("genus {} (V - E + F = {}, {} open boundaries)", t.genus, t.euler, t.boundary_loops);
    };
    throw input_error(
        cage.source.empty() ? "the cage" : cage.source, 0,
        fmt::format("the cage has {}, the CAD {}: their surfaces cannot be laid on one another", numbers(own),
                    numbers(*cad)),
        own.genus < cad->genus
            ? "draw the holes that go through the body (each adds 1 to the genus), or close them in the CAD"
            : "close the holes of the cage that the CAD does not have (each adds 1 to the genus)");
  }
  return report;
}

}  // namespace flowcage
