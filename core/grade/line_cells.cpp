#include "core/grade/line_cells.hpp"

#include <algorithm>
#include <cmath>

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

  /// Pieces of these sizes themselves.
  std::vector<Piece> own_pieces() const {
    std::vector<Piece> out;
    for (std::size_t n = 0; n + 1 < knots_.size(); ++n) {
      out.push_back({knots_[n].at, knots_[n + 1].at, knots_[n].size, knots_[n + 1].size});
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

/// Limits of `count` cells of sizes in proportion to f: the integral of 1 / f to limit k is the same part of
/// the whole. From `start` on, without it; the last is `length`.
std::vector<double> cell_limits(const std::vector<Piece>& pieces, double start, double length, Index count) {
  const double found = count_of(pieces);
  std::vector<double> limits;
  double before = 0;
  std::size_t n = 0;
  double s = start;
  for (Index k = 1; k <= count; ++k) {
    const double target = found * static_cast<double>(k) / static_cast<double>(count);
    while (n + 1 < pieces.size() && before + pieces[n].count() < target) before += pieces[n++].count();
    s = k == count ? length : std::min(length, pieces[n].at(target - before));
    limits.push_back(s);
  }
  return limits;
}

}  // namespace

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

std::vector<double> graded_cells(std::span<const double> lengths, const LayerSettings& settings) {
  const double length = lengths.back();
  std::vector<double> cells = exact_cells(length, settings);
  double start = 0;
  for (const double cell : cells) start += cell;
  const double size = cells.empty() ? settings.first_height : cells.back();
  const OwnSizes own(lengths);
  const double most = std::log(settings.growth);
  const auto exact = static_cast<Index>(cells.size());
  const auto least = exact + static_cast<Index>(std::ceil(count_of(own.pieces(start, size, most)) - 1e-9));
  const Index rest = (least + settings.multiple - 1) / settings.multiple * settings.multiple - exact;
  // `rest` to within bisection.
  const std::vector<Piece> pieces = own.pieces(start, size, slope_for(own, start, size, most, rest));
  double s = start;
  for (const double limit : cell_limits(pieces, start, length, rest)) {
    cells.push_back(limit - s);
    s = limit;
  }
  return cells;
}

std::vector<double> relaxed_spacing(std::span<const double> lengths, Index count) {
  const auto n = static_cast<double>(lengths.size() - 1);
  // (exp(c n) - 1) / c, the number of cells, rises with c.
  const auto cells = [&](double c) { return std::abs(c * n) < 1e-9 ? n : std::expm1(c * n) / c; };
  double low = -700 / n;
  double high = 700 / n;
  for (int step = 0; step < 200 && low < high; ++step) {
    const double middle = (low + high) / 2;
    (cells(middle) > count ? high : low) = middle;
  }
  const double c = (low + high) / 2;
  const std::vector<Piece> pieces = OwnSizes(lengths).own_pieces();
  const double whole = count_of(pieces);
  std::vector<double> out{0};
  double before = 0;
  std::size_t piece = 0;
  for (Index k = 1; k < count; ++k) {
    const double left = count - k;
    const double t = n - (std::abs(c * n) < 1e-9 ? left : std::log1p(c * left) / c);
    const double target = whole * t / n;
    while (piece + 1 < pieces.size() && before + pieces[piece].count() < target) {
      before += pieces[piece++].count();
    }
    out.push_back(std::min(lengths.back(), pieces[piece].at(target - before)));
  }
  out.push_back(lengths.back());
  return out;
}

}  // namespace flowcage
