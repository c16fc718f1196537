#include "core/grade/boundary_layers.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "core/base/parallel.hpp"
#include "core/mesh/hex_numbering.hpp"
#include "core/volume/line_curve.hpp"
#include "core/volume/wall_columns.hpp"
#include "core/volume/wall_normals.hpp"

namespace flowcage {
namespace {

/// A piece of the wanted size f: linear from fa at a to fb at b; `count`: the integral of 1 / f.
struct Piece {
  double a, b, fa, fb;

  double slope() const { return (fb - fa) / (b - a); }
  double count() const {
    const double q = (fb - fa) / fa;
    const double mean = std::abs(q) < 1e-6 ? fa * (1 + q / 2) : (fb - fa) / std::log1p(q);
    return (b - a) / mean;
  }
  /// Where the integral from a on reaches k.
  double at(double k) const {
    const double x = slope() * k;
    return std::abs(x) < 1e-9 ? a + fa * k * (1 + x / 2) : a + fa / slope() * std::expm1(x);
  }
};

/// The mesh's own cell sizes along a line, linear between the middles of its cells, constant at the ends.
class OwnSizes {
 public:
  explicit OwnSizes(std::span<const double> lengths) {
    knots_.push_back({0, lengths[1] - lengths[0]});
    for (std::size_t k = 0; k + 1 < lengths.size(); ++k) {
      knots_.push_back({(lengths[k] + lengths[k + 1]) / 2, lengths[k + 1] - lengths[k]});
    }
    knots_.push_back({lengths.back(), knots_.back().size});
  }

  /// Pieces of f from `start` on, where f is `height` there and grows by `slope` until it meets these sizes.
  std::vector<Piece> pieces(double start, double height, double slope) const {
    std::vector<Piece> out;
    bool met = false;
    for (std::size_t n = 0; n + 1 < knots_.size(); ++n) {
      const double a = std::max(knots_[n].at, start);
      const double b = knots_[n + 1].at;
      if (!(a < b)) continue;
      const double own_a = size_at(n, a);
      const double own_b = knots_[n + 1].size;
      const double layer_a = height + slope * (a - start);
      const double layer_b = height + slope * (b - start);
      if (met || layer_a >= own_a) {
        met = true;
        out.push_back({a, b, own_a, own_b});
      } else if (layer_b <= own_b) {
        out.push_back({a, b, layer_a, layer_b});
      } else {
        const double t = (own_a - layer_a) / (own_a - layer_a + layer_b - own_b);
        const double c = a + t * (b - a);
        const double size = layer_a + t * (layer_b - layer_a);
        if (c > a) out.push_back({a, c, layer_a, size});
        if (c < b) out.push_back({c, b, size, own_b});
        met = true;
      }
    }
    return out;
  }

 private:
  struct Knot {
    double at, size;
  };
  double size_at(std::size_t n, double s) const {
    const double t = (s - knots_[n].at) / (knots_[n + 1].at - knots_[n].at);
    return knots_[n].size + t * (knots_[n + 1].size - knots_[n].size);
  }
  std::vector<Knot> knots_;
};

double count_of(const std::vector<Piece>& pieces) {
  double sum = 0;
  for (const Piece& piece : pieces) sum += piece.count();
  return sum;
}

/// The cells that follow height and growth exactly: at most half of the line.
std::vector<double> exact_cells(double length, const LayerSettings& settings) {
  std::vector<double> cells;
  const Index wanted = std::max<Index>(2, settings.layers);
  double sum = 0;
  double size = settings.first_height;
  for (Index k = 0; k < wanted && sum + size <= length / 2; ++k) {
    cells.push_back(size);
    sum += size;
    if (k > 0) size *= settings.growth;
  }
  return cells;
}

/// The slope of f with which the pieces hold `count` cells; at most `most`.
double slope_for(const OwnSizes& own, double start, double height, double most, double count) {
  double low = 0;
  double high = most;
  for (int step = 0; step < 60; ++step) {
    const double middle = (low + high) / 2;
    (count_of(own.pieces(start, height, middle)) > count ? low : high) = middle;
  }
  return high;
}

/// The line whose lengths are the lines' geometric means, its new cells, and how they are carried to a line.
class MeanLine {
 public:
  /// Cells are the same on all lines as long as they are thinner than this part of the mesh's own first cell.
  /// Where neighbouring lines differ in growth, a cell's centre moves along the wall from layer to layer; in
  /// cells of aspect ratio a that tilts the line between centres by about a / 12 times the difference.
  static constexpr double thin = 1.0 / 30;
  /// From so many of the mesh's own layers on, each line keeps its own.
  static constexpr Index blended = 3;

