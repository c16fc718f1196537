#include "core/project/chain_places.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/base/error.hpp"

namespace flowcage {
namespace {

std::size_t piece_at(const FeaturePath& path, double s) {
  const auto above = std::upper_bound(path.offsets.begin() + 1, path.offsets.end() - 1, s);
  return static_cast<std::size_t>(above - path.offsets.begin()) - 1;
}

double wrapped(const FeaturePath& path, double s) {
  const double length = path.length();
  if (!path.closed || !(length > 0)) return std::clamp(s, 0.0, length);
  s = std::fmod(s, length);
  return s < 0 ? s + length : s;
}

CurvePoint point_on_piece(const TargetSurface& target, const FeaturePiece& piece, double along) {
  const bool forward = piece.s_end >= piece.s_begin;
  CurvePoint point = target.chain_point(piece.chain, piece.s_begin + (forward ? along : -along));
  if (!forward) point.tangent = -point.tangent;
  return point;
}

/// Joints of the path where it turns by more than the angle: path lengths, ascending.
std::vector<double> kinks_of(const TargetSurface& target, const FeaturePath& path, double angle) {
  std::vector<double> kinks;
  const std::size_t n = path.pieces.size();
  for (std::size_t p = 0; p < n; ++p) {
    if (p + 1 == n && !path.closed) break;
    const double length = path.offsets[p + 1] - path.offsets[p];
    const Vec3 before = point_on_piece(target, path.pieces[p], length).tangent;
    const Vec3 after = point_on_piece(target, path.pieces[(p + 1) % n], 0).tangent;
    if (before.dot(after) < std::cos(angle)) kinks.push_back(path.offsets[p + 1]);
  }
  return kinks;
}

/// Where a quarter, half and three quarters of a bend's turn are done.
struct Bend {
  std::array<double, 3> at;
};

/// How far the path has turned up to places s, radians; turns at joints are left out: those are kinks_of.
struct TurnTable {
  std::vector<double> s{0}, turned{0};  ///< ascending

