#include "core/blocks/swept_body.hpp"

#include <fmt/format.h>
#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/error.hpp"

namespace flowcage {
namespace {

constexpr const char* remedy =
    "the swept route is for wings and blades of one section a plane: use --blocks ambient or draw a cage";

struct Range {
  double low = std::numeric_limits<double>::max(), high = std::numeric_limits<double>::lowest();
  double length() const { return high - low; }
  void include(double s) {
    low = std::min(low, s);
    high = std::max(high, s);
  }
};

Range range_along(const TargetSurface& target, const Vec3& axis) {
  Range range;
  for (const Vec3& p : target.tessellation().points) range.include(axis.dot(p));
  return range;
}

/// The direction of an axis near a coordinate axis is that axis.
Vec3 tidy(const Vec3& axis) {
  for (int a = 0; a < 3; ++a) {
    if (std::abs(axis[a]) > 1 - 1e-8) return Vec3::Unit(a);
  }
  return axis;
}

/// The plane of a chain that is open and plane to 1e-4 diagonals.
struct OpenRim {
  Vec3 normal;
  double offset;
};
std::vector<OpenRim> open_rims(const TargetSurface& target) {
  std::vector<OpenRim> rims;
  // Chains of one rim are parts of it: planes are those of all boundary points that share them.
  for (const FeatureChain& chain : target.features().chains) {
    if (chain.kind != ChainKind::boundary || chain.polyline.size() < 3) continue;
    Vec3 mean = Vec3::Zero();
    for (const Vec3& p : chain.polyline) mean += p / static_cast<double>(chain.polyline.size());
    Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
    for (const Vec3& p : chain.polyline) spread += (p - mean) * (p - mean).transpose();
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(spread);
    const double flat = 1e-4 * target.diagonal();
    const double points = static_cast<double>(chain.polyline.size());
    if (std::sqrt(std::max(0.0, solver.eigenvalues()[0]) / points) > flat ||
        std::sqrt(std::max(0.0, solver.eigenvalues()[1]) / points) < 10 * flat) {
      continue;
    }
    const Vec3 normal = tidy(solver.eigenvectors().col(0));
    rims.push_back({normal, normal.dot(mean)});
  }
  return rims;
}

/// Coordinate axes and normals of open rims, then the principal axes, which tilt on swept wings.
struct AxisCandidates {
  std::vector<Vec3> axes;
  std::size_t natural = 0;  ///< how many are no principal axes
};
AxisCandidates axis_candidates(const TargetSurface& target) {
  std::vector<Vec3> axes{Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ()};
  for (const OpenRim& rim : open_rims(target)) axes.push_back(rim.normal);
  const std::size_t natural = axes.size();
  Vec3 mean = Vec3::Zero();
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  double area = 0;
  const Tessellation& t = target.tessellation();
  for (const auto& v : t.triangles) {
    const Vec3 centre = (t.points[v[0]] + t.points[v[1]] + t.points[v[2]]) / 3;
    const double a = (t.points[v[1]] - t.points[v[0]]).cross(t.points[v[2]] - t.points[v[0]]).norm();
    mean += a * centre;
    spread += a * centre * centre.transpose();
    area += a;
  }
  spread -= mean * mean.transpose() / area;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(spread);
  for (int n = 0; n < 3; ++n) axes.push_back(solver.eigenvectors().col(n));
  AxisCandidates different;
  for (std::size_t n = 0; n < axes.size(); ++n) {
    const bool known = std::any_of(different.axes.begin(), different.axes.end(),
                                   [&](const Vec3& d) { return std::abs(d.dot(axes[n])) > 1 - 1e-7; });
    if (known) continue;
    different.axes.push_back(axes[n]);
    if (n < natural) different.natural = different.axes.size();
  }
  return different;
}

/// Length along the axis in mean section diameters, times the part of 13 cuts in one piece; how many cuts
/// were in several, and where the worst of them was.
struct AxisScore {
  double score = 0;
  Index parted = 0, most_parts = 0;
  Vec3 worst = Vec3::Zero();
};
AxisScore score_axis(const TargetSurface& target, const Vec3& axis) {
  constexpr int cuts = 13;
  const Range range = range_along(target, axis);
  AxisScore out;
  double diameters = 0;
  int found = 0;
  for (int n = 0; n < cuts; ++n) {
    const double s = range.low + (n + 0.5) / cuts * range.length();
    const PlaneCut cut = cut_plane(target.tessellation(), axis, s, 1e-4 * target.diagonal());
    if (cut.segments.empty()) continue;
    ++found;
    Box3 box;
    for (const auto& segment : cut.segments) {
      box.extend(segment[0]);
      box.extend(segment[1]);
    }
    diameters += box.diagonal().norm();
    if (cut.components <= 1) continue;
    ++out.parted;
    if (cut.components > out.most_parts) {
      out.most_parts = cut.components;
      out.worst = cut.segments.front()[0];
    }
  }
  if (found > cuts / 2) {
    out.score = range.length() / (diameters / found) * (1 - static_cast<double>(out.parted) / found);
  }
  return out;
}

/// Chord and normal of a span axis: the mean diameter of five sections, downstream toward the thin end.
SweptAxes section_axes(const TargetSurface& target, const Vec3& span, const Range& range) {
  SweptAxes axes;
  axes.span = span;
  axes.chord = std::abs(span.x()) < 0.9 ? Vec3(Vec3::UnitX() - span.x() * span).normalized()
                                        : Vec3(Vec3::UnitZ() - span.z() * span).normalized();
  axes.normal = axes.chord.cross(span);
  Vec3 mean = Vec3::Zero();
  for (int n = 0; n < 5; ++n) {
    const auto section = airfoil_section(target, axes, range.low + (0.15 + 0.15 * n) * range.length());
    if (!section) continue;
    const auto fore = section->across(0.1);
    const auto aft = section->across(0.9);
    if (!fore || !aft) continue;
    const bool thin_aft = ((*aft)[0] - (*aft)[1]).norm() < ((*fore)[0] - (*fore)[1]).norm();
    const Vec2 d =
        thin_aft ? Vec2(section->trailing - section->leading) : Vec2(section->leading - section->trailing);
    mean += axes.chord * d.x() + axes.normal * d.y();
  }
  if (mean.norm() > 0) axes.chord = mean.normalized();
  axes.normal = axes.chord.cross(span);
  return axes;
}

/// Facing area of triangles within `depth` of an end, and the section's area that much inside.
bool is_flat_end(const TargetSurface& target, const SweptAxes& axes, double end, double inward,
                 double depth) {
  const Tessellation& t = target.tessellation();
  double facing = 0;
  for (const auto& v : t.triangles) {
    const Vec3 centre = (t.points[v[0]] + t.points[v[1]] + t.points[v[2]]) / 3;
    if (std::abs(axes.span.dot(centre) - end) > depth) continue;
    const Vec3 area = (t.points[v[1]] - t.points[v[0]]).cross(t.points[v[2]] - t.points[v[0]]) / 2;
    if (std::abs(area.dot(axes.span)) > 0.99 * area.norm()) facing += area.norm();
  }
  const PlaneCut inside = cut_plane(t, axes.span, end + inward * depth, 1e-4 * target.diagonal());
  return facing > 0.6 * inside.area;
}

struct Finder {
  const TargetSurface& target;
  const std::string& source;
  SweptBody body;
  Range range;

