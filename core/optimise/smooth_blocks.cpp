#include "core/optimise/smooth_blocks.hpp"

namespace flowcage {
namespace {

/// Coordinates of a point on the box that its sides hold.
std::uint8_t box_axes(const OuterShape& box, const Vec3& p) {
  const Vec3 d = (p - box.centre).cwiseAbs();
  unsigned axes = 0;
  for (unsigned a = 0; a < 3; ++a) {
    if (d[a] >= box.radius * (1 - 1e-9)) axes |= 1U << a;
  }
  return static_cast<std::uint8_t>(axes);
}

}  // namespace

BoundaryFreedom shell_freedom(const BlockMesh& mesh, const Shell& shell) {
  BoundaryFreedom out;
  std::vector<PointFreedom> per_patch(mesh.patches().size(), fixed_point);
  const auto& shape = shell.outer_shape;
  const bool round = shape && shape->kind != OuterShape::Kind::box;
  // Cells that cross an edge of the box lose it when they move.
  const bool box = shape && !round && shell.box_edges_sharp && shape->axes == Eigen::Matrix3d::Identity();
  for (std::size_t p = 0; p < per_patch.size(); ++p) {
    const PatchType type = mesh.patches()[p].type;
    if (type == PatchType::symmetry && shell.symmetry && shell.symmetry->axis != no_index) {
      per_patch[p] = in_plane(shell.symmetry->axis);
    }
    if (type == PatchType::farfield && round) per_patch[p] = on_surface(0);
    if (type == PatchType::farfield && box) per_patch[p] = {};
  }
  out.points = patch_freedom(mesh, per_patch);
  if (round) {
    out.projectors.push_back([shape = *shape](std::span<const Vec3> queries, std::span<Vec3> feet) {
      for (std::size_t i = 0; i < queries.size(); ++i) feet[i] = shape.project(queries[i]);
    });
  }
  if (!box) return out;
  for (const BoundaryPatch& patch : mesh.patches()) {
    if (patch.type != PatchType::farfield) continue;
    for (const auto& quad : patch.quads) {
      for (const Index p : quad) {
        out.points[p].frozen_axes |= box_axes(*shape, mesh.points()[p]);
      }
    }
  }
  return out;
}

BoundaryFreedom planar_freedom(const HexView& mesh) {
  BoundaryFreedom out;
  out.points.resize(mesh.points().size());
  for (const BoundaryPatch& patch : mesh.patches()) {
    for (const auto& quad : patch.quads) {
      unsigned axes = 0;
      for (unsigned a = 0; a < 3 && patch.type != PatchType::wall; ++a) {
        const double at = mesh.points()[quad[0]][a];
        const bool flat =
            std::all_of(quad.begin(), quad.end(), [&](Index p) { return mesh.points()[p][a] == at; });
        if (flat) axes |= 1U << a;
      }
      if (axes == 0) axes = PointFreedom::all_axes;
      for (const Index p : quad) out.points[p].frozen_axes |= static_cast<std::uint8_t>(axes);
    }
  }
  return out;
}

void smooth_blocks(BlockMesh& mesh, BoundaryFreedom freedom, Progress& progress) {
  UntangleSettings settings;
  settings.freedom = std::move(freedom.points);
  settings.projectors = std::move(freedom.projectors);
  mesh.mutable_points() = untangle(mesh, settings, progress).points;
}

CellProof mend_blocks(BlockMesh& mesh, const std::function<BoundaryFreedom()>& freedom, Progress& progress) {
  const CellProof proof = prove_cells(mesh);
  if (proof.all_sound()) return proof;
  BoundaryFreedom given = freedom();
  RepairSettings settings;
  settings.threshold = 0.02;  // a sharp trailing edge alone leaves a tenth: nothing that could be mended
  settings.optimise.freedom = std::move(given.points);
  settings.optimise.projectors = std::move(given.projectors);
  const UntangledPoints mended = repair_cells(mesh, settings, progress);
  mesh.mutable_points() = mended.points;
  return {mended.report.after.inverted, mended.report.after.uncertified};
}

}  // namespace flowcage
