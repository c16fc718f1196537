#include "occ_bridge/internal/feature_edges.hpp"

#include <fmt/format.h>
#include <BRep_Tool.hxx>
#include <Geom2d_Curve.hxx>
#include <Geom_Curve.hxx>
#include <Geom_Surface.hxx>
#include <ShapeAnalysis_Surface.hxx>
#include <TopoDS.hxx>
#include <algorithm>
#include <array>
#include <optional>

#include "occ_bridge/internal/kernel_scope.hpp"

namespace flowcage::occ {

namespace {

constexpr int samples = 17;

/// The outward normal of a face along one of its edges.
class SideNormal {
 public:
  SideNormal(const TopoDS_Edge& edge, const TopoDS_Face& face, const Handle(Geom_Surface) & surface)
      : surface_(surface), reversed_(face.Orientation() == TopAbs_REVERSED) {
    curve_ = BRep_Tool::CurveOnSurface(edge, face, t0_, t1_);
    if (curve_.IsNull()) throw Standard_Failure("edge without a curve in its face");
    surface_->Bounds(box_[0], box_[1], box_[2], box_[3]);
  }

  double first() const { return t0_; }
  double last() const { return t1_; }

  /// At the edge's parameter t, for the point `on` of the edge: where the curve in the face's parameters is
  /// off by more than `tolerance` (it does not run at the edge's speed), the point is projected instead.
  std::optional<gp_Vec> at(double t, const gp_Pnt& on, double tolerance) const {
    gp_Pnt2d uv = curve_->Value(std::clamp(t, t0_, t1_));
    if (surface_->Value(uv.X(), uv.Y()).Distance(on) > tolerance) {
      uv = ShapeAnalysis_Surface(surface_).NextValueOfUV(uv, on, 0.01 * tolerance);
    }
    // At a pole the normal is that of the points beside it.
    for (const double shift : {0.0, 1e-6, 1e-4, 1e-2}) {
      const auto n = normal(moved_inward(uv.X(), box_[0], box_[1], shift),
                            moved_inward(uv.Y(), box_[2], box_[3], shift));
      if (n) return n;
    }
    return std::nullopt;
  }

 private:
  static double moved_inward(double x, double low, double high, double shift) {
    if (Precision::IsInfinite(low) || Precision::IsInfinite(high)) return x;
    return x + shift * (0.5 * (low + high) - x);
  }
  std::optional<gp_Vec> normal(double u, double v) const {
    gp_Pnt p;
    gp_Vec du, dv;
    surface_->D1(u, v, p, du, dv);
    gp_Vec n = du.Crossed(dv);
    const double size = n.Magnitude();
    if (!(size > 1e-8 * du.Magnitude() * dv.Magnitude()) || size < 1e-100) return std::nullopt;
    n /= reversed_ ? -size : size;
    return n;
  }

  Handle(Geom_Surface) surface_;
  Handle(Geom2d_Curve) curve_;
  double t0_ = 0, t1_ = 0;
  std::array<double, 4> box_{};
  bool reversed_;
};

/// Angle between both sides along an edge of two faces.
class EdgeAngle {
 public:
  EdgeAngle(const TopoDS_Edge& edge, const SideNormal& a, const SideNormal& b)
      : a_(a), b_(b), tolerance_(2 * BRep_Tool::Tolerance(edge)) {
    curve_ = BRep_Tool::Curve(edge, t0_, t1_);
    if (curve_.IsNull()) throw Standard_Failure("edge without a curve in space");
  }
  double first() const { return t0_; }
  double last() const { return t1_; }
  std::optional<double> operator()(double t) const {
    const gp_Pnt on = curve_->Value(t);
    const auto n = a_.at(t, on, tolerance_), m = b_.at(t, on, tolerance_);
    if (!n || !m) return std::nullopt;
    return n->Angle(*m);
  }