  [[noreturn]] void refuse(const std::string& why, const Vec3& where) const {
    throw input_error(source, 0, fmt::format("no swept body: {} at {}", why, place(where)), remedy);
  }

  AirfoilSection section(double s) const {
    if (auto found = airfoil_section(target, body.axes, s)) return *std::move(found);
    const Vec3 c = target.bounds().center();
    refuse("the plane across the span has no section", c + (s - body.axes.span.dot(c)) * body.axes.span);
  }

  /// An open or flat end across the axis: then it is no chance that it is the span.
  bool has_plane_end(const Vec3& axis) const {
    for (const OpenRim& rim : open_rims(target)) {
      if (std::abs(rim.normal.dot(axis)) > 1 - 1e-6) return true;
    }
    const Range ends = range_along(target, axis);
    SweptAxes axes;
    axes.span = axis;
    const double depth = 0.005 * ends.length();
    return is_flat_end(target, axes, ends.low, 1, depth) || is_flat_end(target, axes, ends.high, -1, depth);
  }

  void find_axis() {
    AxisScore best, most_parted;
    Vec3 span = Vec3::UnitY();
    const AxisCandidates candidates = axis_candidates(target);
    for (std::size_t n = 0; n < candidates.axes.size(); ++n) {
      if (n == candidates.natural && has_plane_end(span)) break;
      const AxisScore score = score_axis(target, candidates.axes[n]);
      if (score.parted > most_parted.parted) most_parted = score;
      const double lead = n < candidates.natural ? 1.02 : 1.6;
      if (score.score > lead * best.score) {
        best = score;
        span = candidates.axes[n];
      }
    }
    if (!(best.score > 0)) best = most_parted;
    if (best.parted > 3) {
      refuse(fmt::format("{} of 13 sections have several parts, {} of them", best.parted, best.most_parts),
             best.worst);
    }
    if (!(best.score > 0)) refuse("no axis has a section in most planes", target.bounds().center());
    range = range_along(target, span);
    if (const auto rims = open_rims(target); !rims.empty()) {
      // The open end comes first.
      for (const OpenRim& rim : rims) {
        if (std::abs(rim.normal.dot(span)) < 1 - 1e-6) continue;
        const double s = rim.offset * rim.normal.dot(span);
        if (s < range.high - 0.02 * range.length()) break;
        span = -span;
        range = range_along(target, span);
        break;
      }
    }
    body.axes = section_axes(target, span, range);
  }