  double at(double place) const {
    const auto k = static_cast<std::size_t>(std::upper_bound(s.begin() + 1, s.end() - 1, place) - s.begin());
    const double part = (place - s[k - 1]) / (s[k] - s[k - 1]);
    return turned[k - 1] + part * (turned[k] - turned[k - 1]);
  }
  double place_of(double turn) const {
    const auto k = static_cast<std::size_t>(std::lower_bound(turned.begin() + 1, turned.end() - 1, turn) -
                                            turned.begin());
    const double part = (turn - turned[k - 1]) / std::max(turned[k] - turned[k - 1], 1e-300);
    return s[k - 1] + std::clamp(part, 0.0, 1.0) * (s[k] - s[k - 1]);
  }
};

/// Adds the stretch of the path from the table's end to s; halves it where it turns much, because the rim
/// that ends a thin strip turns back within a thousandth of an edge.
void add_turn(const TargetSurface& target, const FeaturePath& path, const Vec3& before, double s,
              const Vec3& tangent, int depth, TurnTable& table) {
  constexpr double small_turn = 0.2;
  constexpr int most_halvings = 12;
  const double turn = std::atan2(before.cross(tangent).norm(), before.dot(tangent));
  if (turn > small_turn && depth < most_halvings) {
    const double middle = 0.5 * (table.s.back() + s);
    const Vec3 there = point_on_path(target, path, middle).tangent;
    add_turn(target, path, before, middle, there, depth + 1, table);
    add_turn(target, path, there, s, tangent, depth + 1, table);
    return;
  }
  table.s.push_back(s);
  table.turned.push_back(table.turned.back() + (turn > small_turn ? 0 : turn));
}

/// Places where the path turns by more than a right angle's two thirds within a quarter of an edge without a
/// joint: the nose of a section. Without a vertex there the surface beside it folds round the bend.
std::vector<Bend> bends_of(const TargetSurface& target, const FeaturePath& path, double edge) {
  constexpr double least_turn = std::numbers::pi / 3;
  const double window = 0.25 * edge;
  const auto n = static_cast<std::size_t>(16 * path.length() / window);
  if (n <= 16) return {};
  TurnTable table;
  Vec3 before = point_on_path(target, path, 0).tangent;
  for (std::size_t i = 1; i <= n; ++i) {
    const double s = path.length() * static_cast<double>(i) / static_cast<double>(n);
    const Vec3 tangent = point_on_path(target, path, s).tangent;
    add_turn(target, path, before, s, tangent, 0, table);
    before = tangent;
  }
  std::vector<Bend> bends;
  const double last = path.length() - window;
  const auto turn_from = [&](std::size_t i) { return table.at(table.s[i] + window) - table.turned[i]; };
  for (std::size_t i = 0; table.s[i] <= last; ++i) {
    double most = turn_from(i);
    if (most < least_turn) continue;
    std::size_t best = i;
    for (; table.s[i] <= last && turn_from(i) >= least_turn; ++i) {
      if (turn_from(i) > most) best = i;
      most = std::max(most, turn_from(i));
    }
    const double start = table.turned[best];
    bends.push_back({{table.place_of(start + 0.25 * most), table.place_of(start + 0.5 * most),
                      table.place_of(start + 0.75 * most)}});
    --i;
  }
  return bends;
}

/// Moves the free places along the path so that distances to the cage and stretch against it are least
/// squares, in Gauss-Seidel sweeps: Viterbi's places are samples of the graph.
void relax_places(const TargetSurface& target, const DrawnChain& query, const std::vector<bool>& pinned,
                  ChainMatch& match) {
  const std::size_t n = query.lengths.size();
  const double total = match.path.length();
  double drawn = 0;
  for (const double length : query.lengths) drawn += length;
  const double ratio = total / drawn;
  std::vector<double>& s = match.s;
  double moved_most = total;
  for (int sweep = 0; sweep < 200 && moved_most > 1e-10 * total; ++sweep) {
    moved_most = 0;
    for (std::size_t k = query.closed ? 0 : 1; k < n; ++k) {
      if (pinned[k]) continue;
      const double before = k == 0 ? s[n - 1] - total : s[k - 1];
      const double after = s[k + 1];
      const double length_before = ratio * query.lengths[k == 0 ? n - 1 : k - 1];
      const double length_after = ratio * query.lengths[k];
      const CurvePoint at = point_on_path(target, match.path, s[k]);
      const double to_control = (query.controls[k] - at.position).dot(at.tangent);
      const double stretch = before + length_before - s[k] + after - length_after - s[k];
      const double margin = 0.1 * (after - before);
      const double moved = std::clamp(s[k] + (to_control + stretch) / 3, before + margin, after - margin);
      moved_most = std::max(moved_most, std::abs(moved - s[k]));
      s[k] = moved;
      if (query.closed && k == 0) s[n] = s[0] + total;
    }
  }
}

/// Slopes of the cubic spline through s (natural at ends, periodic on loops), cut back where Fritsch and
/// Carlson's condition for a monotone cubic asks for it.
std::vector<double> monotone_slopes(const std::vector<double>& s, bool closed) {
  const std::size_t n = s.size() - 1;
  std::vector<double> step(n);
  for (std::size_t i = 0; i < n; ++i) step[i] = s[i + 1] - s[i];
  std::vector<double> m(n + 1);
  m[0] = step[0];
  m[n] = step[n - 1];
  for (std::size_t i = 1; i < n; ++i) m[i] = 0.5 * (step[i - 1] + step[i]);
  if (closed) m[0] = m[n] = 0.5 * (step[0] + step[n - 1]);
  // m[i-1] + 4 m[i] + m[i+1] = 3 (step[i-1] + step[i]) inside, 2 m[0] + m[1] = 3 step[0] at natural ends:
  // diagonally dominant, so sweeps converge by a factor 4 each.
  for (int sweep = 0; sweep < 60; ++sweep) {
    if (closed) {
      m[0] = m[n] = n == 1 ? step[0] : (3 * (step[n - 1] + step[0]) - m[n - 1] - m[1]) / 4;
    } else {
      m[0] = (3 * step[0] - m[1]) / 2;
      m[n] = (3 * step[n - 1] - m[n - 1]) / 2;
    }
    for (std::size_t i = 1; i < n; ++i) m[i] = (3 * (step[i - 1] + step[i]) - m[i - 1] - m[i + 1]) / 4;
  }
  for (std::size_t i = 0; i <= n; ++i) {
    double limit = 3 * std::min(i > 0 ? step[i - 1] : (closed ? step[n - 1] : step[0]),
                                i < n ? step[i] : (closed ? step[0] : step[n - 1]));
    m[i] = std::clamp(m[i], 0.05 * limit, limit);
  }
  return m;
}

/// Fills w, slope and the table of a match whose places s are final.
void weigh_places(const TargetSurface& target, bool closed, double kink_angle, ChainMatch& match) {
  constexpr std::size_t steps_per_segment = 256;
  const std::size_t segments = match.s.size() - 1;
  const std::size_t n = steps_per_segment * segments;
  const double first = match.s.front();
  const double step = (match.s.back() - first) / static_cast<double>(n);
  const double edge = step * steps_per_segment;
  std::vector<Vec3> tangents(n + 1);
  for (std::size_t i = 0; i <= n; ++i) {
    match.table_s.push_back(first + step * static_cast<double>(i));
    tangents[i] = point_on_path(target, match.path, match.table_s[i]).tangent;
  }
  // Curvature per step; a joint where the path turns a corner is no curvature.
  std::vector<double> curvature(n);
  for (std::size_t i = 0; i < n; ++i) curvature[i] = (tangents[i + 1] - tangents[i]).norm() / step;
  for (const double kink : kinks_of(target, match.path, kink_angle)) {
    const double from_first = closed ? wrapped(match.path, kink - first) : kink - first;
    const Offset at = static_cast<Offset>(std::floor(from_first / step));
    for (Offset i = std::max<Offset>(at - 1, 0); i <= std::min<Offset>(at + 1, static_cast<Offset>(n) - 1);
         ++i) {
      curvature[i] = 0;
    }
  }
  std::vector<double> density(n + 1, 1.0);
  for (std::size_t i = 0; i <= n; ++i) {
    const double before = i > 0 ? curvature[i - 1] : (closed ? curvature[n - 1] : curvature[0]);
    const double after = i < n ? curvature[i] : (closed ? curvature[0] : curvature[n - 1]);
    density[i] += std::pow(0.5 * (before + after) * edge, 0.75);
  }
  // Twice a running mean over a thirtieth of an edge: jumps of curvature must not become kinks of s(t).
  for (int pass = 0; pass < 2; ++pass) {
    constexpr Offset half = 4;
    std::vector<double> smooth(n + 1);
    for (Offset i = 0; i <= static_cast<Offset>(n); ++i) {
      double sum = 0;
      for (Offset k = i - half; k <= i + half; ++k) {
        Offset at = k;
        if (closed) {
          at = (k + static_cast<Offset>(n)) % static_cast<Offset>(n);
        } else if (k < 0 || k > static_cast<Offset>(n)) {
          at = k < 0 ? -k : 2 * static_cast<Offset>(n) - k;
        }
        sum += density[at];
      }
      smooth[i] = sum / (2 * half + 1);
    }
    density = std::move(smooth);
  }
  match.table_w.push_back(0);
  for (std::size_t i = 1; i <= n; ++i) {
    match.table_w.push_back(match.table_w.back() + 0.5 * step * (density[i - 1] + density[i]));
  }
  match.table_density = std::move(density);
  for (const double s : match.s) {
    const double x = std::clamp((s - first) / step, 0.0, static_cast<double>(n));
    const std::size_t i = std::min(static_cast<std::size_t>(x), n - 1);
    const double part = x - static_cast<double>(i);
    const double d = match.table_density[i];
    match.w.push_back(match.table_w[i] + step * part * (d + 0.5 * part * (match.table_density[i + 1] - d)));
  }
  match.slope = monotone_slopes(match.w, closed);
}

ChainMatch without_weights(ChainMatch match) {
  match.w.clear();
  match.slope.clear();
  match.table_s.clear();
  match.table_w.clear();
  match.table_density.clear();
  match.pinned.clear();
  match.kept.clear();
  return match;
}

/// Vertices of a chain that are held at places of its path.
class Pins {
 public:
  Pins(bool closed, ChainMatch& match) : closed_(closed), match_(match), held_(match.s.size(), false) {
    if (!closed) held_.front() = held_.back() = true;
  }
  double mean_edge() const { return total() / static_cast<double>(last()); }

