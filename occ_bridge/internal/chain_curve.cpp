#include "occ_bridge/internal/chain_curve.hpp"

#include <GeomAdaptor_Curve.hxx>
#include <TColStd_Array1OfReal.hxx>
#include <algorithm>
#include <cmath>
#include <limits>

namespace flowcage::occ {

namespace {

Vec3 vec(const gp_XYZ& p) {
  return {p.X(), p.Y(), p.Z()};
}

Vec3 position(const Geom_Curve& curve, double t) {
  return vec(curve.Value(t).XYZ());
}

double distance_to_segment(const Vec3& p, const Vec3& a, const Vec3& b, double& fraction) {
  const Vec3 d = b - a;
  const double square = d.squaredNorm();
  fraction = square > 0 ? std::clamp((p - a).dot(d) / square, 0.0, 1.0) : 0.0;
  return (a + fraction * d - p).norm();
}

/// Parameters from a to b so that the chords keep within `deviation`, turn little, and are not few.
void sample(const Geom_Curve& curve, double a, double b, double deviation, int depth,
            std::vector<double>& out) {
  const Vec3 p = position(curve, a), q = position(curve, b);
  const double middle = 0.5 * (a + b);
  const Vec3 m = position(curve, middle);
  double fraction = 0, off = distance_to_segment(m, p, q, fraction);
  for (const double x : {0.25, 0.75}) {
    off = std::max(off, distance_to_segment(position(curve, a + x * (b - a)), p, q, fraction));
  }
  const double turn = (m - p).norm() > 0 && (q - m).norm() > 0
                          ? std::acos(std::clamp((m - p).normalized().dot((q - m).normalized()), -1.0, 1.0))
                          : 0.0;
  constexpr double largest_turn = 0.12;  // 7 degrees
  constexpr int deepest = 12;
  const bool tiny = (q - p).norm() < 0.02 * deviation && off < 0.02 * deviation;
  if (depth < deepest && !tiny && (off > deviation || turn > largest_turn)) {
    sample(curve, a, middle, deviation, depth + 1, out);
    sample(curve, middle, b, deviation, depth + 1, out);
  } else {
    out.push_back(b);
  }
}

}  // namespace

std::vector<double> smooth_breaks(const Handle(Geom_Curve) & curve, double t0, double t1) {
  const GeomAdaptor_Curve adaptor(curve, t0, t1);
  const int count = adaptor.NbIntervals(GeomAbs_CN);
  TColStd_Array1OfReal values(1, count + 1);
  adaptor.Intervals(values, GeomAbs_CN);
  std::vector<double> breaks{t0};
  const double least = 1e-12 * (t1 - t0);
  for (const double t : values) {
    if (t > breaks.back() + least && t < t1 - least) breaks.push_back(t);
  }
  breaks.push_back(t1);
  return breaks;
}

Vec3 unit_tangent(const ChainPiece& piece, double t) {
  gp_Pnt p;
  gp_Vec d;
  piece.curve->D1(t, p, d);
  const double speed = d.Magnitude();
  if (speed > 1e-7 * piece.usual_speed) return vec(d.XYZ()) / speed;
  const double step = 1e-4 * (piece.t1 - piece.t0);
  const bool ahead = t + step <= piece.t1;
  const Vec3 secant = ahead ? Vec3(position(*piece.curve, t + step) - vec(p.XYZ()))
                            : Vec3(vec(p.XYZ()) - position(*piece.curve, t - step));
  return secant.normalized();
}

ChainPiece make_piece(const Handle(Geom_Curve) & curve, double t0, double t1) {
  ChainPiece piece{curve, t0, t1};
  for (const double x : {0.1, 0.3, 0.5, 0.7, 0.9}) {
    gp_Pnt p;
    gp_Vec d;
    curve->D1(t0 + x * (t1 - t0), p, d);
    piece.usual_speed = std::max(piece.usual_speed, d.Magnitude());
  }
  return piece;
}

ChainCurve::ChainCurve(const std::vector<ChainPiece>& pieces, double deviation) {
  for (const ChainPiece& piece : pieces) {
    const auto breaks = smooth_breaks(piece.curve, piece.t0, piece.t1);
    const Geom_Curve& curve = *piece.curve;
    const auto speed = [&](double t) {
      gp_Pnt p;
      gp_Vec d;
      curve.D1(t, p, d);
      return d.Magnitude();
    };
    pieces_.push_back({piece, ArcLengthTable(speed, breaks), length_});
    length_ += pieces_.back().table.length();

    std::vector<double> t{breaks.front()};
    for (std::size_t i = 0; i + 1 < breaks.size(); ++i) {
      const double width = breaks[i + 1] - breaks[i];
      for (int k = 0; k < 2; ++k) {
        sample(curve, breaks[i] + 0.5 * k * width, breaks[i] + 0.5 * (k + 1) * width, deviation, 0, t);
      }
    }
    if (piece.reversed) std::ranges::reverse(t);
    const Index number = static_cast<Index>(pieces_.size()) - 1;
    for (std::size_t i = number == 0 ? 0 : 1; i < t.size(); ++i) {
      knots_.push_back({position(curve, t[i]), t[i], number});
      if (i == 0) continue;
      double fraction = 0, off = 0;
      for (const double x : {0.25, 0.5, 0.75}) {
        off = std::max(off, distance_to_segment(position(curve, t[i - 1] + x * (t[i] - t[i - 1])),
                                                position(curve, t[i - 1]), knots_.back().position, fraction));
      }
      bulge_.push_back(2 * off);
    }
  }
}

double ChainCurve::s_at(const Piece& piece, double t) const {
  const double local = piece.table.s_of(t);
  return piece.s + (piece.exact.reversed ? piece.table.length() - local : local);
}

CurvePoint ChainCurve::at(const Piece& piece, double t) const {
  CurvePoint result;
  result.position = position(*piece.exact.curve, t);
  result.tangent = unit_tangent(piece.exact, t);
  if (piece.exact.reversed) result.tangent = -result.tangent;
  return result;
}

CurvePoint ChainCurve::point(double s) const {
  s = std::clamp(s, 0.0, length_);
  auto next = std::ranges::upper_bound(pieces_, s, {}, &Piece::s);
  const Piece& piece = next == pieces_.begin() ? pieces_.front() : *std::prev(next);
  const double local = s - piece.s;
  CurvePoint result =
      at(piece, piece.table.t_of(piece.exact.reversed ? piece.table.length() - local : local));
  result.s = s;
  return result;
}

double ChainCurve::newton(const Piece& piece, const Vec3& query, double t, double low, double high) const {
  const double least = 1e-15 * (piece.exact.t1 - piece.exact.t0);
  double best = std::numeric_limits<double>::infinity(), best_t = t;
  double step = 0;
  for (int i = 0; i < 40; ++i) {
    gp_Pnt p;
    gp_Vec d1, d2;
    piece.exact.curve->D2(t, p, d1, d2);
    const Vec3 r = vec(p.XYZ()) - query;
    const double square = r.squaredNorm();
    if (square > best) {  // too far: back half of the step
      step *= 0.5;
      if (std::abs(step) <= least) break;
      t = best_t + step;
      continue;
    }
    best = square;
    best_t = t;
    const double g = r.dot(vec(d1.XYZ()));
    const double h = d1.SquareMagnitude() + r.dot(vec(d2.XYZ()));
    const double wanted = h > 0 ? -g / h : (g > 0 ? low - t : high - t);
    const double to = std::clamp(t + wanted, low, high);
    step = to - t;
    if (std::abs(step) <= least) break;
    t = to;
  }
  return best_t;
}

CurvePoint ChainCurve::closest(const Vec3& query) const {
  double best = std::numeric_limits<double>::infinity();
  std::size_t nearest = 0;
  for (std::size_t i = 0; i < knots_.size(); ++i) {
    const double d = (knots_[i].position - query).squaredNorm();
    if (d < best) {
      best = d;
      nearest = i;
    }
  }
  best = std::sqrt(best);
  const Piece* best_piece = &pieces_[knots_[nearest].piece];
  double best_t = knots_[nearest].t;
  for (std::size_t i = 0; i + 1 < knots_.size(); ++i) {
    double fraction = 0;
    const double chord = distance_to_segment(query, knots_[i].position, knots_[i + 1].position, fraction);
    if (chord - bulge_[i] > best) continue;
    const Piece& piece = pieces_[knots_[i + 1].piece];
    const double to = knots_[i + 1].t;
    double from = knots_[i].t;
    if (knots_[i].piece != knots_[i + 1].piece) from = piece.exact.reversed ? piece.exact.t1 : piece.exact.t0;
    const double t =
        newton(piece, query, from + fraction * (to - from), std::min(from, to), std::max(from, to));
    const double d = (position(*piece.exact.curve, t) - query).norm();
    if (d < best) {
      best = d;
      best_t = t;
      best_piece = &piece;
    }
  }
  CurvePoint result = at(*best_piece, best_t);
  result.s = s_at(*best_piece, best_t);
  result.distance = (result.position - query).norm();
  return result;
}

std::vector<Vec3> ChainCurve::polyline() const {
  std::vector<Vec3> points;
  for (const Knot& knot : knots_) points.push_back(knot.position);
  return points;
}

std::vector<double> ChainCurve::polyline_s() const {
  std::vector<double> s;
  for (const Knot& knot : knots_) s.push_back(s_at(pieces_[knot.piece], knot.t));
  return s;
}

}  // namespace flowcage::occ
