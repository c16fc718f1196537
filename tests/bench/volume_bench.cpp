// The volume's figures as a table: validity, quality, spacing, with and without layers. See docs/theory.md.
#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "core/base/error.hpp"
#include "core/base/parallel.hpp"
#include "core/pipeline.hpp"
#include "tests/bench/cpu_seconds.hpp"
#include "tests/volume/volume_bodies.hpp"

using namespace flowcage;
using namespace flowcage::test;

namespace {

struct Job {
  std::vector<std::string> bodies;
  std::vector<int> levels{2, 3, 4};
  std::vector<double> heights{0, 1e-5};  ///< of the body's length; 0: no layers
  double growth = 1.2;
  std::string farfield = "box", blocks = "shell";
  int worst = 0;  ///< cells to list
};

void print_row(const VolumeBody& body, int level, double height, const Job& job) {
  Progress silent;
  VolumeSettings settings;
  settings.fit.levels = level;
  FarField farfield;
  farfield.kind = job.farfield == "box" ? OuterShape::Kind::box : OuterShape::Kind::sphere;
  settings.layers.first_height = height * body.length;
  settings.layers.growth = job.growth;
  const double start = cpu_seconds();
  fmt::print("{:<14} {:>2} {:>7.0e} ", body.name, level, height);
  try {
    const auto source =
        job.blocks == "swept" ? swept_source(body.cad, {}, body.name)
        : job.blocks == "ambient"
            ? ambient_source(body.cad, {}, body.name, silent)
            : shell_source(body.cage, body.outer ? &*body.outer : nullptr, farfield, body.cad.bounds());
    const VolumeResult r = make_volume(*source, body.cad, settings, silent);
    const QualityReport& q = r.quality;
    std::string failures;
    for (const std::string& f : check_mesh_failures(q)) failures += (failures.empty() ? "" : "; ") + f;
    fmt::print(
        "{:>8} {:>4} {:>4} {:>6.3f} {:>6.3f} {:>6.3f} {:>6.3f} {:>6.3f} {:>6.1f} {:>6.2f} {:>8.1f} "
        "{:>6.2f} {:>7.1f}  "
        "{}\n",
        q.cells, q.inverted_cells, r.validity.uncertified, q.scaled_jacobian.min, q.scaled_jacobian.mean,
        r.bound.min, r.normals.min_cosine, r.normals.mean_cosine, q.non_orthogonality.max, q.skewness.max,
        q.aspect_ratio.max, r.layers.max_growth, cpu_seconds() - start,
        failures.empty() ? "Mesh OK" : failures);
    const auto list = [&](const char* what, const MetricSummary& metric) {
      for (int n = 0; n < std::min<int>(job.worst, static_cast<int>(metric.worst.size())); ++n) {
        const WorstCell& w = metric.worst[n];
        fmt::print("    {} {:.3f} at ({:.4f}, {:.4f}, {:.4f}), cell {} of block {}\n", what, w.value,
                   w.place.x(), w.place.y(), w.place.z(), w.cell, w.block);
      }
    };
    list("scaled Jacobian", q.scaled_jacobian);
    list("non-orthogonality", q.non_orthogonality);
    list("skewness", q.skewness);
  } catch (const Error& e) {
    fmt::print("{}\n", e.what());
  }
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  Job job;
  int threads = 0;
  CLI::App app{"figures of the volume mesh"};
  app.add_option("--body", job.bodies, "bodies (default: all)")->check(CLI::IsMember(volume_body_names()));
  app.add_option("--levels", job.levels, "subdivision levels");
  app.add_option("--heights", job.heights, "first heights in body lengths, 0: none");
  app.add_option("--growth", job.growth, "growth ratio");
  app.add_option("--blocks", job.blocks, "shell, swept or ambient");
  app.add_option("--farfield", job.farfield, "box or sphere");
  app.add_option("--worst", job.worst, "worst cells to list by place");
  app.add_option("--threads", threads, "threads (0: all)");
  CLI11_PARSE(app, argc, argv);
  set_thread_count(threads);
  if (job.bodies.empty()) job.bodies = volume_body_names();
  fmt::print(
      "{:<14} {:>2} {:>7} {:>8} {:>4} {:>4} {:>6} {:>6} {:>6} {:>6} {:>6} {:>6} {:>6} {:>8} {:>6} "
      "{:>7}  {}\n",
      "body", "L", "height", "cells", "inv", "unp", "minSJ", "meanSJ", "bound", "mincos", "mncos", "nonort",
      "skew", "aspect", "growth", "seconds", "checkMesh");
  for (const std::string& name : job.bodies) {
    const VolumeBody body = make_volume_body(name);
    for (const int level : job.levels) {
      for (const double height : job.heights) print_row(body, level, height, job);
    }
  }
}
