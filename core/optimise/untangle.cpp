#include "core/optimise/untangle.hpp"

#include <fmt/format.h>

#include "core/base/parallel.hpp"
#include "core/mesh/visit_cells.hpp"
#include "core/optimise/hex_patch.hpp"
#include "core/optimise/jacobian_bound.hpp"
#include "core/optimise/patch_optimiser.hpp"

namespace flowcage {
namespace {

std::vector<HexPoints> all_cells(const HexView& mesh) {
  std::vector<HexPoints> cells(static_cast<std::size_t>(mesh.cell_count()));
  mesh.read_cells(0, cells);
  return cells;
}

/// The power of two next to the size of the mesh: dividing by it is exact.
double unit_of(std::span<const Vec3> points) {
  double largest = 0;
  for (const Vec3& p : points) largest = std::max(largest, p.cwiseAbs().maxCoeff());
  int exponent = 0;
  std::frexp(largest, &exponent);
  return largest > 0 ? std::ldexp(1.0, std::clamp(exponent, -1000, 1000)) : 1.0;
}

void check_input(const HexView& mesh, const UntangleSettings& settings) {
  const std::span<const Vec3> points = mesh.points();
  for (std::size_t p = 0; p < points.size(); ++p) {
    if (points[p].allFinite()) continue;
    throw Error(ErrorKind::input, fmt::format("point {} of the mesh has a coordinate that is not finite", p),
                "correct the mesh");
  }
  if (!settings.freedom.empty() && settings.freedom.size() != points.size()) {
    throw Error(ErrorKind::input,
                fmt::format("freedom has {} entries for {} points", settings.freedom.size(), points.size()),
                "give one for each point, or none");
  }
  for (const PointFreedom& freedom : settings.freedom) {
    if (freedom.projector >= static_cast<Index>(settings.projectors.size())) {
      throw Error(
          ErrorKind::input,
          fmt::format("a point slides on projector {} of {}", freedom.projector, settings.projectors.size()),
          "give every projector that freedom numbers");
    }
  }
}

Vec3 centre_of(const HexCornerPoints& p) {
  Vec3 centre = Vec3::Zero();
  for (const Vec3& corner : p) centre += corner / 8;
  return centre;
}

std::vector<LocatedCell> find_inverted(std::span<const HexPoints> cells, std::span<const Vec3> points) {
  std::vector<LocatedCell> out;
  for (std::size_t n = 0; n < cells.size(); ++n) {
    const HexCornerPoints p = corner_points(points, cells[n]);
    const double value = min_scaled_jacobian(p);
    if (value > 0) continue;
    out.push_back({static_cast<Offset>(n), centre_of(p), value});
  }
  return out;
}

UntangledPoints optimise(const HexView& mesh, std::span<const HexPoints> cells,
                         std::span<const HexPatch> patches, const UntangleSettings& settings,
                         Progress& progress) {
  UntangledPoints out;
  out.points.assign(mesh.points().begin(), mesh.points().end());
  out.report.before = measure_validity(cells, out.points);
  const double unit = unit_of(out.points);
  WorkBudget budget;
  budget.cell_evaluations = settings.max_cell_evaluations;
  if (settings.max_seconds > 0) {
    budget.end = std::chrono::steady_clock::now() + std::chrono::duration_cast<std::chrono::nanoseconds>(
                                                        std::chrono::duration<double>(settings.max_seconds));
  }
  for (const HexPatch& patch : patches) {
    PatchInput input{patch, {}, unit};
    for (const Index p : patch.point_of) input.positions.push_back(out.points[p] / unit);
    PatchOutcome outcome = optimise_patch(input, settings, budget, progress);
    for (const Index m : patch.moving) {
      Vec3& point = out.points[patch.point_of[m]];
      for (int a = 0; a < 3; ++a) {
        if ((patch.freedom[m].frozen_axes >> a & 1) == 0) point[a] = unit * outcome.positions[m][a];
      }
    }
    out.report.passes += outcome.passes;
    out.report.iterations += outcome.iterations;
    out.report.evaluations += outcome.evaluations;
    out.report.moving_points += static_cast<Index>(patch.moving.size());
    out.report.optimised_cells += static_cast<Offset>(patch.cells.size());
    ++out.report.patches;
  }
  out.report.limit_reached = budget.reached;
  out.report.after = measure_validity(cells, out.points);
  if (out.report.after.inverted > 0) out.report.inverted = find_inverted(cells, out.points);
  return out;
}

std::vector<PointFreedom> freedom_of(const HexView& mesh, const UntangleSettings& settings) {
  return settings.freedom.empty() ? patch_freedom(mesh, {}) : settings.freedom;
}

}  // namespace

UntangledPoints untangle(const HexView& mesh, const UntangleSettings& settings, Progress& progress) {
  check_input(mesh, settings);
  const std::vector<HexPoints> cells = all_cells(mesh);
  return optimise(mesh, cells, whole_mesh_patches(cells, freedom_of(mesh, settings)), settings, progress);
}

UntangledPoints repair_cells(const HexView& mesh, const RepairSettings& settings, Progress& progress) {
  check_input(mesh, settings.optimise);
  const std::vector<HexPoints> cells = all_cells(mesh);
  std::vector<std::uint8_t> bad(cells.size());
  parallel_for(mesh.cell_count(), 4096, [&](Offset begin, Offset end) {
    for (Offset n = begin; n < end; ++n) {
      const HexCornerPoints p = corner_points(mesh.points(), cells[n]);
      const bool good =
          min_scaled_jacobian(p) >= settings.threshold && jacobian_sign(p) == JacobianSign::positive;
      bad[n] = good ? 0 : 1;
    }
  });
  const std::vector<HexPatch> patches =
      patches_round(cells, freedom_of(mesh, settings.optimise), bad, settings.rings);
  return optimise(mesh, cells, patches, settings.optimise, progress);
}

std::vector<LocatedCell> unproved_cells(const HexView& mesh, Offset most) {
  std::vector<LocatedCell> out;
  visit_cells(mesh, 0, mesh.cell_count(), [&](Offset n, const HexPoints& cell) {
    if (static_cast<Offset>(out.size()) >= most) return;
    const HexCornerPoints p = corner_points(mesh.points(), cell);
    const double value = min_scaled_jacobian(p);
    if (value > 0 && jacobian_sign(p) != JacobianSign::positive) out.push_back({n, centre_of(p), value});
  });
  return out;
}

HexValidity hex_validity(const HexView& mesh) {
  return measure_validity(all_cells(mesh), mesh.points());
}

}  // namespace flowcage
