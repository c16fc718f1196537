#include "core/grade/boundary_layers.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "core/base/parallel.hpp"
#include "core/grade/blend_layers.hpp"
#include "core/grade/mean_line.hpp"
#include "core/volume/line_curve.hpp"
#include "core/volume/wall_columns.hpp"
#include "core/volume/wall_normals.hpp"

namespace flowcage {
namespace {

/// What a leaning line's first cell is enlarged by.
std::vector<double> lean_factors(const BlockMesh& mesh, const WallBlocks& blocks, const WallColumns& columns,
                                 const std::vector<Vec3>& normals) {
  const std::size_t n = columns.lines.size();
  const auto foot = [&](Index l) -> const Vec3& {
    return mesh.points()[line_point(mesh, blocks, columns.lines[l], 0)];
  };
  std::vector<double> cosine(n, 1);
  for (const auto& face : columns.faces) {
    for (int c = 0; c < 4; ++c) {
      const Vec3& p = foot(face[c]);
      const Vec3 normal = (foot(face[(c + 1) % 4]) - p).cross(foot(face[(c + 3) % 4]) - p).normalized();
      cosine[face[c]] = std::min(cosine[face[c]], normal.dot(normals[face[c]]));
    }
  }
  // On a ridge every neighbour lies below the line's normal plane: the foot itself is the nearest point.
  std::vector<char> ridge(n, 1);
  for (const auto& [a, b] : columns.edges) {
    const Vec3 edge = (foot(b) - foot(a)).normalized();
    constexpr double level = 0.05;
    if (edge.dot(normals[a]) > level) ridge[a] = 0;
    if (edge.dot(normals[b]) < -level) ridge[b] = 0;
  }
  constexpr double most = 1.19;
  std::vector<double> factor(n, 1);
  for (std::size_t l = 0; l < n; ++l) {
    if (ridge[l] == 0) factor[l] = 1 / std::clamp(cosine[l], 1 / most, 1.0);
  }
  return factor;
}

/// Lowers values until those of neighbouring lines differ by no more than `step`.
void bound_steps(std::span<const std::array<Index, 2>> edges, double step, std::vector<double>& value) {
  for (bool changed = true; changed;) {
    changed = false;
    for (const auto& [a, b] : edges) {
      for (const auto& [high, low] : {std::pair{a, b}, std::pair{b, a}}) {
        if (value[high] <= value[low] + step * (1 + 1e-12)) continue;
        value[high] = value[low] + step;
        changed = true;
      }
    }
  }
}

/// Places the graded lines for given weights of the wall's normal in their start slopes.
class LayerBuilder {
 public:
  LayerBuilder(const BlockMesh& mesh, const WallBlocks& blocks, const WallColumns& columns,
               const LayerSettings& settings)
      : mesh_(mesh),
        blocks_(blocks),
        columns_(columns),
        normals_(line_normals(mesh, blocks, columns)),
        lean_(lean_factors(mesh, blocks, columns, normals_)),
        mean_(mesh, blocks, columns, settings) {}

  Index cells() const { return mean_.cells(); }
  const MeanLine& mean() const { return mean_; }

  /// 0 for lines that lean by more than 60 degrees (their curves would bend too far) and shared ones.
  std::vector<double> start_weights() const {
    std::vector<double> weight(columns_.lines.size());
    for (std::size_t l = 0; l < weight.size(); ++l) {
      const Vec3 along = at(columns_.lines[l], 1) - at(columns_.lines[l], 0);
      constexpr double least_cosine = 0.5;
      const bool bends = columns_.rim[l] == 0 && along.normalized().dot(normals_[l]) > least_cosine;
      weight[l] = bends ? 1 : 0;
    }
    return weight;
  }

  /// What the cells over each wall face may not fall below: min(0.3, 0.9 x the least there before).
  std::vector<float> least_values() const {
    const std::vector<float> before = column_values(mesh_, blocks_, columns_);
    const std::size_t faces = columns_.faces.size();
    std::vector<float> least(faces, 0.3F);
    const auto used = std::min<std::size_t>(before.size(), faces * MeanLine::blended);
    for (std::size_t n = 0; n < used; ++n) least[n % faces] = std::min(least[n % faces], 0.9F * before[n]);
    return least;
  }

