#include "occ_bridge/internal/occ_patch.hpp"

#include <GeomAdaptor_Surface.hxx>
#include <GeomConvert.hxx>
#include <Geom_BSplineSurface.hxx>
#include <Geom_BezierSurface.hxx>
#include <Geom_RectangularTrimmedSurface.hxx>
#include <TColStd_Array1OfReal.hxx>
#include <algorithm>
#include <cmath>

#include "core/target/bspline_patch.hpp"

namespace flowcage {
namespace {

/// Interval ends of the given smoothness, cut to the window.
std::vector<double> intervals(const Handle(Geom_Surface) & surface, int axis, GeomAbs_Shape smoothness,
                              const Eigen::AlignedBox2d& window) {
  const GeomAdaptor_Surface adaptor(surface, window.min().x(), window.max().x(), window.min().y(),
                                    window.max().y());
  const int count = axis == 0 ? adaptor.NbUIntervals(smoothness) : adaptor.NbVIntervals(smoothness);
  TColStd_Array1OfReal ends(1, count + 1);
  if (axis == 0) {
    adaptor.UIntervals(ends, smoothness);
  } else {
    adaptor.VIntervals(ends, smoothness);
  }
  const double low = window.min()[axis], high = window.max()[axis], tiny = 1e-12 * (high - low);
  std::vector<double> result{low};
  for (const double t : ends) {
    if (t > result.back() + tiny && t < high - tiny) result.push_back(t);
  }
  result.push_back(high);
  return result;
}

class OccPatch final : public BoundedPatch {
 public:
  OccPatch(Handle(Geom_Surface) surface, const Eigen::AlignedBox2d& window)
      : surface_(std::move(surface)), window_(window) {
    const GeomAbs_SurfaceType type = GeomAdaptor_Surface(surface_).GetType();
    elementary_ = type == GeomAbs_Plane || type == GeomAbs_Cylinder || type == GeomAbs_Cone ||
                  type == GeomAbs_Sphere || type == GeomAbs_Torus;
    for (int axis = 0; axis < 2; ++axis) {
      breaks_[axis] = elementary_ ? std::vector<double>{window.min()[axis], window.max()[axis]}
                                  : intervals(surface_, axis, GeomAbs_CN, window);
    }
  }

  PatchPoint first(const Vec2& uv) const override {
    gp_Pnt p;
    gp_Vec du, dv;
    surface_->D1(uv.x(), uv.y(), p, du, dv);
    return {to_vec3(p), to_vec3(du), to_vec3(dv)};
  }
  PatchCurvature second(const Vec2& uv) const override {
    gp_Pnt p;
    gp_Vec du, dv, duu, dvv, duv;
    surface_->D2(uv.x(), uv.y(), p, du, dv, duu, dvv, duv);
    return {to_vec3(p), to_vec3(du), to_vec3(dv), to_vec3(duu), to_vec3(duv), to_vec3(dvv)};
  }
  Eigen::AlignedBox2d domain() const override { return window_; }
  bool periodic_u() const override { return false; }
  bool periodic_v() const override { return false; }
  std::vector<double> breaks(int axis) const override { return breaks_[axis]; }

  Vec2 deviation(const Eigen::AlignedBox2d& box) const override {
    // |S - B| <= (du^2 max|S_uu| + dv^2 max|S_vv|) / 8, the bilinear interpolant's error. The maxima are of
    // nine samples; elementary surfaces' second derivatives vary as a cosine or linearly.
    double uu = 0, vv = 0;
    for (const double a : {0.0, 0.5, 1.0}) {
      for (const double b : {0.0, 0.5, 1.0}) {
        const PatchCurvature c = second(box.min() + Vec2(a, b).cwiseProduct(box.sizes()));
        uu = std::max(uu, c.duu.norm());
        vv = std::max(vv, c.dvv.norm());
      }
    }
    const Vec2 sizes = box.sizes();
    const double safety = elementary_ ? 1.1 : 2.0;
    return safety / 8 * Vec2(sizes.x() * sizes.x() * uu, sizes.y() * sizes.y() * vv);
  }

