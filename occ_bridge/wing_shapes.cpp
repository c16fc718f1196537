#include <BRepAdaptor_Surface.hxx>
#include <BRepBuilderAPI_MakeEdge.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_MakeSolid.hxx>
#include <BRepBuilderAPI_MakeWire.hxx>
#include <BRepBuilderAPI_Sewing.hxx>
#include <BRepLib.hxx>
#include <GeomAPI_Interpolate.hxx>
#include <GeomFill.hxx>
#include <Geom_BSplineCurve.hxx>
#include <Geom_BSplineSurface.hxx>
#include <Geom_SurfaceOfRevolution.hxx>
#include <Geom_TrimmedCurve.hxx>
#include <TColStd_Array1OfInteger.hxx>
#include <TColStd_Array1OfReal.hxx>
#include <TColgp_Array2OfPnt.hxx>
#include <TColgp_HArray1OfPnt.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Shell.hxx>
#include <TopoDS_Solid.hxx>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/base/error.hpp"
#include "occ_bridge/internal/shape_rep.hpp"

namespace flowcage {
namespace {

// Upper half of the section at unit chord as a cubic B-spline from leading to trailing edge, vertical at the
// leading edge so that upper and lower side meet there with continuous curvature.
Handle(Geom_BSplineCurve) section_curve(const AirfoilHalf& half) {
  const int n = static_cast<int>(half.x.size());
  Handle(TColgp_HArray1OfPnt) points = new TColgp_HArray1OfPnt(1, n);
  for (int i = 0; i < n; ++i) points->SetValue(i + 1, gp_Pnt(half.x[i], 0, half.y[i]));
  GeomAPI_Interpolate interpolate(points, false, 1e-12);
  const gp_Vec start(0, 0, 1);
  const gp_Vec end(half.x[n - 1] - half.x[n - 2], 0, half.y[n - 1] - half.y[n - 2]);
  // Unit vectors, unscaled: the parameter is chord length. The kernel's own scaling made a loop at the
  // trailing edge.
  interpolate.Load(start, end.Normalized(), false);
  interpolate.Perform();
  return interpolate.Curve();
}

struct Station {
  double leading_edge_x, y, chord;
};

// The section placed at a station; sign -1 mirrors it to the lower side.
gp_Pnt at_station(const gp_Pnt& p, const Station& s, double sign) {
  return {s.leading_edge_x + s.chord * p.X(), s.y, sign * s.chord * p.Z()};
}

Handle(Geom_Curve) placed(const Handle(Geom_BSplineCurve) & curve, const Station& s, double sign) {
  Handle(Geom_BSplineCurve) copy = Handle(Geom_BSplineCurve)::DownCast(curve->Copy());
  for (int i = 1; i <= copy->NbPoles(); ++i) copy->SetPole(i, at_station(curve->Pole(i), s, sign));
  return copy;
}

TopoDS_Face face_of(const Handle(Geom_Surface) & surface) {
  return BRepBuilderAPI_MakeFace(surface, 1e-9);
}

TopoDS_Face planar_face(const std::vector<Handle(Geom_Curve)>& curves) {
  BRepBuilderAPI_MakeWire wire;
  for (const auto& curve : curves) wire.Add(BRepBuilderAPI_MakeEdge(curve));
  return BRepBuilderAPI_MakeFace(wire.Wire(), true);
}

Handle(Geom_Curve) segment(const gp_Pnt& a, const gp_Pnt& b) {
  TColgp_Array1OfPnt poles(1, 2);
  poles(1) = a;
  poles(2) = b;
  TColStd_Array1OfReal knots(1, 2);
  knots(1) = 0;
  knots(2) = 1;
  TColStd_Array1OfInteger multiplicities(1, 2);
  multiplicities.Init(2);
  return new Geom_BSplineCurve(poles, knots, multiplicities, 1);
}

// Normal (with the face's orientation) at the highest of the faces' middle points: on the upper side of a
// half wing.
gp_Dir upper_side_normal(const TopoDS_Shape& shell) {
  double highest = -std::numeric_limits<double>::max();
  gp_Vec normal;
  for (TopExp_Explorer face(shell, TopAbs_FACE); face.More(); face.Next()) {
    const BRepAdaptor_Surface surface(TopoDS::Face(face.Current()));
    gp_Pnt p;
    gp_Vec du, dv;
    surface.D1(0.5 * (surface.FirstUParameter() + surface.LastUParameter()),
               0.5 * (surface.FirstVParameter() + surface.LastVParameter()), p, du, dv);
    if (p.Z() <= highest) continue;
    highest = p.Z();
    normal = du.Crossed(dv);
    if (face.Current().Orientation() == TopAbs_REVERSED) normal.Reverse();
  }
  return gp_Dir(normal);
}

}  // namespace

AirfoilHalf naca_symmetric(double thickness, double half_base) {
  AirfoilHalf half;
  constexpr int intervals = 60;
  for (int i = 0; i <= intervals; ++i) {
    const double x = 0.5 * (1 - std::cos(std::numbers::pi * i / intervals));
    const double y =
        5 * thickness * (0.2969 * std::sqrt(x) + x * (-0.1260 + x * (-0.3516 + x * (0.2843 - 0.1036 * x))));
    half.x.push_back(x);
    half.y.push_back((i == intervals ? 0.0 : y) + half_base * x);
  }
  return half;
}

AirfoilHalf onera_d() {
  AirfoilHalf half;
  half.x = {0.0000000, 0.0000165, 0.0000696, 0.0001675, 0.0003232, 0.0005508, 0.0008657, 0.0012868,
            0.0018364, 0.0025441, 0.0034428, 0.0045704, 0.0059751, 0.0077112, 0.0098413, 0.0124479,
            0.0156171, 0.0194609, 0.0241067, 0.0297008, 0.0364261, 0.0444852, 0.0541248, 0.0656303,
            0.0793366, 0.0956354, 0.1149796, 0.1378963, 0.1649976, 0.1919327, 0.2187096, 0.2453310,
            0.2717978, 0.2981113, 0.3242726, 0.3502830, 0.3761446, 0.4018567, 0.4274223, 0.4528441,
            0.4781197, 0.5032514, 0.5282426, 0.5530937, 0.5778043, 0.6023757, 0.6268104, 0.6511093,
            0.6752726, 0.6993027, 0.7231995, 0.7469658, 0.7705998, 0.7941055, 0.8174828, 0.8407324,
            0.8638564, 0.8868235, 0.9061905, 0.9225336, 0.9363346, 0.9479946, 0.9578511, 0.9661860,
            0.9732361, 0.9792020, 0.9842508, 0.9885252, 0.9921438, 0.9952080, 0.9978030, 1.0000000};
  half.y = {0.0000000, 0.0006914, 0.0014416, 0.0022554, 0.0031382, 0.0040959, 0.0051343, 0.0062598,
            0.0074784, 0.0087958, 0.0102163, 0.0117419, 0.0133708, 0.0150951, 0.0168984, 0.0187537,
            0.0206220, 0.0224545, 0.0242004, 0.0258245, 0.0273317, 0.0287912, 0.0303278, 0.0320138,
            0.0338372, 0.0357742, 0.0377923, 0.0398522, 0.0419089, 0.0436214, 0.0450507, 0.0462358,
            0.0471987, 0.0479494, 0.0484902, 0.0488183, 0.0489296, 0.0488202, 0.0484833, 0.0479351,
            0.0471661, 0.0461903, 0.0450209, 0.0436741, 0.0421684, 0.0405241, 0.0387613, 0.0368990,
            0.0349542, 0.0329402, 0.0308662, 0.0287365, 0.0265505, 0.0243027, 0.0219842, 0.0195838,
            0.0170915, 0.0145051, 0.0122389, 0.0102727, 0.0085827, 0.0071423, 0.0059224, 0.0048907,
            0.0040180, 0.0032796, 0.0026547, 0.0021257, 0.0016778, 0.0012985, 0.0009773, 0.0007052};
  // The last points lie on a straight line: it meets the chord line at x_end.
  const std::size_t n = half.x.size();
  const double slope = (half.y[n - 1] - half.y[n - 8]) / (half.x[n - 1] - half.x[n - 8]);
  const double x_end = half.x[n - 1] - half.y[n - 1] / slope;
  half.x.push_back(x_end);
  half.y.push_back(0);
  for (double& x : half.x) x /= x_end;
  for (double& y : half.y) y /= x_end;
  return half;
}

Shape make_half_wing(const HalfWing& wing) {
  const Handle(Geom_BSplineCurve) unit = section_curve(wing.airfoil);
  const double sweep = std::tan(wing.leading_edge_sweep_degrees * std::numbers::pi / 180);
  const Station root{0, 0, wing.root_chord};
  const Station tip{sweep * wing.semi_span, wing.semi_span, wing.tip_chord};
  const Handle(Geom_Curve) root_upper = placed(unit, root, 1), root_lower = placed(unit, root, -1);
  const Handle(Geom_Curve) tip_upper = placed(unit, tip, 1), tip_lower = placed(unit, tip, -1);
  const bool blunt = wing.airfoil.y.back() > 0;
  const gp_Pnt trailing = unit->EndPoint();
  const Handle(Geom_Curve) tip_base = segment(at_station(trailing, tip, 1), at_station(trailing, tip, -1));
  const Handle(Geom_Curve) root_base = segment(at_station(trailing, root, 1), at_station(trailing, root, -1));

  BRepBuilderAPI_Sewing sewing(1e-7 * wing.root_chord);
  sewing.Add(face_of(GeomFill::Surface(root_upper, tip_upper)));
  sewing.Add(face_of(GeomFill::Surface(root_lower, tip_lower)));
  if (blunt) sewing.Add(face_of(GeomFill::Surface(root_base, tip_base)));
  if (wing.tip == WingTip::flat) {
    sewing.Add(planar_face(blunt ? std::vector<Handle(Geom_Curve)>{tip_upper, tip_base, tip_lower}
                                 : std::vector<Handle(Geom_Curve)>{tip_upper, tip_lower}));
  } else {
    // Half a turn about the chord line, outboard from the upper to the lower side.
    const gp_Ax1 chord_line(gp_Pnt(tip.leading_edge_x, tip.y, 0), gp_Dir(-1, 0, 0));
    const auto revolved = [&](const Handle(Geom_Curve) & curve) {
      const Handle(Geom_SurfaceOfRevolution) surface = new Geom_SurfaceOfRevolution(curve, chord_line);
      return TopoDS_Face(BRepBuilderAPI_MakeFace(surface, 0, std::numbers::pi, curve->FirstParameter(),
                                                 curve->LastParameter(), 1e-9));
    };
    sewing.Add(revolved(tip_upper));
    if (blunt) {
      const gp_Pnt axis_end(tip.leading_edge_x + tip.chord * trailing.X(), tip.y, 0);
      sewing.Add(revolved(segment(at_station(trailing, tip, 1), axis_end)));
    }
  }
  if (wing.closed_root) {
    sewing.Add(planar_face(blunt ? std::vector<Handle(Geom_Curve)>{root_upper, root_base, root_lower}
                                 : std::vector<Handle(Geom_Curve)>{root_upper, root_lower}));
  }
  sewing.Perform();
  TopoDS_Shape sewn = sewing.SewedShape();
  TopExp_Explorer shell(sewn, TopAbs_SHELL);
  if (!shell.More())
    throw Error(ErrorKind::internal, "the wing's faces do not sew to a shell", "check the section");
  if (!wing.closed_root) {
    // Sewing orients the shell as it likes: the face that looks most upward tells which way is out.
    TopoDS_Shell open = TopoDS::Shell(shell.Current());
    if (upper_side_normal(open).Z() < 0) open.Reverse();
    return wrap(open);
  }
  BRepBuilderAPI_MakeSolid solid(TopoDS::Shell(shell.Current()));
  TopoDS_Solid result = solid.Solid();
  BRepLib::OrientClosedSolid(result);
  return wrap(result);
}

Shape make_onera_m6() {
  HalfWing wing;
  wing.airfoil = onera_d();
  wing.root_chord = 0.8059;
  wing.tip_chord = 0.8059 * 0.562;
  wing.semi_span = 1.1963;
  wing.leading_edge_sweep_degrees = 30;
  wing.tip = WingTip::rounded;
  return make_half_wing(wing);
}

}  // namespace flowcage