 private:
  const SideNormal& a_;
  const SideNormal& b_;
  Handle(Geom_Curve) curve_;
  double t0_ = 0, t1_ = 0, tolerance_;
};

/// Where the angle passes the crease angle between a sample above and one below (or the other way round).
double crossing(const EdgeAngle& angle, double crease_angle, double a, double b, bool sharp_at_a) {
  const double stop = 1e-6 * std::abs(angle.last() - angle.first());
  while (std::abs(b - a) > stop) {
    const double middle = 0.5 * (a + b);
    const auto value = angle(middle);
    if (value && (*value > crease_angle) == sharp_at_a) {
      a = middle;
    } else {
      b = middle;
    }
  }
  return 0.5 * (a + b);
}

/// Adds the sharp runs of an edge between two sides; says whether they are only a part of it.
bool add_sharp_runs(Index e, const EdgeAngle& angle, double crease_angle, std::vector<FeatureRun>& runs) {
  std::array<double, samples> t{};
  std::array<bool, samples> sharp{};
  double smallest = 10;
  int count = 0, known = 0;
  for (int i = 0; i < samples; ++i) {
    // A little inside of the ends: there other faces meet, and surfaces are worst.
    const double x = 0.01 + 0.98 * i / (samples - 1);
    t[i] = angle.first() + x * (angle.last() - angle.first());
    const auto value = angle(t[i]);
    sharp[i] = value ? *value > crease_angle : i > 0 && sharp[i - 1];
    if (value) smallest = std::min(smallest, *value);
    known += value ? 1 : 0;
    count += sharp[i] ? 1 : 0;
  }
  if (known == 0) throw Standard_Failure("no normal along the edge");
  if (count == 0) return false;
  if (count < samples && smallest <= 0.5 * crease_angle) {
    for (int i = 1; i + 1 < samples; ++i) {  // single samples are noise
      if (sharp[i - 1] == sharp[i + 1]) sharp[i] = sharp[i - 1];
    }
    sharp[0] = sharp[1];
    sharp[samples - 1] = sharp[samples - 2];
  } else {
    sharp.fill(true);
  }
  const std::size_t before = runs.size();
  for (int i = 0; i < samples; ++i) {
    if (!sharp[i] || (i > 0 && sharp[i - 1])) continue;
    int end = i;
    while (end + 1 < samples && sharp[end + 1]) ++end;
    FeatureRun run{.edge = e, .t0 = angle.first(), .t1 = angle.last()};
    run.whole_start = i == 0;
    run.whole_end = end == samples - 1;
    if (!run.whole_start) run.t0 = crossing(angle, crease_angle, t[i], t[i - 1], true);
    if (!run.whole_end) run.t1 = crossing(angle, crease_angle, t[end], t[end + 1], true);
    runs.push_back(run);
  }
  return runs.size() > before && !(runs.back().whole_start && runs.back().whole_end);
}

FeatureRun whole_edge(Index e, const TopoDS_Edge& edge, ChainKind kind) {
  FeatureRun run{.edge = e, .kind = kind};
  BRep_Tool::Range(edge, run.t0, run.t1);
  return run;
}

}  // namespace

FeatureEdges find_feature_edges(const FaceEdges& topology, double crease_angle,
                                std::span<const std::string> openings, std::vector<std::string>& warnings) {
  FeatureEdges result;
  std::vector<Handle(Geom_Surface)> surfaces;
  for (Index f = 0; f < topology.face_count(); ++f) surfaces.push_back(BRep_Tool::Surface(topology.face(f)));

  for (Index e = 0; e < topology.edge_count(); ++e) {
    const auto uses = topology.uses[e];
    if (uses.empty() || topology.degenerated(e)) continue;
    const TopoDS_Edge edge = TopoDS::Edge(topology.edge(e).Oriented(TopAbs_FORWARD));
    const std::size_t before = result.runs.size();
    const std::string failure = failure_of([&] {
      if (uses.size() == 1) {
        result.runs.push_back(whole_edge(e, edge, ChainKind::boundary));
      } else if (uses.size() > 2) {
        result.runs.push_back(whole_edge(e, edge, ChainKind::sharp));
        ++result.crowded_edges;
        ++result.sharp_edges;
      } else if (openings[uses[0].face] != openings[uses[1].face]) {
        result.runs.push_back(whole_edge(e, edge, ChainKind::sharp));
        ++result.sharp_edges;
      } else {
        // Of a seam's two curves the edge's own orientation picks one.
        const bool seam = uses[0].face == uses[1].face;
        const SideNormal a(edge, topology.face(uses[0].face), surfaces[uses[0].face]);
        const SideNormal b(seam ? TopoDS::Edge(edge.Reversed()) : edge, topology.face(uses[1].face),
                           surfaces[uses[1].face]);
        const bool partly = add_sharp_runs(e, EdgeAngle(edge, a, b), crease_angle, result.runs);
        result.partly_sharp_edges += partly ? 1 : 0;
        result.sharp_edges += result.runs.size() > before ? 1 : 0;
      }
    });
    if (!failure.empty()) {
      warnings.push_back(fmt::format("edge {} could not be examined for sharpness and counts as smooth ({})",
                                     e + 1, failure));
    }
  }
  return result;
}

}  // namespace flowcage::occ
