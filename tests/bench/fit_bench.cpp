// The fit's figures as tables: deviation by level, cost, both distances, noise. See docs/theory.md.
#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>

#include "core/base/error.hpp"
#include "core/base/parallel.hpp"
#include "core/refit/fit_surface.hpp"
#include "core/refit/prepare_cage.hpp"
#include "tests/bench/cpu_seconds.hpp"
#include "tests/refit/fit_bodies.hpp"
#include "tests/refit/hand_drawn_cages.hpp"

using namespace flowcage;
using namespace flowcage::test;

namespace {

struct Job {
  std::vector<std::string> bodies;
  FitSettings fit;
  double noise = 0;
  unsigned seeds = 20, first_seed = 1;
  bool passes = false;
  bool growth = false;
};

/// As the program fits: the cage is linted and mended first.
SurfaceFit fitted(const Cage& cage, const FitBody& body, const FitSettings& settings) {
  Progress silent;
  const PreparedCage prepared = prepare_cage(cage, body.cad, {}, silent);
  return fit_surface(prepared.cage, body.cad, settings, silent);
}

void print_level(const LevelReport& r, double asked) {
  fmt::print(
      "  {:>5} {:>8} {:>8} {:>9.2e} {:>9.1e} {:>9.1e} {:>9.1e} {:>6.2f} {:>5} {:>6} {:>6} {:>8.3f}  {}\n",
      r.level, r.control_vertices, r.samples, r.max_deviation, asked, r.rms_deviation, r.crease_deviation,
      r.edge_length_ratio, r.folds, r.passes, r.solver_iterations, r.seconds, r.stopped_because);
}

void print_table(const FitBody& body, const Job& job) {
  const double before = cpu_seconds();
  const SurfaceFit fit = fitted(body.cage, body, job.fit);
  const double seconds = cpu_seconds() - before;
  fmt::print("{} ({} cage vertices): coverage {:.2e}, {:.2f} s CPU\n", body.name, body.cage.points.size(),
             fit.coverage_deviation, seconds);
  fmt::print(
      "  level  control  samples       max     asked       rms    crease  ratio folds passes   cgls  "
      "seconds\n");
  for (const FittedLevel& level : fit.levels) {
    const int l = level.report.level;
    print_level(level.report, l >= 2 && l <= 4 ? body.asked[l - 2] : 0);
    if (!job.passes) continue;
    for (const PassReport& pass : level.report.history) {
      fmt::print("        pass max {:.2e} rms {:.2e} folds {} cgls {} at {:.3f} s{}\n", pass.max_error,
                 pass.rms_error, pass.folds, pass.solver_iterations, pass.seconds,
                 pass.relaxed ? " (relaxed)" : "");
    }
  }
  const Vec3& p = fit.worst_place;
  fmt::print("  worst at ({:.4f}, {:.4f}, {:.4f})\n", p.x(), p.y(), p.z());
  for (const std::string& warning : fit.warnings) fmt::print("  warning: {}\n", warning);
}

/// One row a level: the processor time of the whole fit to it, and per control vertex.
void print_growth(const FitBody& body, const Job& job) {
  fmt::print("{}: fit to a level, coverage included\n  level  control   s CPU  factor  us a control vertex\n",
             body.name);
  double last = 0;
  FitSettings settings = job.fit;
  for (settings.levels = 2; settings.levels <= job.fit.levels; ++settings.levels) {
    const double before = cpu_seconds();
    const SurfaceFit fit = fitted(body.cage, body, settings);
    const double seconds = cpu_seconds() - before;
    const Index control = fit.levels.back().report.control_vertices;
    fmt::print("  {:>5} {:>8} {:>7.2f} {:>7} {:>20.0f}\n", settings.levels, control, seconds,
               last > 0 ? fmt::format("{:.1f}", seconds / last) : "", 1e6 * seconds / control);
    std::fflush(stdout);
    last = seconds;
  }
}

/// One row a body: how often the fit of a cage with noise folds, fails, or misses three times the plain one.
void print_noise(const FitBody& body, const Job& job) {
  const double plain = fitted(body.cage, body, job.fit).max_deviation;
  unsigned folded = 0, failed = 0, beyond = 0;
  std::vector<double> ratios;
  std::string bad;
  for (unsigned seed = job.first_seed; seed < job.first_seed + job.seeds; ++seed) {
    try {
      const SurfaceFit fit =
          fitted(with_noise(body.cage, job.noise * body.cad.diagonal(), seed), body, job.fit);
      const bool folds = std::any_of(fit.levels.begin(), fit.levels.end(),
                                     [](const FittedLevel& level) { return level.report.folds > 0; });
      folded += folds ? 1 : 0;
      ratios.push_back(fit.max_deviation / plain);
      beyond += ratios.back() > 3 ? 1 : 0;
      if (folds || ratios.back() > 3) bad += fmt::format(" {}{}", seed, folds ? "f" : "");
    } catch (const Error& error) {
      ++failed;
      bad += fmt::format(" {}: {}", seed, error.what());
    }
  }
  std::sort(ratios.begin(), ratios.end());
  if (ratios.empty()) ratios.push_back(0);
  fmt::print(
      "{:<15} noise {:.2g}: {} of {} good, {} folded, {} failed, {} beyond 3 x; ratio median {:.2f}, largest "
      "{:.2f}{}\n",
      body.name, job.noise, job.seeds - folded - failed - (beyond - std::min(beyond, folded)), job.seeds,
      folded, failed, beyond, ratios[ratios.size() / 2], ratios.back(), bad.empty() ? "" : "; seeds" + bad);
}

}  // namespace

int main(int argc, char** argv) {
  Job job;
  job.fit.levels = 4;
  int threads = 0;
  std::string distance = "tangent";
  CLI::App app{"The fit's figures on bodies built in code"};
  app.add_option("--body", job.bodies, "bodies (default: all)")->check(CLI::IsMember(fit_body_names()));
  app.add_option("--levels", job.fit.levels, "subdivision levels");
  app.add_option("--distance", distance, "what a pass minimises")->check(CLI::IsMember({"tangent", "point"}));
  app.add_option("--passes-max", job.fit.max_passes, "passes a level");
  app.add_flag("--passes", job.passes,
               "every pass of every level; with --noise the table of the first seed's cage");
  app.add_flag("--growth", job.growth, "the time of fits to levels 2, 3, ... (with --threads 1)");
  app.add_option("--noise", job.noise, "moves every cage vertex by up to this, in diagonals; a row a body");
  app.add_option("--seeds", job.seeds, "cages with noise a body");
  app.add_option("--first-seed", job.first_seed, "the first of them");
  app.add_flag("!--no-mirror", job.fit.mirror, "plain boundaries at symmetry planes");
  app.add_option("--threads", threads, "0: all");
  CLI11_PARSE(app, argc, argv);
  if (threads > 0) set_thread_count(threads);
  job.fit.tangent_distance = distance == "tangent";
  if (job.bodies.empty()) job.bodies = fit_body_names();
  for (const std::string& name : job.bodies) {
    FitBody body = make_fit_body(name);
    if (job.growth) {
      print_growth(body, job);
    } else if (job.noise > 0 && job.passes) {
      body.cage = with_noise(body.cage, job.noise * body.cad.diagonal(), job.first_seed);
      print_table(body, job);
    } else if (job.noise > 0) {
      print_noise(body, job);
    } else {
      print_table(body, job);
    }
    std::fflush(stdout);
  }
  return 0;
}
