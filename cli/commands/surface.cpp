#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <optional>

#include "cli/cad_json.hpp"
#include "cli/commands/commands.hpp"
#include "cli/fit_job.hpp"
#include "cli/report/fit_report.hpp"
#include "cli/summary.hpp"
#include "cli/terminal.hpp"
#include "core/base/atomic_file.hpp"
#include "core/cage/read_cage.hpp"
#include "core/cage/write_cage.hpp"
#include "core/export/file_text.hpp"
#include "core/export/write_surface.hpp"
#include "occ_bridge/write_step.hpp"

namespace flowcage {
namespace {

constexpr int most_levels = 5;

std::string format_of(const std::string& name) {
  const std::string extension = lower_extension(name);
  if (extension == ".obj" || extension == ".vtp" || extension == ".stl") return extension;
  if (extension == ".step" || extension == ".stp") return ".step";
  throw Error(ErrorKind::usage, fmt::format("-o: {}: unknown surface format", name),
              "give a name that ends in .obj, .vtp, .stl or .step");
}

void write_surface(const std::string& format, const Cage& mesh, const std::vector<double>& deviation,
                   std::ostream& out, Progress& progress) {
  if (format == ".obj") return write_cage(mesh, out);
  if (format == ".stl") return write_stl(out, mesh);
  const std::vector<float> values(deviation.begin(), deviation.end());
  for (const std::string& note : write_vtp(out, mesh, {{"deviation", values}})) progress.warn(note);
}

/// The fitted surface as B-spline patches, with a warning where they miss what a CAD system expects.
PatchSurface fitted_patches(const SurfaceFit& fit, Progress& progress) {
  const FittedLevel& last = fit.levels.back();
  PatchSurface patches = make_bicubic_patches(last.topology, last.control_points, {}, progress);
  constexpr double smooth_degrees = 0.1;
  if (patches.max_angle_degrees > smooth_degrees) {
    progress.warn(
        fmt::format("B-spline patches meet at an angle of {:.3g} degrees near {}, where the cage has "
                    "no crease: a vertex of the cage with many or sharp edges is there",
                    patches.max_angle_degrees, place(patches.worst_angle_place)));
  }
  return patches;
}

}  // namespace

int run_surface(const Options& options, Progress& terminal) {
  using Clock = std::chrono::steady_clock;
  const auto seconds_since = [](Clock::time_point t) {
    return std::chrono::duration<double>(Clock::now() - t).count();
  };
  const Clock::time_point start = Clock::now();
  RecordedWarnings progress(terminal);
  std::vector<std::string> formats;
  for (const std::string& name : options.outputs) formats.push_back(format_of(name));
  const bool as_step = std::find(formats.begin(), formats.end(), ".step") != formats.end();
  if (as_step && options.sample > 0) {
    progress.warn("--sample does not apply to STEP: B-spline patches are the limit surface itself");
  }
  if (options.cage == "auto") {
    throw Error(
        ErrorKind::usage, "--cage is missing",
        "draw a cage (docs/cages.md), or let `flowcage cage` propose one, and give it with --cage FILE");
  }
  if (is_block_file(options.cage)) {
    throw Error(ErrorKind::usage,
                fmt::format("--cage {}: surface fits a polyhedron, and this names blocks", options.cage),
                "give an OBJ file; `flowcage mesh` takes blocks");
  }
  const FitInputs inputs = read_fit_inputs(options, progress);
  // Opened before the long work: a place that cannot be written shows now.
  std::vector<std::unique_ptr<AtomicFile>> outputs;
  for (const std::string& name : options.outputs) outputs.push_back(std::make_unique<AtomicFile>(name));
  const std::unique_ptr<AtomicFile> json_file = open_json(options);
  FitReport fit_report(options);

  const Clock::time_point fit_start = Clock::now();
  SurfaceSettings settings;
  settings.fit = fit_settings(options, inputs, most_levels);
  settings.tolerance = options.tolerance;
  settings.snap = options.snap;
  settings.sample = options.sample;
  SurfaceResult result = make_surface(inputs.cage, inputs.cad, settings, progress);
  const double fit_seconds = seconds_since(fit_start);

  const Clock::time_point write_start = Clock::now();
  const bool write = options.force || all_hold(result.gates);
  std::optional<Scene> scene;  // before the mesh is scaled
  if (fit_report.wanted()) scene = surface_scene(inputs.cad, result, options.tolerance);
  std::optional<PatchSurface> patches;
  if (write && as_step) patches = fitted_patches(result.fit, progress);
  if (write) {
    const double scale = 1 / metres_per_unit(options.unit);
    const Cage mesh = scale_cage(std::move(result.mesh), scale);
    for (double& d : result.deviation) d *= scale;
    for (std::size_t i = 0; i < outputs.size(); ++i) {
      progress.step("write", static_cast<double>(i) / static_cast<double>(outputs.size()));
      if (formats[i] == ".step") {
        write_step(*patches, mesh.patch_names,
                   {outputs[i]->path().string(), options.outputs[i], options.unit});
      } else {
        write_surface(formats[i], mesh, result.deviation, outputs[i]->stream(), progress);
      }
    }
  }
  Json json = new_report();
  json["cad"] = cad_json(inputs.cad.summary());
  json["cage"] = cage_json(inputs, inputs.cage, options);
  json["surface"] = surface_json(result.fit);
  if (patches) json["surface"]["step"] = step_json(*patches, inputs.cad.diagonal());
  json["gates"] = gates_json(result.gates);
  if (scene) {
    fit_report.write(
        {.command = "surface", .options = options, .warnings = progress.messages(), .facts = json}, *scene,
        result.gates, progress);
  }
  if (json_file) {
    json["seconds"] = {{"read", inputs.read_seconds},
                       {"cage", 0.0},
                       {"fit", fit_seconds},
                       {"volume", 0.0},
                       {"write", seconds_since(write_start)},
                       {"total", seconds_since(start)}};
    json["peak_memory_bytes"] = peak_memory_bytes();
    write_json(json, *json_file);
  }
  // All were written: only now any of them appears.
  if (write) {
    for (const auto& output : outputs) output->commit();
  }
  if (json_file) json_file->commit();
  fit_report.commit();
  if (!options.quiet) {
    print_summary(surface_summary(result.fit, inputs.cad.diagonal()));
    if (patches) print_summary(patches_summary(*patches, inputs.cad.diagonal()));
  }
  require_gates(result.gates);
  return 0;
}

}  // namespace flowcage