  MeanLine(const BlockMesh& mesh, const WallBlocks& blocks, const WallColumns& columns,
           const LayerSettings& settings) {
    const Index n = columns.layers;
    lengths_.assign(n + 1, 0);
    for (const WallLine& line : columns.lines) {
      const std::vector<Vec3> points = line_positions(mesh, blocks, line, n);
      double s = 0;
      for (Index k = 1; k <= n; ++k) {
        s += (points[k] - points[k - 1]).norm();
        lengths_[k] += std::log(std::max(s, 1e-300)) / static_cast<double>(columns.lines.size());
      }
    }
    for (Index k = 1; k <= n; ++k) lengths_[k] = std::exp(lengths_[k]);
    sigma_.push_back(0);
    for (const double cell : graded_cells(lengths_, settings)) {
      sigma_.push_back(sigma_.back() + cell);
    }
    exact_ = std::min(static_cast<Index>(exact_cells(lengths_.back(), settings).size()), cells());
    while (exact_ < cells() && sigma_[exact_ + 1] - sigma_[exact_] < thin * lengths_[1]) ++exact_;
    const double reach = lengths_[std::min(n, blended)];
    end_ = static_cast<Index>(std::lower_bound(sigma_.begin(), sigma_.end(), reach) - sigma_.begin());
  }

  Index cells() const { return static_cast<Index>(sigma_.size()) - 1; }

  /// Lengths of a line's new points, the exact ones times `lean`.
  std::vector<double> carried(const std::vector<double>& own, double lean) const {
    std::vector<double> s(sigma_.size());
    std::size_t n = 0;
    for (std::size_t k = 1; k < s.size(); ++k) {
      while (n + 2 < lengths_.size() && lengths_[n + 1] < sigma_[k]) ++n;
      const double t = (sigma_[k] - lengths_[n]) / (lengths_[n + 1] - lengths_[n]);
      s[k] = own[n] + t * (own[n + 1] - own[n]);
    }
    s.back() = own.back();
    if (exact_ == 0) return s;
    // log rho falls to 0 with the logarithm of the length, smoothly and so slowly that the lengths keep
    // rising.
    const double rho = std::log(lean * sigma_[exact_] / s[exact_]);
    const double start = std::log(s[exact_]);
    const double range =
        std::min(std::max(std::log(s[end_]) - start, 3 * std::abs(rho)), std::log(s.back()) - start);
    for (Index k = 1; k < cells(); ++k) {
      const double x = range > 0 ? std::clamp((std::log(s[k]) - start) / range, 0.0, 1.0) : 1;
      s[k] = k <= exact_ ? lean * sigma_[k] : s[k] * std::exp(rho * (1 - x * x * (3 - 2 * x)));
    }
    return s;
  }

