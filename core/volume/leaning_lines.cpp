#include "core/volume/leaning_lines.hpp"

#include <algorithm>
#include <limits>

#include "core/volume/line_curve.hpp"
#include "core/volume/wall_columns.hpp"

namespace flowcage {
namespace {

/// #lines: the largest first height of each.
std::vector<double> first_height_bounds(const BlockMesh& mesh, const WallBlocks& blocks,
                                        const WallColumns& columns, const LeanSettings& settings) {
  std::vector<double> bound(columns.lines.size(), std::numeric_limits<double>::max());
  const auto at = [&](Index l, Index k) -> const Vec3& {
    return mesh.points()[line_point(mesh, blocks, columns.lines[l], k)];
  };
  const auto lower = [&](Index foot, Index behind) {
    const Vec3 edge = at(foot, 0) - at(behind, 0);
    const double cosine = (at(foot, 1) - at(foot, 0)).normalized().dot(edge.normalized());
    if (cosine > 0) bound[foot] = std::min(bound[foot], settings.most_lean * edge.norm() / cosine);
  };
  for (const auto& [a, b] : columns.edges) {
    lower(a, b);
    lower(b, a);
  }
  for (bool changed = true; changed;) {
    changed = false;
    for (const auto& [a, b] : columns.edges) {
      const double rise = settings.slope * (at(a, 0) - at(b, 0)).norm();
      for (const auto& [x, y] : {std::pair{a, b}, std::pair{b, a}}) {
        if (bound[x] <= (bound[y] + rise) * (1 + 1e-12)) continue;
        bound[x] = bound[y] + rise;
        changed = true;
      }
    }
  }
  return bound;
}

/// A line with what shortening needs: s becomes s (1 - cut (1 - s / reach)^2), which rises for every
/// cut < 1 and meets s smoothly at the reach.
struct LeaningLine {
  Index line = 0;
  LineCurve curve;
  double reach = 0, cut = 0;
};

std::vector<LeaningLine> leaning_lines(const BlockMesh& mesh, const WallBlocks& blocks,
                                       const WallColumns& columns, const LeanSettings& settings) {
  constexpr double reach_in_cells = 8, most_cut = 0.95;
  const std::vector<double> bounds = first_height_bounds(mesh, blocks, columns, settings);
  std::vector<LeaningLine> out;
  for (std::size_t l = 0; l < columns.lines.size(); ++l) {
    if (columns.rim[l] != 0) continue;
    const PointRow row = line_points(mesh, blocks, columns.lines[l]);
    if ((mesh.points()[row[1]] - mesh.points()[row[0]]).norm() <= bounds[l]) continue;
    LineCurve curve(line_positions(mesh, blocks, columns.lines[l], columns.layers));
    const double first = curve.lengths()[1];
    const double reach = std::min(reach_in_cells * first, curve.length());
    const double rest = 1 - first / reach;
    if (!(rest > 0)) continue;
    const double cut = std::min(most_cut, (1 - bounds[l] / first) / (rest * rest));
    out.push_back({static_cast<Index>(l), std::move(curve), reach, cut});
  }
  return out;
}

}  // namespace

Index shorten_leaning_lines(BlockMesh& mesh, const WallBlocks& blocks, const LeanSettings& settings) {
  const WallColumns columns = wall_columns(mesh, blocks);
  const auto faces = static_cast<Offset>(columns.faces.size());
  std::vector<LeaningLine> leaning = leaning_lines(mesh, blocks, columns, settings);
  if (leaning.empty()) return 0;
  const std::vector<float> before = column_values(mesh, blocks, columns);
  constexpr int most_passes = 12;
  for (int pass = 0; pass <= most_passes; ++pass) {
    for (const LeaningLine& line : leaning) {
      const PointRow row = line_points(mesh, blocks, columns.lines[line.line]);
      for (Index k = 1; k < columns.layers && line.curve.lengths()[k] < line.reach; ++k) {
        const double s = line.curve.lengths()[k];
        const double rest = 1 - s / line.reach;
        mesh.mutable_points()[row[k]] = line.curve.at(s * (1 - line.cut * rest * rest));
      }
    }
    flatten_symmetry(mesh, blocks);
    const std::vector<float> after = column_values(mesh, blocks, columns);
    std::vector<char> worse(columns.lines.size(), 0);
    for (Offset n = 0; n < static_cast<Offset>(after.size()); ++n) {
      if (after[n] >= std::min(settings.good_enough, settings.keep * before[n])) continue;
      for (const Index l : columns.faces[n % faces]) worse[l] = 1;
    }
    bool changed = false;
    for (LeaningLine& line : leaning) {
      if (worse[line.line] == 0 || line.cut == 0) continue;
      line.cut = pass + 2 < most_passes ? line.cut / 2 : 0;
      changed = true;
    }
    if (!changed) break;
  }
  return static_cast<Index>(
      std::count_if(leaning.begin(), leaning.end(), [](const LeaningLine& line) { return line.cut > 0; }));
}

}  // namespace flowcage