  LayerReport place(const std::vector<double>& weight, BlockMesh& out) const {
    std::vector<Vec3>& points = out.mutable_points();
    const LayerReport none{cells(), std::numeric_limits<double>::infinity(), 0, 1};
    const LayerReport report = parallel_reduce(
        static_cast<Offset>(columns_.lines.size()), 64, none,
        [&](Offset begin, Offset end) {
          LayerReport part = none;
          for (Offset l = begin; l < end; ++l) {
            const WallLine& line = columns_.lines[l];
            const LineCurve curve = curve_of(l, weight[l]);
            const std::vector<double> s = mean_.carried(curve.lengths(), lean_[l]);
            const PointRow row = line_points(out, blocks_, line);
            for (Index k = 0; k <= part.cells; ++k) {
              // The ends keep every bit.
              const bool inside = k > 0 && k < part.cells;
              points[row[k]] = inside ? curve.at(s[k]) : at(line, k == 0 ? 0 : columns_.layers);
            }
            part.min_height = std::min(part.min_height, s[1]);
            part.max_height = std::max(part.max_height, s[1]);
            for (Index k = 1; k < part.cells; ++k) {
              const double ratio = (s[k + 1] - s[k]) / (s[k] - s[k - 1]);
              part.max_growth = std::max({part.max_growth, ratio, 1 / ratio});
            }
          }
          return part;
        },
        [](const LayerReport& a, const LayerReport& b) {
          return LayerReport{a.cells, std::min(a.min_height, b.min_height),
                             std::max(a.max_height, b.max_height), std::max(a.max_growth, b.max_growth)};
        });
    flatten_symmetry(out, blocks_);
    return report;
  }

 private:
  const Vec3& at(const WallLine& line, Index k) const {
    return mesh_.points()[line_point(mesh_, blocks_, line, k)];
  }
  LineCurve curve_of(Offset l, double weight) const {
    std::vector<Vec3> points = line_positions(mesh_, blocks_, columns_.lines[l], columns_.layers);
    if (weight == 0) return LineCurve(std::move(points));
    const Vec3 along = (points[1] - points[0]).normalized();
    const Vec3 slope = ((1 - weight) * along + weight * normals_[l]).normalized();
    return {std::move(points), slope};
  }

