#include <fmt/format.h>

#include <cmath>
#include <memory>

#include "cli/cad_json.hpp"
#include "cli/check_prediction.hpp"
#include "cli/commands/commands.hpp"
#include "cli/curved_job.hpp"
#include "cli/family_outputs.hpp"
#include "cli/fit_job.hpp"
#include "cli/flow_case.hpp"
#include "cli/mesh_outputs.hpp"
#include "cli/report/fit_report.hpp"
#include "cli/summary.hpp"
#include "cli/terminal.hpp"
#include "core/base/stopwatch.hpp"
#include "core/blocks/symmetry_plane.hpp"
#include "core/grade/wall_units.hpp"
#include "core/mesh/opening_names.hpp"

namespace flowcage {
namespace {

constexpr int most_levels = 4;

/// The cage's open boundary already says where the half model is cut; --symmetry must say the same.
void check_symmetry(const Options& options, const Cage& cage) {
  if (!options.symmetry) return;
  const char axis = "xyz"[options.symmetry->axis];
  const double value = options.symmetry->value * metres_per_unit(options.unit);
  const std::optional<SymmetryPlane> plane =
      find_symmetry_plane(build_surface_level(cage), cage.points, cage.source);
  if (!plane) {
    throw input_error(cage.source, 0,
                      fmt::format("the cage is closed, but --symmetry asks for a half model cut at {}", axis),
                      "leave out the cage's faces in that plane, or --symmetry");
  }
  Box3 box;
  for (const Vec3& p : cage.points) box.extend(p);
  const double own =
      plane->axis == options.symmetry->axis ? plane->normal[plane->axis] * plane->offset : std::nan("");
  if (!(std::abs(own - value) <= 1e-4 * box.diagonal().norm())) {
    throw input_error(
        cage.source, 0,
        fmt::format(
            "the cage is open in the plane with normal {} at {:.6g} m, but --symmetry says {} = {:.6g} m",
            place(plane->normal), plane->offset, axis, value),
        "draw the open boundary in the symmetry plane, or correct --symmetry");
  }
}

/// A cage and the routes that make their own exclude each other.
void check_route(const Options& options) {
  const bool drawn = options.cage != "auto";
  const bool file = drawn && is_block_file(options.cage);
  if (file && (options.blocks != "auto" || !options.outer.empty() || options.farfield != "box")) {
    throw Error(ErrorKind::usage,
                fmt::format("--cage {} gives all of the blocks, the outer boundary included", options.cage),
                "leave out --blocks, --outer and --farfield");
  }
  if (!drawn && (options.blocks == "shell" || !options.outer.empty())) {
    throw Error(
        ErrorKind::usage, "a shell of blocks needs a cage, and --cage is missing",
        "draw a cage (docs/cages.md) and give it with --cage FILE, or leave out --blocks shell and --outer");
  }
  const bool internal = options.flow == "internal";
  if (internal && !file && (drawn || options.blocks == "swept" || options.blocks == "shell")) {
    throw Error(ErrorKind::usage, "--flow internal: blocks inside of the CAD are ambient ones",
                "leave out --cage and --blocks");
  }
  if (!drawn && options.farfield != "box") {
    throw Error(ErrorKind::usage,
                fmt::format("--farfield {} goes with a cage; automatic blocks have a box", options.farfield),
                "leave out --farfield, or give --cage FILE");
  }
  if (drawn && (options.blocks == "swept" || options.blocks == "ambient")) {
    throw Error(ErrorKind::usage,
                fmt::format("--cage {} is for a shell of blocks round the body", options.cage),
                "leave out --cage or --blocks");
  }
}

/// The blocks that were asked for. Without a cage, a body that is a swept one gets C-H blocks, any other the
/// ambient grid.
std::unique_ptr<BlockSource> block_source(const Options& options, const FitInputs& inputs,
                                          Progress& progress) {
  if (inputs.drawn) {
    std::optional<Cage> outer;
    if (!options.outer.empty()) outer = read_cage_in_metres(options.outer, inputs.cage_unit);
    FarField farfield;
    farfield.kind = options.farfield == "sphere"   ? OuterShape::Kind::sphere
                    : options.farfield == "bullet" ? OuterShape::Kind::bullet
                                                   : OuterShape::Kind::box;
    farfield.body_lengths = options.farfield_size;
    return shell_source(inputs.cage, outer ? &*outer : nullptr, farfield, inputs.cad.bounds());
  }
  const bool internal = options.flow == "internal";
  if (inputs.blocks) return drawn_source(*inputs.blocks, inputs.cad, internal, options.cage, progress);
  const std::string& name = options.inputs.front();
  if (options.blocks != "ambient" && !internal) {
    progress.step("blocks", 0);
    try {
      return swept_source(inputs.cad, {options.farfield_size}, name);
    } catch (const Error& e) {
      if (options.blocks == "swept" || e.kind() != ErrorKind::input) throw;
      progress.step(fmt::format("no swept body ({}): ambient blocks", e.what()), 0);
    }
  }
  return ambient_source(inputs.cad, ambient_settings(options), name, progress);
}

/// --yplus, --reynolds and --length as the first height that they ask for.
Options with_first_height(Options options) {
  if (!options.yplus) {
    if ((!options.reynolds && !options.length) || options.flow_case) return options;
    throw Error(ErrorKind::usage, "--reynolds and --length belong to --yplus, which is missing",
                "give --yplus, --reynolds and --length, or --first-height");
  }
  if (options.first_height) {
    throw Error(ErrorKind::usage, "--yplus and --first-height both ask for a wall spacing",
                "leave one of them out");
  }
  if (!options.reynolds || !options.length) {
    throw Error(ErrorKind::usage,
                fmt::format("--yplus needs {}", options.reynolds ? "--length" : "--reynolds and --length"),
                "give the Reynolds number of the flow and the length that it is made with");
  }
  options.first_height = *options.length * first_height_of_yplus(*options.yplus, *options.reynolds);
  return options;
}

VolumeSettings volume_settings(const Options& options, const FitInputs& inputs) {
  VolumeSettings settings;
  settings.fit = fit_settings(options, inputs, most_levels);
  settings.tolerance = options.tolerance;
  settings.snap = options.snap;
  if (options.first_height) {
    settings.layers.first_height = *options.first_height * metres_per_unit(options.unit);
    // Below, points of neighbouring layers would coincide in double precision.
    const double least = 1e-11 * inputs.cad.diagonal();
    if (settings.layers.first_height < least) {
      throw Error(
          ErrorKind::usage,
          fmt::format("--first-height: {:g} {} is too small for a CAD of {:.3g} m", *options.first_height,
                      options.unit, inputs.cad.diagonal()),
          fmt::format("give at least {:.3g} {}", least / metres_per_unit(options.unit), options.unit));
    }
  }
  if (options.growth) settings.layers.growth = *options.growth;
  if (options.layers) settings.layers.layers = *options.layers;
  settings.cells = options.cells.value_or(0);
  settings.family = options.family;
  return settings;
}

Json report(const Options& options, const FitInputs& inputs, const BlockSource& source,
            const VolumeResult& result) {
  const double scale = 1 / metres_per_unit(options.unit);
  Json json = new_report();
  json["cad"] = cad_json(inputs.cad.summary());
  json["cage"] = cage_json(inputs, source.cage(), options);
  json["blocks"] = {{"route", source.name()}, {"count", source.blocks().complex->hexes.size()}};
  json["surface"] = surface_json(result.fit);
  json["volume"] = volume_json(result.quality);
  json["volume"]["first_height"] = {{"min", result.layers.min_height * scale},
                                    {"max", result.layers.max_height * scale},
                                    {"asked", options.first_height.value_or(0)}};
  json["volume"]["max_growth"] = result.layers.max_growth;
  if (!result.coarser.empty()) {  // coarsest first, as the files are numbered
    json["family"] = Json::array();
    for (auto member = result.coarser.rbegin(); member != result.coarser.rend(); ++member) {
      json["family"].push_back(volume_json(member->quality));
    }
    json["family"].push_back(volume_json(result.quality));
  }
  json["patches"] = Json::array();
  for (const PatchSummary& p : result.patches) {
    Json patch{{"name", p.name}, {"type", patch_type_name(p.type)}, {"faces", p.faces}};
    if (p.type == PatchType::wall) {
      patch["max_deviation"] = p.max_deviation;
      patch["rms_deviation"] = p.rms_deviation;
      patch["first_height"] = {{"min", p.min_first_height * scale}, {"max", p.max_first_height * scale}};
    }
    json["patches"].push_back(patch);
  }
  json["gates"] = gates_json(result.gates);
  return json;
}

/// A height that the lines have no room for is made smaller; the user must learn of it.
void warn_of_first_height(const Options& options, const LayerReport& layers, Progress& progress) {
  if (!options.first_height) return;
  const double asked = *options.first_height, unit = metres_per_unit(options.unit);
  const double low = layers.min_height / unit, high = layers.max_height / unit;
  if (low > 0.99 * asked && high < 1.01 * asked) return;
  progress.warn(
      fmt::format("--first-height: {:g} {} was asked for, the cells at the wall are {:.4g} to {:.4g} {} high",
                  asked, options.unit, low, high, options.unit));
}

/// Scales a mesh, and its curved cells where there are any, to the unit of the output and writes it.
void write_in_unit(BlockMesh& mesh, std::vector<double>& deviation, const Options& options,
                   MeshOutputs& outputs, Progress& progress, CurvedMesh* curved = nullptr) {
  const double scale = 1 / metres_per_unit(options.unit);
  if (scale != 1) {
    for (Vec3& p : mesh.mutable_points()) p *= scale;
    for (double& d : deviation) d *= scale;
    if (curved != nullptr) {
      for (Vec3& p : curved->nodes.mutable_points()) p *= scale;
    }
  }
  outputs.write(mesh, deviation, progress, curved);
}

}  // namespace

int run_mesh(const Options& given, Progress& terminal) {
  const Stopwatch whole;
  const Options options = with_first_height(given);
  RecordedWarnings progress(terminal);
  MeshOutputs::check_formats(options.outputs);
  check_flow_case(options);
  check_order(options);
  check_route(options);
  const FitInputs inputs = read_fit_inputs(options, progress);
  if (inputs.drawn) check_symmetry(options, inputs.cage);
  VolumeSettings settings = volume_settings(options, inputs);
  Prediction prediction;
  settings.predicted = [&](const Prediction& found) {
    prediction = found;
    check_prediction(found, options);
  };
  const std::unique_ptr<BlockSource> source = block_source(options, inputs, progress);
  std::vector<MeshOutputs> outputs;  // of the family's meshes, coarsest first
  for (const std::vector<std::string>& names : family_outputs(options)) {
    Options member = options;
    member.outputs = names;
    outputs.emplace_back(member);
  }
  const std::unique_ptr<AtomicFile> json_file = open_json(options);
  FitReport fit_report(options);
  if (options.flow_case) {  // what no flow can start on is refused before the work
    FoamFlow flow;
    flow.direction = flow_direction(options);
    BlockMesh blocks(source->blocks().complex);
    name_openings(blocks);
    foam_case_files(blocks, flow);
  }

  VolumeResult result = make_volume(*source, inputs.cad, settings, progress);
  std::optional<CurvedJob> curved;
  if (options.order > 1) curved = make_curved(result, inputs.cad, options.order, progress);
  warn_of_first_height(options, result.layers, progress);
  const Stopwatch writing;
  const bool write = options.force || all_hold(result.gates);
  std::optional<Scene> scene;  // before the mesh is scaled
  if (fit_report.wanted()) scene = volume_scene(inputs.cad, result, options.tolerance);
  if (write) {
    if (options.flow_case) {
      const FoamFlow flow = flow_of(options, result, inputs.cad.diagonal());
      for (MeshOutputs& member : outputs) member.set_flow(flow);
    }
    write_in_unit(result.mesh, result.deviation, options, outputs.back(), progress,
                  curved ? &curved->mesh : nullptr);
    for (std::size_t n = 0; n < result.coarser.size(); ++n) {
      FamilyMember& member = result.coarser[n];
      write_in_unit(member.mesh, member.deviation, options, outputs[outputs.size() - 2 - n], progress);
    }
  }
  Json json = report(options, inputs, *source, result);
  json["prediction"] = prediction_json(prediction, options);
  if (curved) json["curved"] = curved_json(*curved, inputs.cad.diagonal());
  if (scene) {
    fit_report.write({.command = "mesh", .options = options, .warnings = progress.messages(), .facts = json},
                     *scene, result.gates, progress);
  }
  if (json_file) {
    json["seconds"] = {{"read", inputs.read_seconds}, {"cage", 0.0},
                       {"fit", result.fit_seconds},   {"volume", result.volume_seconds},
                       {"write", writing.seconds()},  {"total", whole.seconds()}};
    json["peak_memory_bytes"] = peak_memory_bytes();
    write_json(json, *json_file);
  }
  if (write) {
    for (MeshOutputs& member : outputs) member.commit();
  }
  if (json_file) json_file->commit();
  fit_report.commit();
  if (!options.quiet) print_summary(volume_summary(result, inputs.cad.diagonal(), options));
  require_gates(result.gates);
  return 0;
}

}  // namespace flowcage
