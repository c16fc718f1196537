#include "occ_bridge/internal/face_outline.hpp"

#include <BRepTools.hxx>
#include <BRep_Tool.hxx>
#include <Geom2dAdaptor_Curve.hxx>
#include <Geom2d_Curve.hxx>
#include <Geom_Surface.hxx>
#include <Standard_Failure.hxx>
#include <TColStd_Array1OfReal.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Edge.hxx>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/error.hpp"

namespace flowcage {
namespace {

Vec2 point_of(const Geom2dAdaptor_Curve& curve, double t) {
  const gp_Pnt2d p = curve.Value(t);
  return {p.X(), p.Y()};
}

/// Appends the curve's points from `low` (not included) to `high`, halved until the middle is on the chord.
class Discretiser {
 public:
  Discretiser(const Geom2dAdaptor_Curve& curve, const Geom_Surface& surface, double precision)
      : curve_(curve), surface_(surface), precision_(precision) {}

  void append(double low, const Vec2& a, double high, const Vec2& b, int depth, std::vector<Vec2>& points) {
    const double middle = 0.5 * (low + high);
    const Vec2 m = point_of(curve_, middle);
    // A quarter point as well: an S-shaped piece crosses its chord in the middle.
    const Vec2 quarter = point_of(curve_, 0.75 * low + 0.25 * high);
    if (depth < 16 && std::max(gap(m, a, b), gap(quarter, a, b)) > precision_) {
      append(low, a, middle, m, depth + 1, points);
      append(middle, m, high, b, depth + 1, points);
      return;
    }
    points.push_back(b);
  }

 private:
  /// Distance of m from the chord a b, in space to first order.
  double gap(const Vec2& m, const Vec2& a, const Vec2& b) const {
    gp_Pnt p;
    gp_Vec du, dv;
    surface_.D1(m.x(), m.y(), p, du, dv);
    const Vec2 x = a - m, d = b - a;
    const gp_Vec A = du * x.x() + dv * x.y(), D = du * d.x() + dv * d.y();
    const double length = D.SquareMagnitude();
    const double t = length > 0 ? std::clamp(-A.Dot(D) / length, 0.0, 1.0) : 0.0;
    return (A + D * t).Magnitude();
  }

