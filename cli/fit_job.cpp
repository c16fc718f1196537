#include "cli/fit_job.hpp"

#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <filesystem>
#include <set>

#include "core/cage/read_cage.hpp"
#include "core/export/file_text.hpp"
#include "core/export/read_block_dict.hpp"
#include "core/export/read_mesh.hpp"
#include "core/mesh/surface_level.hpp"

namespace flowcage {

namespace {

HexMesh scaled(const HexMesh& mesh, double unit) {
  std::vector<Vec3> points(mesh.points().begin(), mesh.points().end());
  for (Vec3& p : points) p *= unit;
  std::vector<HexPoints> cells(static_cast<std::size_t>(mesh.cell_count()));
  mesh.read_cells(0, cells);
  return {std::move(points), std::move(cells), mesh.patches()};
}

bool is_block_dict(const std::string& name) {
  return std::filesystem::path(name).filename() == "blockMeshDict";
}

/// The blocks of a file as they stand there; of a blockMeshDict with its own scale, in metres.
DictBlocks read_block_file(const Options& options) {
  if (!is_block_dict(options.cage)) return {read_mesh(options.cage), false, {}};
  DictBlocks blocks = read_block_dict(options.cage);
  if (blocks.in_metres && !options.cage_unit.empty()) {
    throw Error(ErrorKind::usage,
                fmt::format("--cage-unit {}: {} has a scale of its own", options.cage_unit, options.cage),
                "leave out --cage-unit, or the file's scale");
  }
  return blocks;
}

}  // namespace

double cage_unit_in_metres(const Options& options, const CadModel& cad) {
  const double cad_unit = cad.summary().files.front().unit_in_metres;
  return !options.cage_unit.empty() ? metres_per_unit(options.cage_unit) : cad_unit > 0 ? cad_unit : 1;
}

bool is_block_file(const std::string& name) {
  const std::string extension = lower_extension(name);
  return is_block_dict(name) || extension == ".vtu" || extension == ".vtm" || extension == ".msh" ||
         extension == ".cgns" || extension == ".su2" || extension == ".foam" ||
         std::filesystem::is_directory(name);
}

FitInputs read_fit_inputs(const Options& options, Progress& progress) {
  const auto start = std::chrono::steady_clock::now();
  if (options.cage == "auto") {
    CadModel cad = read_cad(options.inputs, cad_settings(options), progress);
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    return {.cad = std::move(cad), .drawn = false, .read_seconds = seconds.count()};
  }
  if (is_block_file(options.cage)) {
    DictBlocks blocks = read_block_file(options);
    for (const std::string& note : blocks.notes) progress.warn(note);
    CadModel cad = read_cad(options.inputs, cad_settings(options), progress);
    const double unit = blocks.in_metres ? 1 : cage_unit_in_metres(options, cad);
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    return {.cad = std::move(cad),
            .drawn = false,
            .blocks = scaled(blocks.mesh, unit),
            .cage_unit = unit,
            .read_seconds = seconds.count()};
  }
  // The cage first: it is read at once, and most likely to be wrong.
  MendedCage drawn = read_mended_cage(options.cage);
  CadModel cad = read_cad(options.inputs, cad_settings(options), progress);
  const double unit = cage_unit_in_metres(options, cad);
  for (LintFinding& finding : drawn.mended) {
    progress.warn(finding.message + ": " + finding.remedy);
    for (Vec3& p : finding.places) p *= unit;
  }
  // Before blocks or far fields are made from it. An outer polyhedron must have the faces of the drawn cage.
  PrepareSettings prepare;
  prepare.new_faces = options.outer.empty();
  PreparedCage cage = prepare_cage(scale_cage(std::move(drawn.cage), unit), cad, prepare, progress);
  cage.lint.insert(cage.lint.begin(), drawn.mended.begin(), drawn.mended.end());
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
  return {.cad = std::move(cad),
          .cage = std::move(cage.cage),
          .creases = cage.creases,
          .lint = std::move(cage.lint),
          .cage_unit = unit,
          .read_seconds = seconds.count()};
}

CadReadSettings cad_settings(const Options& options) {
  CadReadSettings settings;
  settings.cad_unit = options.cad_unit;
  settings.crease_angle_degrees = options.crease_angle;
  settings.include = options.include;
  settings.exclude = options.exclude;
  settings.unite = options.unite;
  const auto name = [&](const std::string& opening, const std::vector<std::string>& patterns) {
    for (std::size_t n = 0; n < patterns.size(); ++n) {
      const std::string number = patterns.size() > 1 ? fmt::format("_{}", n + 1) : "";
      settings.named.push_back({opening + number, patterns[n], opening});
    }
  };
  name("inlet", options.inlet);
  name("outlet", options.outlet);
  return settings;
}

AmbientSettings ambient_settings(const Options& options) {
  AmbientSettings settings;
  settings.internal = options.flow == "internal";
  settings.farfield_size = options.farfield_size;
  if (options.cage_size) settings.cage_size = *options.cage_size * metres_per_unit(options.unit);
  return settings;
}

Cage read_cage_in_metres(const std::string& file, double unit) {
  return scale_cage(read_cage(file), unit);
}

FitSettings fit_settings(const Options& options, const FitInputs& inputs, int most) {
  FitSettings settings;
  settings.name_unmatched = inputs.creases != PreparedCage::Creases::found;
  settings.levels = options.levels.value_or(most);
  settings.tolerance = options.levels ? 0 : options.tolerance;
  return settings;
}

void require_gates(const std::vector<Gate>& gates) {
  std::vector<std::string> missed;
  for (const Gate& gate : gates) {
    if (gate.holds) continue;
    missed.push_back(fmt::format("gate {} is missed: {:.3g}, the limit is {:.3g}: {}", gate.name, gate.value,
                                 gate.limit, gate.detail));
  }
  if (missed.empty()) return;
  std::string remedy;
  for (std::size_t i = 1; i < missed.size(); ++i) remedy += missed[i] + "\n  ";
  throw Error(
      ErrorKind::gate, missed.front(),
      remedy +
          "ask for more --levels or a larger --tolerance, improve the cage there (docs/cages.md), or write "
          "the result as it is with --force");
}

Json cage_json(const FitInputs& inputs, const Cage& cage, const Options& options) {
  std::set<std::pair<Index, Index>> creases;
  for (const Cage::Crease& c : cage.creases) {
    if (c.sharpness > 0) creases.insert(std::minmax(c.a, c.b));
  }
  Json lint = Json::array();
  for (const LintFinding& finding : inputs.lint) {
    Json places = Json::array();
    for (const Vec3& p : finding.places) places.push_back(json_of(p));
    lint.push_back({{"rule", finding.rule},
                    {"severity", finding.severity == LintFinding::Severity::mended ? "mended" : "warning"},
                    {"message", finding.message},
                    {"remedy", finding.remedy},
                    {"places", places}});
  }
  static constexpr std::array sources{"file", "found", "none"};
  return {{"source", options.cage},
          {"vertices", cage.points.size()},
          {"faces", cage.faces.size()},
          {"crease_edges", creases.size()},
          {"creases", sources[static_cast<std::size_t>(inputs.creases)]},
          {"genus", topology_of(build_surface_level(cage)).genus},
          {"lint", lint}};
}

Json surface_json(const SurfaceFit& fit) {
  Json levels = Json::array();
  for (const FittedLevel& level : fit.levels) {
    const LevelReport& r = level.report;
    levels.push_back({{"level", r.level},
                      {"control_vertices", r.control_vertices},
                      {"samples", r.samples},
                      {"max_deviation", r.max_deviation},
                      {"rms_deviation", r.rms_deviation},
                      {"solver_iterations", r.solver_iterations},
                      {"seconds", r.seconds},
                      {"passes", r.passes},
                      {"folds", r.folds},
                      {"crease_deviation", r.crease_deviation},
                      {"edge_length_ratio", r.edge_length_ratio},
                      {"worst_place", json_of(r.worst_place)},
                      {"stopped_because", r.stopped_because}});
  }
  return {{"max_deviation", fit.max_deviation},
          {"rms_deviation", fit.rms_deviation},
          {"coverage_deviation", fit.coverage_deviation},
          {"levels", levels},
          {"stopped_because", fit.stopped_because},
          {"worst_place", json_of(fit.worst_place)},
          {"worst_coverage_place", json_of(fit.worst_coverage_place)},
          {"unmatched_feature_chains", fit.unmatched_chains.size()},
          {"warnings", fit.warnings}};
}

Json gates_json(const std::vector<Gate>& gates) {
  Json list = Json::array();
  for (const Gate& g : gates) {
    list.push_back({{"name", g.name},
                    {"limit", g.limit},
                    {"value", g.value},
                    {"holds", g.holds},
                    {"detail", g.detail},
                    {"place", g.place ? json_of(*g.place) : Json()}});
  }
  return list;
}

Json step_json(const PatchSurface& patches, double diagonal) {
  return {{"patches", patches.patches.size()},
          {"edges", patches.edges.size()},
          {"max_deviation", patches.max_deviation / diagonal},
          {"max_angle", patches.max_angle_degrees},
          {"max_angle_place", json_of(patches.worst_angle_place)}};
}

Offset peak_memory_bytes() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  return Offset{1024} * usage.ru_maxrss;
}

}  // namespace flowcage