  /// The nearest free vertex; false if there is none within half an edge, or if it would pass another.
  bool add_nearest(double at) {
    std::size_t nearest = last();
    double distance = 0.5 * mean_edge();
    for (std::size_t k = 0; k < last(); ++k) {
      const double d = std::abs(closed_ ? std::remainder(match_.s[k] - at, total()) : match_.s[k] - at);
      if (d > distance || held_[k]) continue;
      distance = d;
      nearest = k;
    }
    if (nearest == last()) return false;
    const double moved = unwrapped(nearest, at);
    const double before = nearest > 0 ? match_.s[nearest - 1] : match_.s[last() - 1] - total();
    return moved > before && moved < match_.s[nearest + 1] && add(static_cast<Offset>(nearest), at);
  }

  /// Two vertices with a short edge between them (the rim that ends a thin strip) to both sides of the bend;
  /// false where the cage has no such edge there.
  bool add_short_edge(const DrawnChain& drawn, const Bend& bend) {
    constexpr double is_short = 1.0 / 3;
    std::size_t nearest = last();
    double distance = 0.5 * mean_edge();
    for (std::size_t k = 1; k + 2 <= last(); ++k) {
      const double neighbours = std::min(drawn.lengths[k - 1], drawn.lengths[k + 1]);
      if (held_[k] || held_[k + 1] || drawn.lengths[k] > is_short * neighbours) continue;
      const double d = std::abs(0.5 * (match_.s[k] + match_.s[k + 1]) - bend.at[1]);
      if (d > distance || match_.s[k - 1] >= bend.at[0] || match_.s[k + 2] <= bend.at[2]) continue;
      distance = d;
      nearest = k;
    }
    if (nearest == last()) return false;
    for (const std::size_t side : {0U, 1U}) {
      add(static_cast<Offset>(nearest + side), bend.at[2 * side]);
      match_.kept.push_back(bend.at[2 * side]);
    }
    return true;
  }