  void find_ends() {
    const double near = 0.005 * range.length();
    for (int end = 0; end < 2; ++end) {
      const double at = end == 0 ? range.low : range.high;
      body.reach[end] = at;
      SweptEnd kind = SweptEnd::rounded;
      for (const OpenRim& rim : open_rims(target)) {
        if (std::abs(rim.normal.dot(body.axes.span)) < 1 - 1e-6) continue;
        if (std::abs(rim.offset * rim.normal.dot(body.axes.span) - at) < near) kind = SweptEnd::open;
      }
      if (kind != SweptEnd::open && is_flat_end(target, body.axes, at, end == 0 ? 1 : -1, near)) {
        kind = SweptEnd::flat;
      }
      body.ends[end] = kind;
    }
    if (body.ends[1] == SweptEnd::open) {
      refuse("both ends of the span are open", body.axes.place(0, range.high, 0));
    }
  }

  /// Where the sharp chain at the trailing edge of a section ends toward an end of the span, if it ends
  /// between them.
  std::optional<double> trailing_end(const AirfoilSection& from, int end) const {
    std::optional<double> found;
    for (const FeatureChain& chain : target.features().chains) {
      if (chain.kind != ChainKind::sharp) continue;
      Range along;
      double nearest = std::numeric_limits<double>::max();
      for (std::size_t n = 0; n + 1 < chain.polyline.size(); ++n) {
        const double a = body.axes.span.dot(chain.polyline[n]);
        const double b = body.axes.span.dot(chain.polyline[n + 1]);
        along.include(a);
        along.include(b);
        if ((a < from.s) == (b < from.s)) continue;
        const Vec3 p =
            chain.polyline[n] + (from.s - a) / (b - a) * (chain.polyline[n + 1] - chain.polyline[n]);
        nearest = std::min(nearest, (body.axes.section_place(p) - from.trailing).norm());
      }
      if (nearest > 0.08 * from.chord()) continue;
      const double at = end == 0 ? along.low : along.high;
      if (std::abs(at - body.reach[end]) > 1e-3 * range.length()) found = at;
    }
    return found;
  }

  /// Where the first or last ring lies: at the end; for rounded ends where the trailing edge ends, or where
  /// the thickness starts to leave the straight line of the sections inside.
  double ring_at(int end) const {
    const double inward = end == 0 ? 1 : -1;
    const double at = body.reach[end];
    if (body.ends[end] != SweptEnd::rounded) return at;
    const double outer_chord = section(at + inward * 0.1 * range.length()).chord();
    const double reach = std::min(0.4 * range.length(), outer_chord);
    if (const auto s = trailing_end(section(at + inward * reach), end)) return *s;
    const double a = section(at + inward * 2 * reach).thickness();
    const double b = section(at + inward * reach).thickness();
    constexpr int steps = 200;
    // Of an ellipse, six tenths of its half axis out; nearer to the ring the tessellation's error shows.
    constexpr double left = 0.8;
    constexpr double rest = 0.4;
    for (int n = 1; n < steps; ++n) {
      const double d = reach * (1 - static_cast<double>(n) / steps);
      const double straight = b + (b - a) * (reach - d) / reach;
      if (section(at + inward * d).thickness() < left * straight) return at + inward * d / rest;
    }
    return at + inward * reach / steps;
  }

  void find_stations() {
    const double first = ring_at(0);
    const double last = ring_at(1);
    constexpr int samples = 81;
    // Planes through the rims are cut just inside of them.
    const double inset = 1e-5 * range.length();
    std::vector<AirfoilSection> fine;
    for (int n = 0; n < samples; ++n) {
      const double s = first + (last - first) * n / (samples - 1);
      fine.push_back(section(std::clamp(s, first + inset, last - inset)));
      fine.back().s = s;
    }
    vote_trailing_edge(fine);
    check_shape(fine);
    std::vector<int> chosen{0, samples - 1};
    split(fine, 0, samples - 1, chosen);
    std::sort(chosen.begin(), chosen.end());
    std::vector<double> at;
    for (const int n : chosen) at.push_back(fine[n].s);
    space_out(fine, at);
    for (const double s : at) {
      AirfoilSection ring = section(std::clamp(s, first + inset, last - inset));
      ring.s = s;
      body.sections.push_back(std::move(ring));
    }
  }