 private:
  Handle(Geom_Surface) surface_;
  Eigen::AlignedBox2d window_;
  bool elementary_ = false;
  std::array<std::vector<double>, 2> breaks_;
};

/// The B-spline's arrays; null where the surface's own parameters cannot be kept.
std::shared_ptr<const BSplineSurface> read_bspline(const Handle(Geom_BSplineSurface) & source,
                                                   const Eigen::AlignedBox2d& window) {
  Handle(Geom_BSplineSurface) s = Handle(Geom_BSplineSurface)::DownCast(source->Copy());
  if (s->IsUPeriodic()) s->SetUNotPeriodic();
  if (s->IsVPeriodic()) s->SetVNotPeriodic();
  double u0 = 0, u1 = 0, v0 = 0, v1 = 0;
  s->Bounds(u0, u1, v0, v1);
  const double tiny = 1e-9;
  if (window.min().x() < u0 - tiny * (u1 - u0) || window.max().x() > u1 + tiny * (u1 - u0) ||
      window.min().y() < v0 - tiny * (v1 - v0) || window.max().y() > v1 + tiny * (v1 - v0)) {
    return nullptr;
  }
  if (s->UDegree() > BSplinePatch::max_degree || s->VDegree() > BSplinePatch::max_degree) return nullptr;
  auto result = std::make_shared<BSplineSurface>();
  result->degree_u = s->UDegree();
  result->degree_v = s->VDegree();
  for (const double t : s->UKnotSequence()) result->knots_u.push_back(t);
  for (const double t : s->VKnotSequence()) result->knots_v.push_back(t);
  const bool rational = s->IsURational() || s->IsVRational();
  for (int i = 1; i <= s->NbUPoles(); ++i) {
    for (int j = 1; j <= s->NbVPoles(); ++j) {
      result->poles.push_back(to_vec3(s->Pole(i, j)));
      if (rational) result->weights.push_back(s->Weight(i, j));
    }
  }
  if (result->count_u() != s->NbUPoles() || result->count_v() != s->NbVPoles()) return nullptr;
  return result;
}

}  // namespace

Vec3 to_vec3(const gp_Pnt& p) {
  return {p.X(), p.Y(), p.Z()};
}

Vec3 to_vec3(const gp_Vec& v) {
  return {v.X(), v.Y(), v.Z()};
}

std::vector<std::unique_ptr<BoundedPatch>> smooth_patches(const Handle(Geom_Surface) & surface,
                                                          const Eigen::AlignedBox2d& window) {
  Handle(Geom_Surface) basis = surface;
  while (const auto trimmed = Handle(Geom_RectangularTrimmedSurface)::DownCast(basis)) {
    basis = trimmed->BasisSurface();
  }
  std::shared_ptr<const BSplineSurface> bspline;
  if (const auto bezier = Handle(Geom_BezierSurface)::DownCast(basis)) {
    basis = GeomConvert::SurfaceToBSplineSurface(bezier);
  }
  if (const auto source = Handle(Geom_BSplineSurface)::DownCast(basis))
    bspline = read_bspline(source, window);
  const std::vector<double> u = intervals(basis, 0, GeomAbs_C1, window);
  const std::vector<double> v = intervals(basis, 1, GeomAbs_C1, window);
  std::vector<std::unique_ptr<BoundedPatch>> patches;
  for (std::size_t i = 0; i + 1 < u.size(); ++i) {
    for (std::size_t j = 0; j + 1 < v.size(); ++j) {
      const Eigen::AlignedBox2d part(Vec2(u[i], v[j]), Vec2(u[i + 1], v[j + 1]));
      if (bspline) {
        patches.push_back(std::make_unique<BSplinePatch>(bspline, part));
      } else {
        patches.push_back(std::make_unique<OccPatch>(basis, part));
      }
    }
  }
  return patches;
}

OccCurve::OccCurve(Handle(Geom_Curve) curve, double first, double last)
    : curve_(std::move(curve)), first_(first), last_(last) {}

CurveDerivatives OccCurve::second(double t) const {
  gp_Pnt p;
  gp_Vec d, dd;
  curve_->D2(t, p, d, dd);
  return {to_vec3(p), to_vec3(d), to_vec3(dd)};
}

}  // namespace flowcage
