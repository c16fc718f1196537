// The automatic blocks' figures, on bodies built in code and on CAD files: one row a body.
#include <fmt/format.h>
#include <time.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <fstream>

#include "core/auto_blocks.hpp"
#include "core/base/error.hpp"
#include "core/base/parallel.hpp"
#include "core/cage/write_cage.hpp"
#include "core/export/write_vtu.hpp"
#include "core/quality/jacobian.hpp"
#include "tests/bench/cpu_seconds.hpp"
#include "tests/blocks/ambient_bodies.hpp"

using namespace flowcage;
using namespace flowcage::test;
namespace fs = std::filesystem;

namespace {

struct Job {
  std::vector<std::string> bodies, files;
  std::string pictures;
  AmbientSettings ambient;
  int level = 2;
  bool findings = false;
};

void write_pictures(const std::string& folder, const std::string& name, const AmbientBlocks& blocks) {
  fs::create_directories(folder);
  write_cage(blocks.cage, fs::path(folder) / (name + ".obj"));
  const BlockMesh mesh(std::make_shared<const HexComplex>(blocks.complex));
  const std::vector<float> jacobians = scaled_jacobians(mesh);
  std::ofstream out(fs::path(folder) / (name + ".vtu"), std::ios::binary);
  write_vtu(out, mesh, {{{"scaled_jacobian", jacobians, {}}}, {}});
}

void print_row(const std::string& name, const TargetSurface& cad, const Job& job, bool internal) {
  Progress silent;
  const double start = cpu_seconds();
  fmt::print("| {} ", name);
  std::fflush(stdout);
  try {
    AmbientSettings settings = job.ambient;
    settings.internal = internal;
    AmbientBlocks blocks = make_ambient_blocks(cad, settings, silent);
    const double made = cpu_seconds() - start;
    if (!job.pictures.empty()) write_pictures(job.pictures, name + "_raw", blocks);
    const Topology topology = topology_of(build_surface_level(blocks.cage));
    fmt::print("| {} | {} | {} | {}/{} ", blocks.complex.hexes.size(), blocks.cage.faces.size(),
               topology.genus, blocks.report.chains_matched, blocks.report.chains);
    std::fflush(stdout);
    const PlacedBlocks placed = place_blocks(std::move(blocks), cad, silent);
    if (!job.pictures.empty()) write_pictures(job.pictures, name, placed.blocks);
    FitSettings fit_settings;
    fit_settings.levels = job.level;
    const SurfaceFit fit = fit_surface(placed.blocks.cage, cad, fit_settings, silent);
    fmt::print("| {:.1e} | {:.1e} | {} | {} | {:.3f} | {:.3f} | {:.1f}+{:.1f} |", fit.max_deviation,
               fit.coverage_deviation, fit.levels.back().report.folds, placed.untangle.after.inverted,
               placed.untangle.after.min_scaled_jacobian, placed.untangle.after.mean_scaled_jacobian, made,
               cpu_seconds() - start - made);
    const AmbientReport& report = placed.blocks.report;
    fmt::print(" {}", report.steps);
    for (const AmbientFinding& f : report.findings) fmt::print("; {}", f.check);
    if (fit.max_deviation > 1e-3) fmt::print(" worst at {}", place(fit.worst_place));
    if (fit.coverage_deviation > 1e-3) fmt::print(" not covered at {}", place(fit.worst_coverage_place));
    fmt::print("\n");
    if (job.findings) {
      for (const AmbientFinding& f : placed.blocks.report.findings)
        fmt::print("    {}: {}\n", f.check, f.what);
      for (const LocatedCell& c : placed.untangle.inverted)
        fmt::print("    inverted at {}\n", place(c.centre));
    }
  } catch (const Error& error) {
    fmt::print("| refused: {} | {:.1f} |\n", error.what(), cpu_seconds() - start);
  }
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  Job job;
  int threads = 0;
  CLI::App app{"The automatic blocks' figures"};
  app.add_option("--body", job.bodies, "bodies built in code (default without files: all)")
      ->check(CLI::IsMember(ambient_body_names()));
  app.add_option("files", job.files, "CAD files");
  app.add_option("--cage-size", job.ambient.cage_size, "edge length of cage quads, m");
  app.add_option("--level", job.level, "of the fit");
  app.add_flag("!--no-map", job.ambient.map, "without the map");
  app.add_flag("!--no-layer", job.ambient.wall_layer, "without the O-grid of one layer");
  app.add_option("--growth", job.ambient.growth, "toward the far field");
  bool internal = false;
  app.add_flag("--internal", internal, "the fluid is inside of the files' CAD");
  app.add_option("--pictures", job.pictures, "folder for the cages (OBJ) and blocks (VTU)");
  app.add_flag("--findings", job.findings, "every finding of a body");
  app.add_option("--threads", threads, "0: all");
  CLI11_PARSE(app, argc, argv);
  if (threads > 0) set_thread_count(threads);
  fmt::print(
      "| body | blocks | quads | genus | chains | deviation | coverage | folds | inverted | min SJ | mean SJ "
      "| CPU s "
      "(blocks + placing and fit) |\n|---|---|---|---|---|---|---|---|---|---|---|---|\n");
  if (job.bodies.empty() && job.files.empty()) job.bodies = ambient_body_names();
  for (const std::string& name : job.bodies) {
    const AmbientTestBody body = make_ambient_body(name);
    print_row(name, body.cad, job, body.internal);
  }
  for (const std::string& file : job.files) {
    Progress silent;
    try {
      const CadModel cad = read_cad(std::vector<std::string>{file}, {}, silent);
      print_row(fs::path(file).filename().string(), cad, job, internal);
    } catch (const Error& error) {
      fmt::print("| {} | refused: {} |\n", fs::path(file).filename().string(), error.what());
    }
  }
  return 0;
}
