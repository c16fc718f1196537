#include "occ_bridge/internal/tips.hpp"

#include <BRepAdaptor_Surface.hxx>
#include <BRepTools.hxx>
#include <BRep_Tool.hxx>
#include <Geom2d_Curve.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Vertex.hxx>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace flowcage::occ {
namespace {

/// The largest angle between normals of the face beside a degenerate edge; 0 where they cannot be had.
double normal_spread(const TopoDS_Face& face, const TopoDS_Edge& edge) {
  constexpr int samples = 16;
  constexpr double beside = 1e-4;  // of the way to the middle of the face's parameters
  double first = 0, last = 0;
  const Handle(Geom2d_Curve) curve = BRep_Tool::CurveOnSurface(edge, face, first, last);
  if (curve.IsNull()) return 0;
  const BRepAdaptor_Surface surface(face, Standard_False);
  double u0 = 0, u1 = 0, v0 = 0, v1 = 0;
  BRepTools::UVBounds(face, u0, u1, v0, v1);
  // Straight across the edge: toward the middle of the parameter that it does not run along.
  const gp_Pnt2d start = curve->Value(first), end = curve->Value(last);
  const bool along_u = std::abs(end.X() - start.X()) > std::abs(end.Y() - start.Y());
  std::vector<gp_Vec> normals;
  for (int i = 0; i <= samples; ++i) {
    gp_Pnt2d at = curve->Value(first + (last - first) * i / samples);
    if (along_u) {
      at.SetY(at.Y() + beside * (0.5 * (v0 + v1) - at.Y()));
    } else {
      at.SetX(at.X() + beside * (0.5 * (u0 + u1) - at.X()));
    }
    gp_Pnt point;
    gp_Vec du, dv;
    surface.D1(at.X(), at.Y(), point, du, dv);
    const gp_Vec normal = du.Crossed(dv);
    if (normal.Magnitude() > 1e-12 * du.Magnitude() * dv.Magnitude()) normals.push_back(normal);
  }
  double spread = 0;
  for (std::size_t a = 0; a < normals.size(); ++a) {
    for (std::size_t b = a + 1; b < normals.size(); ++b) {
      spread = std::max(spread, normals[a].Angle(normals[b]));
    }
  }
  return spread;
}

bool ends_a_chain(const FeatureGraph& features, const Vec3& at, double apart) {
  return std::ranges::any_of(features.corners, [&](const Vec3& c) { return (c - at).norm() < apart; });
}

}  // namespace

std::vector<Vec3> find_tips(std::span<const TopoDS_Face> faces, const FeatureGraph& features,
                            double crease_angle, double apart) {
  std::vector<Vec3> tips;
  for (const TopoDS_Face& face : faces) {
    for (TopExp_Explorer it(face, TopAbs_EDGE); it.More(); it.Next()) {
      const TopoDS_Edge& edge = TopoDS::Edge(it.Current());
      if (!BRep_Tool::Degenerated(edge)) continue;
      const TopoDS_Vertex vertex = TopExp::FirstVertex(edge);
      if (vertex.IsNull() || normal_spread(face, edge) <= crease_angle) continue;
      const gp_Pnt p = BRep_Tool::Pnt(vertex);
      const Vec3 at(p.X(), p.Y(), p.Z());
      const bool known = std::ranges::any_of(tips, [&](const Vec3& t) { return (t - at).norm() < apart; });
      if (!known && !ends_a_chain(features, at, apart)) tips.push_back(at);
    }
  }
  return tips;
}

}  // namespace flowcage::occ