  const BlockMesh& mesh_;
  const WallBlocks& blocks_;
  const WallColumns& columns_;
  std::vector<Vec3> normals_;
  std::vector<double> lean_;
  MeanLine mean_;
};

/// Layers end within so many diagonals of the wall's bounding box beyond the wall.
constexpr double blend_reach = 2;

double wall_diagonal(const BlockMesh& mesh, const WallBlocks& blocks) {
  Box3 box;
  for (Index f = 0; f < blocks.wall.face_count(); ++f) {
    for (const int corner : blocks.seats[f].foot) {
      box.extend(mesh.points()[mesh.complex().hexes[blocks.seats[f].block][corner]]);
    }
  }
  return box.diagonal().norm();
}

/// The sheet of a chord of lines off the wall.
ChordSheet wall_sheet(const BlockMesh& mesh, const WallBlocks& blocks, Index chord) {
  std::vector<SheetStart> starts;
  for (Index f = 0; f < blocks.wall.face_count(); ++f) {
    const SeatEdge edge = seat_edge(blocks, f);
    if (edge.chord == chord) starts.push_back({edge.edge, edge.outward});
  }
  return chord_sheet(mesh, chord, starts);
}

/// #lines of the sheet: which are lines of the columns.
std::vector<char> lines_on_wall(const BlockMesh& mesh, const WallBlocks& blocks, const WallColumns& columns,
                                const ChordSheet& sheet) {
  std::set<std::array<Index, 2>> wall;
  for (const WallLine& line : columns.lines) {
    wall.insert({line_point(mesh, blocks, line, 0), line_point(mesh, blocks, line, 1)});
  }
  std::vector<char> out;
  for (const SheetLine& line : sheet.lines) {
    out.push_back(wall.contains({sheet_point(mesh, line, 0), sheet_point(mesh, line, 1)}) ? 1 : 0);
  }
  return out;
}

/// The mesh with `cells` divisions on the sheet's chord. Line l is divided anew as divide(l, lengths of its
/// old points) says; its ends keep every bit.
template <typename Divide>
BlockMesh redivided(const BlockMesh& mesh, const ChordSheet& sheet, Index cells, const Divide& divide) {
  const HexComplex& complex = mesh.complex();
  std::vector<Index> divisions = mesh.chord_divisions();
  divisions[sheet.chord] = cells;
  BlockMesh out(mesh.shared_complex(), divisions,
                std::vector<Vec3>(BlockMesh::point_count(complex, divisions)));
  std::vector<Vec3>& points = out.mutable_points();
  for (Index b = 0; b < mesh.block_count(); ++b) {
    const auto n = mesh.dims(b);
    if (n != out.dims(b)) continue;
    for (Index k = 0; k <= n[2]; ++k) {
      for (Index j = 0; j <= n[1]; ++j) {
        for (Index i = 0; i <= n[0]; ++i) {
          points[out.point_number(b, i, j, k)] = mesh.points()[mesh.point_number(b, i, j, k)];
        }
      }
    }
  }
  parallel_for(static_cast<Offset>(sheet.lines.size()), 64, [&](Offset begin, Offset end) {
    for (Offset l = begin; l < end; ++l) {
      const SheetLine& line = sheet.lines[l];
      std::vector<Vec3> old = sheet_positions(mesh, sheet, line);
      const Vec3 first = old.front();
      const Vec3 last = old.back();
      const LineCurve curve(std::move(old));
      const std::vector<double> s = divide(l, curve.lengths());
      for (Index t = 0; t <= cells; ++t) {
        points[sheet_point(out, line, t)] = t == 0 ? first : t == cells ? last : curve.at(s[t]);
      }
    }
  });
  return out;
}

BlockMesh insert_along_chord(const BlockMesh& mesh, const WallBlocks& blocks, Index chord,
                             const LayerSettings& settings, LayerReport& report) {
  const WallColumns columns = wall_columns(mesh, blocks, chord);
  const LayerBuilder builder(mesh, blocks, columns, settings);
  const std::vector<float> least = builder.least_values();
  std::vector<double> weight = builder.start_weights();
  WallColumns layered = columns;
  layered.layers = builder.cells();
  const ChordSheet sheet = wall_sheet(mesh, blocks, chord);
  const std::vector<char> on_wall = lines_on_wall(mesh, blocks, columns, sheet);
  const std::vector<double> share =
      own_shares(mesh, sheet, on_wall, {blend_reach * wall_diagonal(mesh, blocks)});
  BlockMesh out = redivided(mesh, sheet, builder.cells(), [&](Offset l, const std::vector<double>& lengths) {
    if (share[l] == 1) return relaxed_spacing(lengths, builder.cells());
    std::vector<double> thin = builder.mean().carried(lengths, 1);
    if (share[l] == 0) return thin;
    return blended(thin, relaxed_spacing(lengths, builder.cells()), share[l]);
  });
  constexpr int passes = 8;
  report = builder.place(weight, out);
  for (int pass = 0; pass < passes; ++pass) {
    const std::vector<float> values = column_values(out, blocks, layered);
    bool any = false;
    for (std::size_t n = 0; n < values.size(); ++n) {
      const std::size_t face = n % columns.faces.size();
      if (values[n] >= least[face]) continue;
      for (const Index l : columns.faces[face]) {
        any = any || weight[l] > 0;
        weight[l] *= 2 * pass < passes ? 0.7 : 0;
      }
    }
    if (!any) break;
    bound_steps(columns.edges, 0.2, weight);
    report = builder.place(weight, out);
  }
  return out;
}

}  // namespace

BlockMesh insert_boundary_layers(const BlockMesh& mesh, const WallBlocks& blocks,
                                 const LayerSettings& settings, LayerReport& report) {
  report = {0, std::numeric_limits<double>::infinity(), 0, 1};
  BlockMesh out = mesh;
  for (const Index chord : line_chords(blocks)) {
    LayerReport part;
    out = insert_along_chord(out, blocks, chord, settings, part);
    report.cells = std::max(report.cells, part.cells);
    report.min_height = std::min(report.min_height, part.min_height);
    report.max_height = std::max(report.max_height, part.max_height);
    report.max_growth = std::max(report.max_growth, part.max_growth);
  }
  return out;
}

}  // namespace flowcage