  bool add(Offset vertex, double at) {
    const auto k = static_cast<std::size_t>(vertex);
    if (held_[k]) return false;
    match_.s[k] = unwrapped(k, at);
    match_.pinned.push_back(match_.s[k]);
    held_[k] = true;
    if (k == 0) {
      match_.s[last()] = match_.s[0] + total();
      held_[last()] = true;
    }
    return true;
  }

  /// Lays free vertices between held ones in the drawn lengths' proportion. Loops: the first is held.
  void spread(const DrawnChain& drawn) {
    std::size_t from = 0;
    for (std::size_t k = 1; k <= last(); ++k) {
      if (!held_[k] && k < last()) continue;
      double whole = 0, part = 0;
      for (std::size_t i = from; i < k; ++i) whole += drawn.lengths[i];
      for (std::size_t i = from + 1; i < k; ++i) {
        part += drawn.lengths[i - 1];
        match_.s[i] = match_.s[from] + part / whole * (match_.s[k] - match_.s[from]);
      }
      from = k;
    }
  }

  void finish(const TargetSurface& target, const DrawnChain& drawn, double kink_angle) {
    std::sort(match_.pinned.begin(), match_.pinned.end());
    relax_places(target, drawn, held_, match_);
    weigh_places(target, closed_, kink_angle, match_);
  }

 private:
  std::size_t last() const { return match_.s.size() - 1; }
  double total() const { return match_.path.length(); }
  double unwrapped(std::size_t k, double at) const {
    return closed_ ? match_.s[k] + std::remainder(at - match_.s[k], total()) : at;
  }