 private:
  std::vector<double> lengths_, sigma_;
  Index exact_ = 0, end_ = 0;  ///< cells that are the same on all lines; where they follow their own
};

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

/// Which of a chord's edges run away from the wall (1) or toward it (0), by edge; 2 elsewhere.
std::vector<std::uint8_t> chord_directions(const WallBlocks& blocks, Index chord) {
  const HexComplex& complex = *blocks.complex;
  std::vector<std::vector<Index>> quads_of(complex.edges.size());
  std::vector<std::array<Index, 4>> sides(complex.quads.size(), {no_index, no_index, no_index, no_index});
  std::map<std::array<Index, 2>, Index> edge_of;
  for (std::size_t e = 0; e < complex.edges.size(); ++e) {
    const auto [low, high] = std::minmax(complex.edges[e][0], complex.edges[e][1]);
    edge_of[{low, high}] = static_cast<Index>(e);
  }
  for (std::size_t q = 0; q < complex.quads.size(); ++q) {
    for (int c = 0; c < 4; ++c) {
      const auto [low, high] = std::minmax(complex.quads[q][c], complex.quads[q][(c + 1) % 4]);
      sides[q][c] = edge_of.at({low, high});
      if (complex.edge_chord[sides[q][c]] == chord) quads_of[sides[q][c]].push_back(static_cast<Index>(q));
    }
  }
  std::vector<std::uint8_t> direction(complex.edges.size(), 2);
  std::vector<Index> front;
  for (std::size_t f = 0; f < blocks.seats.size(); ++f) {
    const SeatEdge edge = seat_edge(blocks, static_cast<Index>(f));
    if (edge.chord != chord || direction[edge.edge] != 2) continue;
    direction[edge.edge] = edge.outward ? 1 : 0;
    front.push_back(edge.edge);
  }
  while (!front.empty()) {
    const Index e = front.back();
    front.pop_back();
    for (const Index q : quads_of[e]) {
      for (int c = 0; c < 4; ++c) {
        if (sides[q][c] != e) continue;
        const Index opposite = sides[q][(c + 2) % 4];
        if (direction[opposite] != 2) continue;
        // Round the quad the two run against each other.
        const bool along = complex.edges[e][0] == complex.quads[q][c];
        const bool opposite_along = complex.edges[opposite][0] == complex.quads[q][(c + 2) % 4];
        const bool outward = direction[e] == 1;
        direction[opposite] = (outward == (along != opposite_along)) ? 1 : 0;
        front.push_back(opposite);
      }
    }
  }
  return direction;
}

/// The mesh with `cells` divisions on a chord. Every line of points along it is divided anew as `divide` says
/// (lengths of the line's old points from the wall's end on -> of its new ones); seats' lines come later.
template <typename Divide>
BlockMesh redivided(const BlockMesh& mesh, const WallBlocks& blocks, Index chord, Index cells,
                    const Divide& divide) {
  std::vector<Index> divisions = mesh.chord_divisions();
  divisions[chord] = cells;
  const HexComplex& complex = mesh.complex();
  const std::vector<std::uint8_t> direction = chord_directions(blocks, chord);
  BlockMesh out(mesh.shared_complex(), divisions,
                std::vector<Vec3>(BlockMesh::point_count(complex, divisions)));
  std::vector<Vec3>& points = out.mutable_points();
  std::vector<char> seated(complex.hexes.size(), 0);
  for (std::size_t f = 0; f < blocks.seats.size(); ++f) {
    if (seat_edge(blocks, static_cast<Index>(f)).chord == chord) seated[blocks.seats[f].block] = 1;
  }
  for (Index b = 0; b < mesh.block_count(); ++b) {
    int axis = no_index;
    bool outward = true;
    for (int e = 0; e < 12; ++e) {
      const Index edge = complex.hex_edges[b][e];
      if (complex.edge_chord[edge] != chord) continue;
      axis = e / 4;
      const bool with_block = complex.edges[edge][0] == complex.hexes[b][hex_edges[e][0]];
      outward = (direction[edge] == 1) == with_block;
    }
    const auto from = mesh.dims(b);
    const auto to = out.dims(b);
    if (axis == no_index) {
      for (Index k = 0; k <= to[2]; ++k) {
        for (Index j = 0; j <= to[1]; ++j) {
          for (Index i = 0; i <= to[0]; ++i) {
            points[out.point_number(b, i, j, k)] = mesh.points()[mesh.point_number(b, i, j, k)];
          }
        }
      }
      continue;
    }
    if (seated[b] != 0) continue;
    const int u = (axis + 1) % 3;
    const int v = (axis + 2) % 3;
    for (Index j = 0; j <= from[v]; ++j) {
      for (Index i = 0; i <= from[u]; ++i) {
        const auto number = [&](const BlockMesh& of, Index t) {
          std::array<Index, 3> at{};
          at[axis] = outward ? t : of.dims(b)[axis] - t;
          at[u] = i;
          at[v] = j;
          return of.point_number(b, at[0], at[1], at[2]);
        };
        std::vector<Vec3> line(from[axis] + 1);
        for (Index t = 0; t <= from[axis]; ++t) line[t] = mesh.points()[number(mesh, t)];
        const Vec3 first = line.front();
        const Vec3 last = line.back();
        const LineCurve curve(std::move(line));
        const std::vector<double> s = divide(curve.lengths());
        for (Index t = 0; t <= cells; ++t) {
          points[number(out, t)] = t == 0 ? first : t == cells ? last : curve.at(s[t]);
        }
      }
    }
  }
  return out;
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

}  // namespace

std::vector<double> graded_cells(std::span<const double> lengths, const LayerSettings& settings) {
  const double length = lengths.back();
  std::vector<double> cells = exact_cells(length, settings);
  double start = 0;
  for (const double cell : cells) start += cell;
  const double size = cells.empty() ? settings.first_height : cells.back();
  const OwnSizes own(lengths);
  const double most = std::log(settings.growth);
  const auto rest = static_cast<Index>(std::ceil(count_of(own.pieces(start, size, most)) - 1e-9));
  const std::vector<Piece> pieces = own.pieces(start, size, slope_for(own, start, size, most, rest));
  const double found = count_of(pieces);  // `rest` to within bisection
  double s = start;
  double before = 0;
  std::size_t n = 0;
  for (Index k = 1; k <= rest; ++k) {
    const double target = found * static_cast<double>(k) / static_cast<double>(rest);
    while (n + 1 < pieces.size() && before + pieces[n].count() < target) before += pieces[n++].count();
    const double next = k == rest ? length : std::min(length, pieces[n].at(target - before));
    cells.push_back(next - s);
    s = next;
  }
  return cells;
}

namespace {

BlockMesh insert_along_chord(const BlockMesh& mesh, const WallBlocks& blocks, Index chord,
                             const LayerSettings& settings, LayerReport& report) {
  const WallColumns columns = wall_columns(mesh, blocks, chord);
  const LayerBuilder builder(mesh, blocks, columns, settings);
  const std::vector<float> least = builder.least_values();
  std::vector<double> weight = builder.start_weights();
  WallColumns layered = columns;
  layered.layers = builder.cells();
  BlockMesh out = redivided(mesh, blocks, chord, builder.cells(), [&](const std::vector<double>& lengths) {
    return builder.mean().carried(lengths, 1);
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
