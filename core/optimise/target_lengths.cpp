#include "core/optimise/target_lengths.hpp"

#include "core/base/csr.hpp"
#include "core/base/parallel.hpp"

namespace flowcage {
namespace {

constexpr Offset grain = 8192;

/// Edges drawn once; cell n's are cell_edges[n], slots holds 12 * cell + edge of each cell at an edge.
struct Edges {
  std::vector<std::array<Index, 2>> ends;
  std::vector<std::array<Index, 12>> cell_edges;
  Csr<Offset> slots;
};

Edges draw_edges(std::span<const HexPoints> cells) {
  struct Use {
    Index low, high;
    Offset slot;
  };
  std::vector<Use> uses;
  uses.reserve(12 * cells.size());
  for (std::size_t n = 0; n < cells.size(); ++n) {
    for (int e = 0; e < 12; ++e) {
      const auto [low, high] = std::minmax(cells[n][hex_edges[e][0]], cells[n][hex_edges[e][1]]);
      uses.push_back({low, high, static_cast<Offset>(12 * n) + e});
    }
  }
  std::sort(uses.begin(), uses.end(), [](const Use& a, const Use& b) {
    return std::tie(a.low, a.high, a.slot) < std::tie(b.low, b.high, b.slot);
  });
  Edges out;
  out.cell_edges.resize(cells.size());
  for (const Use& use : uses) {
    if (out.ends.empty() || out.ends.back() != std::array{use.low, use.high}) {
      out.ends.push_back({use.low, use.high});
      out.slots.offsets.push_back(out.slots.offsets.back());
    }
    out.cell_edges[use.slot / 12][use.slot % 12] = static_cast<Index>(out.ends.size()) - 1;
    out.slots.values.push_back(use.slot);
    ++out.slots.offsets.back();
  }
  return out;
}

double median(std::vector<double> values) {
  if (values.empty()) return 1;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Mean of the values of the edges parallel to edge e in its cells, those of `known` alone; NaN if none is.
double parallel_mean(const Edges& edges, Index e, const std::vector<double>& values,
                     const std::vector<std::uint8_t>& known) {
  double sum = 0;
  int count = 0;
  for (const Offset slot : edges.slots[e]) {
    const auto axis = static_cast<int>(slot % 12) / 4;
    for (int n = 4 * axis; n < 4 * axis + 4; ++n) {
      const Index other = edges.cell_edges[slot / 12][n];
      if (other == e || known[other] == 0) continue;
      sum += values[other];
      ++count;
    }
  }
  return count > 0 ? sum / count : std::numeric_limits<double>::quiet_NaN();
}

/// One Jacobi sweep over the edges of `free`: half the value, half the mean of the parallel ones.
void average(const Edges& edges, const std::vector<std::uint8_t>& free, std::vector<double>& values) {
  const std::vector<std::uint8_t> all(values.size(), 1);
  const std::vector<double> old = values;
  parallel_for(static_cast<Offset>(values.size()), grain, [&](Offset begin, Offset end) {
    for (Offset e = begin; e < end; ++e) {
      if (free[e] == 0) continue;
      const double mean = parallel_mean(edges, static_cast<Index>(e), old, all);
      if (!std::isnan(mean)) values[e] = 0.5 * (old[e] + mean);
    }
  });
}

/// Gives a value to every edge not `known`, front by front from the known ones.
void fill(const Edges& edges, std::vector<std::uint8_t> known, std::vector<double>& values) {
  for (bool changed = true; changed;) {
    std::vector<std::uint8_t> reached = known;
    std::vector<double> next = values;
    parallel_for(static_cast<Offset>(values.size()), grain, [&](Offset begin, Offset end) {
      for (Offset e = begin; e < end; ++e) {
        if (known[e] != 0) continue;
        const double mean = parallel_mean(edges, static_cast<Index>(e), values, known);
        if (std::isnan(mean)) continue;
        next[e] = mean;
        reached[e] = 1;
      }
    });
    changed = reached != known;
    known.swap(reached);
    values.swap(next);
  }
}

std::vector<double> own_log_lengths(std::span<const Vec3> positions, std::span<const HexPoints> cells,
                                    std::span<const std::uint8_t> moves, const Edges& edges,
                                    const TargetLengthSettings& settings) {
  const std::size_t count = edges.ends.size();
  std::vector<std::uint8_t> good(cells.size());
  parallel_for(static_cast<Offset>(cells.size()), grain, [&](Offset begin, Offset end) {
    for (Offset n = begin; n < end; ++n) {
      HexCornerPoints p;
      for (int c = 0; c < 8; ++c) p[c] = positions[cells[n][c]];
      good[n] = min_scaled_jacobian(p) > settings.good_scaled_jacobian ? 1 : 0;
    }
  });
  std::vector<double> values(count);
  std::vector<std::uint8_t> reliable(count), free(count), filled(count);
  std::vector<double> positive;
  for (std::size_t e = 0; e < count; ++e) {
    const auto [a, b] = edges.ends[e];
    const double length = (positions[b] - positions[a]).stableNorm();
    values[e] = std::log(length);
    free[e] = moves[a] != 0 || moves[b] != 0 ? 1 : 0;
    if (!(length > 0)) continue;
    positive.push_back(values[e]);
    bool all_good = true;
    for (const Offset slot : edges.slots[static_cast<Index>(e)]) all_good = all_good && good[slot / 12] != 0;
    reliable[e] = all_good || free[e] == 0 ? 1 : 0;
  }
  // Layers without one reliable edge: the geometric mean of their own lengths is what is left to go by.
  const double middle = median(std::move(positive));
  for (std::size_t e = 0; e < count; ++e) {
    if (!std::isfinite(values[e])) values[e] = middle;
    filled[e] = reliable[e] == 0 ? 1 : 0;
  }
  fill(edges, reliable, values);
  for (int n = 0; n < settings.fill_sweeps; ++n) average(edges, filled, values);
  for (int n = 0; n < settings.smoothing_sweeps; ++n) average(edges, free, values);
  return values;
}

/// Side of a cube of the mean volume; of the mean edge where volumes cancel.
double mean_size(std::span<const Vec3> positions, std::span<const HexPoints> cells, const Edges& edges) {
  double volume = 0;
  double length = 0;
  for (const HexPoints& cell : cells) {
    for (int c = 0; c < 8; ++c) {
      const Vec3& p = positions[cell[c]];
      const auto edge = [&](int a) -> Vec3 {
        return (hex_corner_ijk[c][a] == 0 ? 1.0 : -1.0) * (positions[cell[hex_corner_neighbour(c, a)]] - p);
      };
      volume += 0.125 * edge(0).dot(edge(1).cross(edge(2)));
    }
  }
  for (const auto& [a, b] : edges.ends) length += (positions[b] - positions[a]).stableNorm();
  const double by_volume = std::cbrt(std::max(0.0, volume) / static_cast<double>(cells.size()));
  const double by_length = length / static_cast<double>(edges.ends.size());
  return by_volume > 0.1 * by_length ? by_volume : by_length;
}

}  // namespace

std::vector<std::array<float, 12>> inverse_target_lengths(std::span<const Vec3> positions,
                                                          std::span<const HexPoints> cells,
                                                          std::span<const std::uint8_t> moves,
                                                          const TargetLengthSettings& settings) {
  std::vector<std::array<float, 12>> out(cells.size());
  if (cells.empty()) return out;
  const Edges edges = draw_edges(cells);
  if (settings.shape == TargetShape::equal_cubes) {
    std::array<float, 12> all{};
    const double size = mean_size(positions, cells, edges);
    all.fill(size > 0 ? static_cast<float>(1 / size) : 1.0F);
    std::fill(out.begin(), out.end(), all);
    return out;
  }
  const std::vector<double> lengths = own_log_lengths(positions, cells, moves, edges, settings);
  for (std::size_t n = 0; n < cells.size(); ++n) {
    for (int e = 0; e < 12; ++e) out[n][e] = static_cast<float>(std::exp(-lengths[edges.cell_edges[n][e]]));
  }
  return out;
}

}  // namespace flowcage
