// The swept-body route as a table: wings built in code and CAD files given by name. See docs/theory.md.
#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <fstream>

#include "core/base/error.hpp"
#include "core/export/write_vtu.hpp"
#include "core/quality/quality_report.hpp"
#include "tests/bench/cpu_seconds.hpp"
#include "tests/blocks/swept_bodies.hpp"

using namespace flowcage;
using namespace flowcage::test;

namespace {

void print_body(const SweptBody& body) {
  constexpr std::array<const char*, 3> ends{"open", "flat", "rounded"};
  constexpr std::array<const char*, 3> kinds{"sharp", "blunt", "round"};
  fmt::print("span {}, chord {}, {} at {:.4g} to {} at {:.4g}, {} trailing edge\n", place(body.axes.span),
             place(body.axes.chord), ends[static_cast<int>(body.ends[0])], body.reach[0],
             ends[static_cast<int>(body.ends[1])], body.reach[1], kinds[static_cast<int>(body.trailing)]);
  for (const AirfoilSection& section : body.sections) {
    fmt::print("    s {:.5g}: chord {:.4g}, thickness {:.4g}, {}, leading edge ({:.4g}, {:.4g})\n", section.s,
               section.chord(), section.thickness(), kinds[static_cast<int>(section.kind)],
               section.leading.x(), section.leading.y());
  }
  for (const std::string& w : body.warnings) fmt::print("    {}\n", w);
}

}  // namespace

int main(int argc, char** argv) {
  std::vector<std::string> names;
  std::vector<std::string> files;
  std::vector<int> levels{2};
  int worst = 0;
  bool stations = false;
  double first_height = 0;
  LayerSettings layers;
  std::string picture;
  CLI::App app{"figures of the swept-body route"};
  app.add_option("--body", names, "bodies built in code (default: all, where no file is given)");
  app.add_option("--cad", files, "CAD files");
  app.add_option("--levels", levels, "levels of the cage");
  app.add_option("--worst", worst, "worst cells to list by place");
  app.add_flag("--stations", stations, "only find the body: its axes, ends and sections");
  app.add_option("--first-height", first_height, "of boundary layers, in the body's largest extent");
  app.add_option("--growth", layers.growth, "of boundary layers");
  app.add_option("--vtu", picture, "write the last mesh");
  CLI11_PARSE(app, argc, argv);
  if (names.empty() && files.empty()) names = swept_body_names();
  fmt::print("{:<18} {:>2} {:>6} {:>8} {:>4} {:>4} {:>6} {:>6} {:>6} {:>8} {:>8} {:>8} {:>7} {}\n", "body",
             "L", "blocks", "cells", "inv", "unp", "minSJ", "meanSJ", "nonort", "skew", "maxdev", "coverage",
             "seconds", "checkMesh");
  std::vector<std::string> all = names;
  all.insert(all.end(), files.begin(), files.end());
  Progress silent;
  for (std::size_t n = 0; n < all.size(); ++n) {
    for (const int level : levels) {
      const double start = cpu_seconds();
      const std::string label = all[n].substr(all[n].find_last_of('/') + 1);
      fmt::print("{:<18} {:>2} ", label, level);
      std::fflush(stdout);
      try {
        const CadModel cad = n < names.size() ? make_swept_body(all[n]) : read_swept_cad(all[n]);
        if (stations) {
          print_body(find_swept_body(cad, all[n]));
          continue;
        }
        layers.first_height = first_height * cad.bounds().sizes().maxCoeff();
        const VolumeResult r = mesh_swept_body(cad, all[n], level, layers, silent);
        const QualityReport& q = r.quality;
        std::string failures;
        for (const std::string& f : check_mesh_failures(q)) failures += (failures.empty() ? "" : "; ") + f;
        fmt::print(
            "{:>6} {:>8} {:>4} {:>4} {:>6.3f} {:>6.3f} {:>6.1f} {:>8.2f} {:>8.1e} {:>8.1e} {:>7.1f} "
            "{}\n",
            q.blocks, q.cells, q.inverted_cells, r.validity.uncertified, q.scaled_jacobian.min,
            q.scaled_jacobian.mean, q.non_orthogonality.max, q.skewness.max, r.fit.max_deviation,
            r.fit.coverage_deviation, cpu_seconds() - start, failures.empty() ? "Mesh OK" : failures);
        for (const std::string& w : r.fit.warnings) fmt::print("    {}\n", w);
        for (int k = 0; k < std::min<int>(worst, static_cast<int>(q.scaled_jacobian.worst.size())); ++k) {
          const WorstCell& w = q.scaled_jacobian.worst[k];
          fmt::print("    scaled Jacobian {:.3f} at {}, cell {} of block {}\n", w.value, place(w.place),
                     w.cell, w.block);
        }
        if (!picture.empty()) {
          std::ofstream out(picture, std::ios::binary);
          write_vtu(out, r.mesh);
        }
      } catch (const Error& e) {
        fmt::print("{}\n", e.what());
      }
      std::fflush(stdout);
    }
  }
}
