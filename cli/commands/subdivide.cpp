#include <fmt/format.h>

#include <cmath>

#include "cli/commands/commands.hpp"
#include "core/base/atomic_file.hpp"
#include "core/cage/level_cage.hpp"
#include "core/cage/read_cage.hpp"
#include "core/cage/write_cage.hpp"
#include "core/export/file_text.hpp"
#include "core/limit/limit_stencils.hpp"
#include "core/subdivide/refine.hpp"

namespace flowcage {
namespace {

/// Quads of the last level must be counted by an Index and fit into memory.
void check_size(const Cage& cage, int levels) {
  constexpr double max_faces = 3e7;
  const double faces = static_cast<double>(cage.faces.values.size()) * std::pow(4.0, levels - 1);
  if (levels > 0 && faces > max_faces) {
    throw Error(ErrorKind::usage,
                fmt::format("--levels: {} levels of {} make {:.3g} faces", levels, cage.source, faces),
                fmt::format("ask for fewer levels: at most {:g} faces are made", max_faces));
  }
}

}  // namespace

int run_subdivide(const Options& options, Progress& progress) {
  std::vector<std::unique_ptr<AtomicFile>> outputs;
  if (!options.levels) throw Error(ErrorKind::usage, "subdivide: --levels is missing", "give --levels N");
  for (const std::string& name : options.outputs) {
    const std::string extension = lower_extension(name);
    if (!extension.empty() && extension != ".obj") {
      throw Error(ErrorKind::usage, fmt::format("-o: {}: subdivide writes OBJ files", name),
                  "give a name that ends in .obj");
    }
  }
  const Cage cage = read_cage(options.inputs.front());
  const int levels = *options.levels;
  check_size(cage, levels);
  for (const std::string& name : options.outputs) outputs.push_back(std::make_unique<AtomicFile>(name));

  SurfaceLevel level = build_surface_level(cage);
  std::vector<Vec3> points = cage.points;
  for (int depth = 0; depth < levels; ++depth) {
    progress.step(fmt::format("subdivide, level {}", depth + 1), 0);
    points = apply_stencils(refinement_stencils(level), points);
    level = build_child_level(level);
  }
  if (options.limit) {
    progress.step("limit points", 0);
    points = apply_stencils(limit_stencils(level), points);
    // Limit points are no control points: crease tags would ask for a second subdivision.
    std::fill(level.edge_sharpness.begin(), level.edge_sharpness.end(), 0.0);
    std::fill(level.vertex_sharpness.begin(), level.vertex_sharpness.end(), 0.0);
  }
  const Cage result = cage_of_level(level, std::move(points), cage.patch_names);
  for (const auto& output : outputs) {
    progress.step("write", 0);
    write_cage(result, output->stream());
  }
  for (const auto& output : outputs) output->commit();
  return 0;
}

}  // namespace flowcage