  bool closed_;
  ChainMatch& match_;
  std::vector<bool> held_;
};

}  // namespace

CurvePoint point_on_path(const TargetSurface& target, const FeaturePath& path, double s) {
  s = wrapped(path, s);
  const std::size_t p = piece_at(path, s);
  CurvePoint point = point_on_piece(target, path.pieces[p], s - path.offsets[p]);
  point.s = s;
  return point;
}

Index chain_on_path(const FeaturePath& path, double s) {
  return path.pieces[piece_at(path, wrapped(path, s))].chain;
}

FeaturePath reversed(const FeaturePath& path) {
  FeaturePath back;
  back.closed = path.closed;
  for (auto piece = path.pieces.rbegin(); piece != path.pieces.rend(); ++piece) {
    back.pieces.push_back({piece->chain, piece->s_end, piece->s_begin});
    back.offsets.push_back(back.offsets.back() + std::abs(piece->s_end - piece->s_begin));
  }
  return back;
}

double parameter_at(const ChainMatch& match, double t) {
  const std::size_t n = match.w.size() - 1;
  const std::size_t i = std::min(static_cast<std::size_t>(std::max(t, 0.0)), n - 1);
  const double x = t - static_cast<double>(i);
  const double y = 1 - x;
  const double w = match.w[i] * y * y * (1 + 2 * x) + match.w[i + 1] * x * x * (1 + 2 * y) +
                   match.slope[i] * x * y * y - match.slope[i + 1] * x * x * y;
  // s from w: within a step of the table the density is linear, so w is a quadratic of s.
  const std::vector<double>& table = match.table_w;
  const auto above = std::upper_bound(table.begin() + 1, table.end() - 1, w);
  const std::size_t k = static_cast<std::size_t>(above - table.begin()) - 1;
  const double step = match.table_s[k + 1] - match.table_s[k];
  const double d = match.table_density[k];
  const double growth = (match.table_density[k + 1] - d) / step;
  const double rest = std::max(0.0, w - table[k]);
  return match.table_s[k] + 2 * rest / (d + std::sqrt(std::max(d * d + 2 * growth * rest, 0.0)));
}

DrawnChain drawn_chain(const CreaseChain& chain, std::span<const Vec3> points) {
  DrawnChain drawn;
  drawn.closed = chain.closed;
  const Index n = chain.segment_count();
  for (Index i = 0; i <= n; ++i) drawn.controls.push_back(points[chain.vertex(i)]);
  for (Index i = 0; i < n; ++i) {
    drawn.lengths.push_back(
        std::max((drawn.controls[i + 1] - drawn.controls[i]).norm(), std::numeric_limits<double>::min()));
  }
  return drawn;
}

std::vector<std::string> place_vertices(const TargetSurface& target, const DrawnChain& drawn,
                                        const FeatureMatchSettings& settings, ChainMatch& match) {
  std::vector<std::string> warnings;
  const double angle = settings.kink_angle_degrees * std::numbers::pi / 180;
  const std::vector<double> kinks = kinks_of(target, match.path, angle);
  match.turns = !kinks.empty();
  Pins pins(drawn.closed, match);
  for (const double kink : kinks) {
    const std::string at = place(point_on_path(target, match.path, kink).position);
    warnings.push_back(
        pins.add_nearest(kink)
            ? fmt::format(
                  "the crease turns a corner of the CAD at {}: tag that vertex of the cage as a corner", at)
            : fmt::format(
                  "no vertex of the cage's crease lies near the CAD's corner at {}: it will be rounded", at));
  }
  for (const Bend& bend : bends_of(target, match.path, pins.mean_edge())) {
    if (!pins.add_short_edge(drawn, bend)) pins.add_nearest(bend.at[1]);
  }
  pins.finish(target, drawn, angle);
  return warnings;
}

std::vector<ChainMatch> other_places(const TargetSurface& target, const DrawnChain& drawn,
                                     const FeatureMatchSettings& settings, const ChainMatch& match) {
  std::vector<ChainMatch> others;
  const double angle = settings.kink_angle_degrees * std::numbers::pi / 180;
  const Offset n = static_cast<Offset>(match.s.size()) - 1;
  const auto index_of = [&](double at) {
    return std::find(match.s.begin(), match.s.end(), at) - match.s.begin();
  };
  for (const double at : match.pinned) {
    for (const Offset way : {-1, 1}) {
      const Offset vertex = drawn.closed ? (index_of(at) + way + n) % n : index_of(at) + way;
      if (!drawn.closed && (vertex <= 0 || vertex >= n)) continue;
      ChainMatch other = without_weights(match);
      Pins pins(drawn.closed, other);
      bool possible = true;
      for (const double pinned : match.pinned) {
        possible = possible && pins.add(pinned == at ? vertex : index_of(pinned), pinned);
      }
      if (!possible) continue;
      pins.spread(drawn);
      pins.finish(target, drawn, angle);
      others.push_back(std::move(other));
    }
  }
  if (drawn.closed || drawn.controls.front() == drawn.controls.back()) {
    ChainMatch other = without_weights(match);
    other.path = reversed(match.path);
    other.s.front() = match.path.length() - match.s.front();
    other.s.back() = other.s.front() + match.path.length();
    if (!drawn.closed) {
      other.s.front() = 0;
      other.s.back() = match.path.length();
    }
    Pins(drawn.closed, other).spread(drawn);
    place_vertices(target, drawn, settings, other);
    others.push_back(std::move(other));
  }
  return others;
}

}  // namespace flowcage
