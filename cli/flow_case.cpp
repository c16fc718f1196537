#include "cli/flow_case.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "cli/mesh_outputs.hpp"
#include "core/base/error.hpp"
#include "core/grade/wall_units.hpp"

namespace flowcage {
namespace {

constexpr double air = 1.5e-5;  // m2/s, at 20 degrees

double viscosity_of(const Options& options) {
  if (options.viscosity) return *options.viscosity;
  if (options.reynolds && options.length) return options.speed * *options.length / *options.reynolds;
  return air;
}

/// Root of the largest inlet's area: of a duct its width, nearly.
double inlet_width(const BlockMesh& mesh) {
  double largest = 0;
  for (const BoundaryPatch& patch : mesh.patches()) {
    if (patch.type != PatchType::inlet) continue;
    double area = 0;
    for (const auto& q : patch.quads) {
      const auto p = mesh.points();
      area += (p[q[2]] - p[q[0]]).cross(p[q[3]] - p[q[1]]).norm() / 2;
    }
    largest = std::max(largest, area);
  }
  return std::sqrt(largest);
}

/// Mean over the walls' faces of the middle of each wall's first heights; 0 without walls.
double mean_first_height(const VolumeResult& result) {
  double sum = 0, faces = 0;
  for (const PatchSummary& patch : result.patches) {
    if (patch.type != PatchType::wall) continue;
    sum += patch.faces * (patch.min_first_height + patch.max_first_height) / 2;
    faces += patch.faces;
  }
  return faces > 0 ? sum / faces : 0;
}

}  // namespace

void check_flow_case(const Options& options) {
  const Options defaults;
  if (!options.flow_case) {
    const char* given = options.speed != defaults.speed           ? "--speed"
                        : options.direction != defaults.direction ? "--direction"
                        : options.viscosity                       ? "--viscosity"
                                                                  : nullptr;
    if (given == nullptr) return;
    throw Error(ErrorKind::usage, fmt::format("{} belongs to --case, which is missing", given),
                "give --case, or leave it out");
  }
  if (options.viscosity && options.reynolds) {
    throw Error(ErrorKind::usage, "--viscosity and --reynolds both say how viscous the fluid is",
                "leave one of them out");
  }
  if (options.unit != "m") {
    throw Error(ErrorKind::usage, fmt::format("--case needs a mesh in metres, not in {}", options.unit),
                "leave out --unit");
  }
  if (!MeshOutputs::has_foam_case(options.outputs)) {
    throw Error(ErrorKind::usage, "--case needs an OpenFOAM output", "give -o FOLDER or -o X.foam");
  }
}

Vec3 flow_direction(const Options& options) {
  return Vec3(options.direction[0], options.direction[1], options.direction[2]).normalized();
}

FoamFlow flow_of(const Options& options, const VolumeResult& result, double diagonal) {
  FoamFlow flow;
  flow.speed = options.speed;
  flow.direction = flow_direction(options);
  flow.viscosity = viscosity_of(options);
  flow.internal = options.flow == "internal";
  const double width = inlet_width(result.mesh);
  flow.length = options.length.value_or(flow.internal && width > 0 ? width : diagonal);
  flow.yplus = options.yplus;
  const double height = mean_first_height(result);
  if (!flow.yplus && height > 0) {
    const double reynolds = flow.speed * flow.length / flow.viscosity;
    flow.yplus = height / (flow.length * first_height_of_yplus(1, reynolds));
  }
  return flow;
}

}  // namespace flowcage
