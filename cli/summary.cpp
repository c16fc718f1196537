#include "cli/summary.hpp"

#include <fmt/format.h>

#include <iterator>

#include "cli/json_report.hpp"

namespace flowcage {

std::string surface_summary(const SurfaceFit& fit, double diagonal) {
  std::string text =
      fmt::format("\nfitted surface; deviation from the CAD in diagonals ({:.4g} m)\n", diagonal);
  auto out = std::back_inserter(text);
  fmt::format_to(out, "{:>7}{:>10}{:>12}{:>12}{:>7}\n", "level", "vertices", "max", "rms", "folds");
  for (const FittedLevel& level : fit.levels) {
    const LevelReport& r = level.report;
    fmt::format_to(out, "{:>7}{:>10}{:>12.3g}{:>12.3g}{:>7}\n", r.level, r.control_vertices, r.max_deviation,
                   r.rms_deviation, r.folds);
  }
  fmt::format_to(out, "stopped at level {}: {}\n", fit.levels.back().report.level, fit.stopped_because);
  fmt::format_to(out, "worst {:.3g} m at {}; CAD to surface {:.3g} m at {}\n", fit.max_deviation * diagonal,
                 place(fit.worst_place), fit.coverage_deviation * diagonal, place(fit.worst_coverage_place));
  return text;
}

std::string patches_summary(const PatchSurface& patches, double diagonal) {
  return fmt::format(
      "{} B-spline patches; {:.3g} m from the fitted surface ({:.3g} diagonals); {:.3g} degrees "
      "between their normals off creases\n",
      patches.patches.size(), patches.max_deviation, patches.max_deviation / diagonal,
      patches.max_angle_degrees);
}

std::string blocks_summary(const PlacedBlocks& placed) {
  const AmbientReport& report = placed.blocks.report;
  const HexValidity& after = placed.untangle.after;
  std::string out = fmt::format(
      "\n{} blocks (ambient grid: {}); cage of {} quads, genus {}, {} of {} chains of sharp edges followed\n"
      "scaled Jacobian {:.3f} at least, {:.3f} on average; {} inverted\n",
      placed.blocks.complex.hexes.size(), report.steps, placed.blocks.cage.faces.size(), report.genus,
      report.chains_matched, report.chains, after.min_scaled_jacobian, after.mean_scaled_jacobian,
      after.inverted);
  for (const AmbientFinding& f : report.findings) out += f.check + ": " + f.what + "\n";
  return out;
}

std::string volume_summary(const VolumeResult& result, double diagonal, const Options& options) {
  const QualityReport& q = result.quality;
  std::string text = surface_summary(result.fit, diagonal);
  auto out = std::back_inserter(text);
  fmt::format_to(out, "\n{} hexes in {} blocks, {} points, {} inverted\n", q.cells, q.blocks, q.points,
                 q.inverted_cells);
  fmt::format_to(out, "scaled Jacobian {:.3f} min, {:.3f} mean; non-orthogonality {:.1f} max, {:.1f} mean; ",
                 q.scaled_jacobian.min, q.scaled_jacobian.mean, q.non_orthogonality.max,
                 q.non_orthogonality.mean);
  fmt::format_to(out, "skewness {:.2f}; aspect ratio {:.1f}\n", q.skewness.max, q.aspect_ratio.max);
  for (const std::string& failure : check_mesh_failures(q)) {
    fmt::format_to(out, "checkMesh would complain: {}\n", failure);
  }
  for (std::size_t n = 0; n < result.coarser.size(); ++n) {
    const QualityReport& c = result.coarser[n].quality;
    fmt::format_to(out,
                   "grid {} of the family: {} hexes, {} inverted; scaled Jacobian {:.3f} min, {:.3f} mean; "
                   "non-orthogonality {:.1f} max\n",
                   result.coarser.size() - n, c.cells, c.inverted_cells, c.scaled_jacobian.min,
                   c.scaled_jacobian.mean, c.non_orthogonality.max);
  }
  const double scale = 1 / metres_per_unit(options.unit);
  fmt::format_to(out, "\n{:<24}{:<11}{:>9}{:>12}{:>12}{:>26}\n", "patch", "type", "faces", "max dev.",
                 "rms dev.", "first height, " + options.unit);
  for (const PatchSummary& p : result.patches) {
    fmt::format_to(out, "{:<24}{:<11}{:>9}", p.name, patch_type_name(p.type), p.faces);
    if (p.type == PatchType::wall) {
      fmt::format_to(out, "{:>12.3g}{:>12.3g}{:>14.4g} ..{:>9.4g}", p.max_deviation, p.rms_deviation,
                     p.min_first_height * scale, p.max_first_height * scale);
    }
    text += '\n';
  }
  return text;
}

}  // namespace flowcage