  const Geom2dAdaptor_Curve& curve_;
  const Geom_Surface& surface_;
  double precision_;
};

struct Piece {
  std::vector<Vec2> points;  // along the loop's sense
};

/// Small gaps between neighbouring parameter curves are closed by straight pieces, each end to the nearest
/// start that is still free, so that parities are right everywhere.
std::vector<TrimSegment> bridges(const std::vector<Piece>& pieces) {
  std::vector<TrimSegment> result;
  std::vector<bool> taken(pieces.size(), false);
  for (const Piece& piece : pieces) {
    double nearest = std::numeric_limits<double>::infinity();
    std::size_t best = 0;
    for (std::size_t other = 0; other < pieces.size(); ++other) {
      if (taken[other]) continue;
      const double distance = (pieces[other].points.front() - piece.points.back()).squaredNorm();
      if (distance < nearest) {
        nearest = distance;
        best = other;
      }
    }
    if (nearest == std::numeric_limits<double>::infinity()) continue;
    taken[best] = true;
    if (nearest > 0) result.push_back({piece.points.back(), pieces[best].points.front()});
  }
  return result;
}

}  // namespace

FaceOutline face_outline(const TopoDS_Face& oriented, double precision) {
  const TopoDS_Face face = TopoDS::Face(oriented.Oriented(TopAbs_FORWARD));
  const Handle(Geom_Surface) surface = BRep_Tool::Surface(face);
  if (surface.IsNull()) throw Error(ErrorKind::input, "a face has no surface", "repair the CAD");
  std::vector<Piece> pieces;
  FaceOutline outline;
  outline.precision = precision;
  outline.window.setEmpty();
  outline.bounded = true;
  for (TopExp_Explorer it(face, TopAbs_EDGE); it.More(); it.Next()) {
    const TopoDS_Edge edge = TopoDS::Edge(it.Current());
    if (edge.Orientation() != TopAbs_FORWARD && edge.Orientation() != TopAbs_REVERSED) continue;
    if (BRep_Tool::Degenerated(edge)) outline.bounded = false;
    double first = 0, last = 0;
    const Handle(Geom2d_Curve) pcurve = BRep_Tool::CurveOnSurface(edge, face, first, last);
    if (pcurve.IsNull()) {
      throw Error(ErrorKind::input, "an edge has no parameter curve on its face", "repair the CAD");
    }
    const Geom2dAdaptor_Curve curve(pcurve, first, last);
    const int count = curve.NbIntervals(GeomAbs_CN);
    TColStd_Array1OfReal ends(1, count + 1);
    curve.Intervals(ends, GeomAbs_CN);
    Piece piece;
    piece.points.push_back(point_of(curve, first));
    Discretiser discretiser(curve, *surface, precision);
    const int parts = curve.GetType() == GeomAbs_Line ? 1 : 4;
    for (int i = 1; i <= count; ++i) {
      for (int part = 0; part < parts; ++part) {
        const double a = ends(i) + (ends(i + 1) - ends(i)) * part / parts;
        const double b = ends(i) + (ends(i + 1) - ends(i)) * (part + 1) / parts;
        discretiser.append(a, point_of(curve, a), b, point_of(curve, b), 0, piece.points);
      }
    }
    if (edge.Orientation() == TopAbs_REVERSED) std::reverse(piece.points.begin(), piece.points.end());
    for (const Vec2& p : piece.points) {
      if (!p.allFinite()) throw Error(ErrorKind::input, "a parameter curve is not finite", "repair the CAD");
      outline.window.extend(p);
    }
    pieces.push_back(std::move(piece));
  }
  double u0 = 0, u1 = 0, v0 = 0, v1 = 0;
  surface->Bounds(u0, u1, v0, v1);
  if (pieces.empty()) {
    outline.bounded = false;
    outline.window = Eigen::AlignedBox2d(Vec2(u0, v0), Vec2(u1, v1));
    if (!(outline.window.sizes().maxCoeff() < 1e50)) {
      throw Error(ErrorKind::input, "a face has neither edges nor finite bounds", "repair the CAD");
    }
    return outline;
  }
  // Parameter curves may leave the surface's own range by rounding.
  if (!surface->IsUPeriodic()) {
    outline.window.min().x() = std::max(outline.window.min().x(), u0);
    outline.window.max().x() = std::min(outline.window.max().x(), u1);
  }
  if (!surface->IsVPeriodic()) {
    outline.window.min().y() = std::max(outline.window.min().y(), v0);
    outline.window.max().y() = std::min(outline.window.max().y(), v1);
  }
  if (!(outline.window.sizes().minCoeff() > 0)) {
    throw Error(ErrorKind::input, "a face's trimming encloses nothing", "repair the CAD");
  }
  const Vec2 tiny = 1e-9 * outline.window.sizes();
  const auto on_border = [&](const Piece& piece) {
    for (int axis = 0; axis < 2; ++axis) {
      for (const double border : {outline.window.min()[axis], outline.window.max()[axis]}) {
        const bool all = std::all_of(piece.points.begin(), piece.points.end(),
                                     [&](const Vec2& p) { return std::abs(p[axis] - border) <= tiny[axis]; });
        if (all) return true;
      }
    }
    return false;
  };
  outline.segments = bridges(pieces);
  for (const Piece& piece : pieces) {
    if (on_border(piece)) continue;  // the window ends there already (sides, seams, poles)
    for (std::size_t i = 0; i + 1 < piece.points.size(); ++i) {
      outline.segments.push_back({piece.points[i], piece.points[i + 1]});
    }
  }
  return outline;
}

Vec2 clear_point(const FaceOutline& outline) {
  constexpr int grid = 9;
  Vec2 best = outline.window.center();
  double clearance = -1;
  const Vec2 scale = outline.window.sizes().cwiseInverse();
  for (int i = 0; i < grid * grid; ++i) {
    const int row = i / grid, column = i % grid;
    const Vec2 fraction((column + 0.5137) / grid, (row + 0.4871) / grid);
    const Vec2 p = outline.window.min() + fraction.cwiseProduct(outline.window.sizes());
    double nearest = std::numeric_limits<double>::infinity();
    for (const TrimSegment& s : outline.segments) {
      const Vec2 a = (s.a - p).cwiseProduct(scale), d = (s.b - s.a).cwiseProduct(scale);
      const double length = d.squaredNorm();
      const double t = length > 0 ? std::clamp(-a.dot(d) / length, 0.0, 1.0) : 0.0;
      nearest = std::min(nearest, (a + t * d).squaredNorm());
    }
    if (nearest > clearance) {
      clearance = nearest;
      best = p;
    }
  }
  return best;
}

bool ExactClassifier::inside(const Vec2& uv) {
  const std::lock_guard lock(mutex_);
  try {
    if (!classifier_) {
      classifier_ = std::make_unique<BRepTopAdaptor_FClass2d>(face_, BRep_Tool::Tolerance(face_));
    }
    const TopAbs_State state = classifier_->Perform(gp_Pnt2d(uv.x(), uv.y()));
    return state == TopAbs_IN || state == TopAbs_ON;
  } catch (const Standard_Failure&) {
    return false;  // the border's own curves still answer for a point this near to them
  }
}

}  // namespace flowcage