  void vote_trailing_edge(const std::vector<AirfoilSection>& fine) {
    std::array<Index, 3> votes{};
    for (const AirfoilSection& f : fine) ++votes[static_cast<int>(f.kind)];
    const auto most = std::max_element(votes.begin(), votes.end());
    body.trailing = static_cast<TrailingEdge>(most - votes.begin());
    const Index others = static_cast<Index>(fine.size()) - *most;
    if (others > 0) {
      body.warnings.push_back(
          fmt::format("the trailing edge changes its kind: {} sharp, {} blunt, {} round "
                      "of {} sections",
                      votes[0], votes[1], votes[2], fine.size()));
    }
  }

  void check_shape(const std::vector<AirfoilSection>& fine) const {
    Index thick = 0;
    const AirfoilSection* worst = nullptr;
    for (const AirfoilSection& f : fine) {
      if (f.thickness() <= 0.5 * f.chord()) continue;
      ++thick;
      worst = &f;
    }
    if (2 * thick > static_cast<Index>(fine.size())) {
      refuse("sections are thicker than half their chord",
             body.axes.place(worst->leading.x(), worst->s, worst->leading.y()));
    }
  }

  /// Douglas & Peucker (1973) on leading edge, trailing edge and thickness together.
  static void split(const std::vector<AirfoilSection>& fine, int a, int b, std::vector<int>& chosen) {
    constexpr double allowed = 0.005;  // chords
    double most = allowed;
    int at = -1;
    for (int n = a + 1; n < b; ++n) {
      const double t = static_cast<double>(n - a) / (b - a);
      const auto off = [&](const Vec2& p, const Vec2& q, const Vec2& r) {
        return (r - (1 - t) * p - t * q).norm();
      };
      const double scale = fine[n].chord();
      const double d =
          std::max({off(fine[a].leading, fine[b].leading, fine[n].leading),
                    off(fine[a].trailing, fine[b].trailing, fine[n].trailing),
                    std::abs(fine[n].thickness() - (1 - t) * fine[a].thickness() - t * fine[b].thickness())});
      if (d / scale > most) {
        most = d / scale;
        at = n;
      }
    }
    if (at < 0 || at - a < 3 || b - at < 3) return;
    chosen.push_back(at);
    split(fine, a, at, chosen);
    split(fine, at, b, chosen);
  }

  /// A ring half a chord inside closed ends, then intervals halved until none is longer than 2.5 chords or
  /// twice its neighbour.
  void space_out(const std::vector<AirfoilSection>& fine, std::vector<double>& at) const {
    const auto chord_at = [&](double s) {
      const double t = (s - fine.front().s) / (fine.back().s - fine.front().s);
      return fine[std::clamp<std::size_t>(std::lround(t * static_cast<double>(fine.size() - 1)), 0,
                                          fine.size() - 1)]
          .chord();
    };
    for (int end = 0; end < 2; ++end) {
      if (body.ends[end] == SweptEnd::open) continue;
      const double s = end == 0 ? at.front() : at.back();
      const double inside = s + (end == 0 ? 0.5 : -0.5) * chord_at(s);
      const bool room = std::all_of(
          at.begin(), at.end(), [&](double other) { return std::abs(other - inside) > 0.25 * chord_at(s); });
      if (room && inside > at.front() && inside < at.back()) at.push_back(inside);
      std::sort(at.begin(), at.end());
    }
    for (bool changed = true; changed && at.size() < 60;) {
      changed = false;
      for (std::size_t n = 0; n + 1 < at.size() && !changed; ++n) {
        const double length = at[n + 1] - at[n];
        double most = 2.5 * chord_at((at[n] + at[n + 1]) / 2);
        if (n > 0) most = std::min(most, 2.05 * (at[n] - at[n - 1]));
        if (n + 2 < at.size()) most = std::min(most, 2.05 * (at[n + 2] - at[n + 1]));
        if (length <= most) continue;
        at.insert(at.begin() + static_cast<long>(n) + 1, at[n] + length / 2);
        changed = true;
      }
    }
  }
};

}  // namespace

SweptBody find_swept_body(const TargetSurface& target, const std::string& source) {
  Finder finder{target, source, {}, {}};
  finder.find_axis();
  finder.find_ends();
  finder.find_stations();
  return std::move(finder.body);
}

}  // namespace flowcage
