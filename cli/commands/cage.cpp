#include <fmt/format.h>

#include <chrono>
#include <memory>

#include "cli/cad_json.hpp"
#include "cli/commands/commands.hpp"
#include "cli/fit_job.hpp"
#include "cli/summary.hpp"
#include "cli/terminal.hpp"
#include "core/auto_blocks.hpp"
#include "core/base/atomic_file.hpp"
#include "core/cage/read_cage.hpp"
#include "core/cage/write_cage.hpp"
#include "core/export/file_text.hpp"
#include "core/export/write_vtu.hpp"
#include "core/quality/jacobian.hpp"

namespace flowcage {
namespace {

std::string format_of(const std::string& name) {
  const std::string extension = lower_extension(name);
  if (extension == ".obj" || extension == ".vtu") return extension;
  throw Error(ErrorKind::usage, fmt::format("-o: {}: unknown format of a cage or blocks", name),
              "give a name that ends in .obj (the cage) or .vtu (the blocks)");
}

void write_blocks(std::ostream& out, const HexComplex& complex, double scale, Progress& progress) {
  BlockMesh mesh(std::make_shared<const HexComplex>(complex));
  for (Vec3& p : mesh.mutable_points()) p *= scale;
  const std::vector<float> jacobians = scaled_jacobians(mesh);
  for (const std::string& note :
       write_vtu(out, mesh, {{{"scaled_jacobian", jacobians, {}}}, {}}, &progress)) {
    progress.warn(note);
  }
}

/// What a user must know before the cage is used: checks that failed, blocks that are inverted.
std::vector<Gate> gates_of(const PlacedBlocks& placed) {
  std::vector<Gate> gates;
  std::string what;
  for (const AmbientFinding& f : placed.blocks.report.findings) {
    what += (what.empty() ? "" : "\n  ") + f.check + ": " + f.what;
  }
  const auto findings = static_cast<double>(placed.blocks.report.findings.size());
  gates.push_back({"lost_features", 0, findings, findings == 0, what});
  const HexValidity& after = placed.untangle.after;
  Gate inverted{"inverted_blocks", 0, static_cast<double>(after.inverted), after.inverted == 0, {}};
  if (!inverted.holds) {
    inverted.detail = "the first one is at " + place(placed.untangle.inverted.front().centre);
  }
  gates.push_back(std::move(inverted));
  return gates;
}

Json blocks_json(const PlacedBlocks& placed) {
  const AmbientReport& report = placed.blocks.report;
  Json findings = Json::array();
  for (const AmbientFinding& f : report.findings) {
    findings.push_back({{"check", f.check}, {"message", f.what}, {"place", json_of(f.place)}});
  }
  return {{"route", "ambient"},
          {"steps", report.steps},
          {"blocks", placed.blocks.complex.hexes.size()},
          {"chains", report.chains},
          {"chains_matched", report.chains_matched},
          {"topology_checked", report.topology_checked},
          {"inverted_blocks", placed.untangle.after.inverted},
          {"min_scaled_jacobian", placed.untangle.after.min_scaled_jacobian},
          {"mean_scaled_jacobian", placed.untangle.after.mean_scaled_jacobian},
          {"findings", findings}};
}

}  // namespace

int run_cage(const Options& options, Progress& progress) {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point start = Clock::now();
  const auto seconds = [&] { return std::chrono::duration<double>(Clock::now() - start).count(); };
  std::vector<std::string> formats;
  for (const std::string& name : options.outputs) formats.push_back(format_of(name));
  const CadModel cad = read_cad(options.inputs, cad_settings(options), progress);
  const double read_seconds = seconds();
  // Opened before the long work: a place that cannot be written shows now.
  std::vector<std::unique_ptr<AtomicFile>> outputs;
  for (const std::string& name : options.outputs) outputs.push_back(std::make_unique<AtomicFile>(name));
  const std::unique_ptr<AtomicFile> json_file = open_json(options);

  const PlacedBlocks placed =
      place_blocks(make_ambient_blocks(cad, ambient_settings(options), progress), cad, progress);
  const AmbientBlocks& blocks = placed.blocks;
  const std::vector<Gate> gates = gates_of(placed);
  const bool write = options.force || all_hold(gates);
  if (write) {
    // In the unit that --cage is read back in.
    const double unit = cage_unit_in_metres(options, cad);
    for (std::size_t i = 0; i < outputs.size(); ++i) {
      if (formats[i] == ".obj") {
        write_cage(scale_cage(blocks.cage, 1 / unit), outputs[i]->stream());
      } else {
        write_blocks(outputs[i]->stream(), blocks.complex, 1 / unit, progress);
      }
    }
  }
  if (json_file) {
    Json json = new_report();
    json["cad"] = cad_json(cad.summary());
    json["cage"] = {{"source", "auto"},
                    {"vertices", blocks.cage.points.size()},
                    {"faces", blocks.cage.faces.size()},
                    {"crease_edges", blocks.cage.creases.size()},
                    {"genus", blocks.report.genus}};
    json["blocks"] = blocks_json(placed);
    json["gates"] = gates_json(gates);
    json["seconds"] = {{"read", read_seconds}, {"cage", seconds() - read_seconds}, {"total", seconds()}};
    json["peak_memory_bytes"] = peak_memory_bytes();
    write_json(json, *json_file);
  }
  if (write) {
    for (const auto& output : outputs) output->commit();
  }
  if (json_file) json_file->commit();
  if (!options.quiet) print_summary(blocks_summary(placed));
  require_gates(gates);
  return 0;
}

}  // namespace flowcage
