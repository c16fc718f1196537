#include "cli/curved_job.hpp"

#include <fmt/format.h>

#include "cli/mesh_outputs.hpp"
#include "core/base/error.hpp"

namespace flowcage {
namespace {

constexpr double node_tolerance = 1e-6;  // of the diagonal: as near as sewn CAD is to itself

}  // namespace

void check_order(const Options& options) {
  if (options.order == 1) return;
  if (options.family > 1) {
    throw Error(ErrorKind::usage, "--order makes curved cells of one mesh, --family makes several",
                "leave one of the two out");
  }
  if (!options.snap) {
    throw Error(ErrorKind::usage, "--order puts wall nodes on the CAD, --no-snap leaves the vertices off it",
                "leave one of them out");
  }
  for (const std::string& name : options.outputs) {
    if (MeshOutputs::holds_curved(name)) continue;
    throw Error(ErrorKind::usage,
                fmt::format("--order {}: the format of {} has linear cells", options.order, name),
                "give X.vtu, X.msh or X.cgns");
  }
}

CurvedJob make_curved(VolumeResult& result, const TargetSurface& target, int order, Progress& progress) {
  CurveReport report;
  CurvedMesh mesh = make_curved_mesh(result.mesh, target, order, report, progress);
  progress.step("curved cells", 0);
  const CurvedValidity validity = measure_curved_validity(mesh);

  const double distance = report.max_wall_distance / target.diagonal();
  Gate nodes{"curved_wall_nodes", node_tolerance, distance, distance <= node_tolerance, "",
             report.worst_place};
  nodes.detail = fmt::format("a node of the walls is {:.3g} m from the CAD, near {}",
                             report.max_wall_distance, place(report.worst_place));
  result.gates.push_back(nodes);
  const Offset bad = validity.not_positive + validity.undecided;
  Gate cells{"curved_cells", 0, static_cast<double>(bad), bad == 0, "", validity.worst_place};
  cells.detail = fmt::format(
      "{} curved cells are inverted somewhere inside and {} are not proved valid; the worst is "
      "cell {} near {}: use more levels, or a lower --order",
      validity.not_positive, validity.undecided, validity.worst_cell, place(validity.worst_place));
  result.gates.push_back(cells);
  return {std::move(mesh), report, validity};
}

Json curved_json(const CurvedJob& job, double diagonal) {
  return {{"order", job.mesh.order},
          {"nodes", job.mesh.nodes.points().size()},
          {"max_wall_distance", job.report.max_wall_distance / diagonal},
          {"max_correction", job.report.max_correction / diagonal},
          {"straightened_cells", job.report.straightened},
          {"not_positive_cells", job.validity.not_positive},
          {"undecided_cells", job.validity.undecided},
          {"min_jacobian_ratio", job.validity.min_ratio}};
}

}  // namespace flowcage
