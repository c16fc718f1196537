#include "occ_bridge/internal/split_kinks.hpp"

#include <fmt/format.h>
#include <BRepTools.hxx>
#include <BRep_Tool.hxx>
#include <GeomAdaptor_Surface.hxx>
#include <Geom_ElementarySurface.hxx>
#include <ShapeBuild_ReShape.hxx>
#include <ShapeExtend.hxx>
#include <ShapeUpgrade_FaceDivide.hxx>
#include <ShapeUpgrade_SplitSurface.hxx>
#include <ShapeUpgrade_WireDivide.hxx>
#include <TColStd_Array1OfReal.hxx>
#include <TColStd_HSequenceOfReal.hxx>
#include <TopExp.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Face.hxx>
#include <cmath>
#include <optional>

#include "occ_bridge/internal/kernel_scope.hpp"

namespace flowcage::occ {

namespace {

struct UvBox {
  double u0 = 0, u1 = 0, v0 = 0, v1 = 0;
};

/// Parameters of the kinked knot lines of one face.
struct KnotLines {
  std::vector<double> u, v;
  bool empty() const { return u.empty() && v.empty(); }
};

/// Unit normal of the surface without the face's orientation; none where the parametrisation is singular.
std::optional<gp_Vec> normal_at(const Geom_Surface& surface, double u, double v) {
  gp_Pnt p;
  gp_Vec du, dv;
  surface.D1(u, v, p, du, dv);
  const gp_Vec n = du.Crossed(dv);
  const double size = n.Magnitude();
  if (!(size > 1e-9 * du.Magnitude() * dv.Magnitude()) || size < 1e-100) return std::nullopt;
  return n / size;
}

/// Borders of the pieces of the surface that are C1 (`along_u`: lines of constant u), cut to the box.
std::vector<double> breaks_of(const GeomAdaptor_Surface& surface, bool along_u, const UvBox& box) {
  const int count = along_u ? surface.NbUIntervals(GeomAbs_C1) : surface.NbVIntervals(GeomAbs_C1);
  TColStd_Array1OfReal values(1, count + 1);
  along_u ? surface.UIntervals(values, GeomAbs_C1) : surface.VIntervals(values, GeomAbs_C1);
  const double low = along_u ? box.u0 : box.v0, high = along_u ? box.u1 : box.v1;
  const double eps = 1e-9 * (high - low);
  std::vector<double> breaks{low};
  for (const double value : values) {
    if (value > breaks.back() + eps && value < high - eps) breaks.push_back(value);
  }
  breaks.push_back(high);
  return breaks;
}

/// Those of `breaks` (its ends left out) across which the normals turn by more than `angle`.
std::vector<double> kinked(const Geom_Surface& surface, bool along_u, const std::vector<double>& breaks,
                           const std::vector<double>& other, double angle) {
  std::vector<double> result;
  for (std::size_t i = 1; i + 1 < breaks.size(); ++i) {
    // So near to the line that curvature turns the normal by far less than any angle of interest.
    const double eps = 1e-7 * std::min(breaks[i] - breaks[i - 1], breaks[i + 1] - breaks[i]);
    double largest = 0;
    for (std::size_t j = 0; j + 1 < other.size(); ++j) {
      for (const double fraction : {0.02, 0.26, 0.5, 0.74, 0.98}) {
        const double t = other[j] + fraction * (other[j + 1] - other[j]);
        const auto at = [&](double x) {
          return along_u ? normal_at(surface, x, t) : normal_at(surface, t, x);
        };
        const auto before = at(breaks[i] - eps), after = at(breaks[i] + eps);
        if (before && after) largest = std::max(largest, before->Angle(*after));
      }
    }
    if (largest > angle) result.push_back(breaks[i]);
  }
  return result;
}

KnotLines kinks_of(const TopoDS_Face& face, double angle) {
  TopLoc_Location location;
  const Handle(Geom_Surface) surface = BRep_Tool::Surface(face, location);
  if (surface.IsNull() || surface->IsKind(STANDARD_TYPE(Geom_ElementarySurface))) return {};
  UvBox box;
  BRepTools::UVBounds(face, box.u0, box.u1, box.v0, box.v1);
  const GeomAdaptor_Surface adaptor(surface);
  const auto u = breaks_of(adaptor, true, box), v = breaks_of(adaptor, false, box);
  return {kinked(*surface, true, u, v, angle), kinked(*surface, false, v, u, angle)};
}

/// Splits at given parameters; the kernel's own tools choose them by continuity alone.
class SplitAt : public ShapeUpgrade_SplitSurface {
 public:
  explicit SplitAt(KnotLines lines) : lines_(std::move(lines)) {}
  void Compute(const Standard_Boolean) override {
    insert(*myUSplitValues, lines_.u);
    insert(*myVSplitValues, lines_.v);
    if (myUSplitValues->Length() > 2 || myVSplitValues->Length() > 2) {
      myStatus |= ShapeExtend::EncodeStatus(ShapeExtend_DONE1);
    }
  }

 private:
  /// `values` holds the first and last parameter.
  static void insert(TColStd_HSequenceOfReal& values, const std::vector<double>& inner) {
    for (const double value : inner) {
      if (value > values.First() && value < values.Last()) values.InsertBefore(values.Length(), value);
    }
  }
  KnotLines lines_;
};

}  // namespace

TopoDS_Shape split_kinks(const TopoDS_Shape& shape, double angle, FaceLabels& labels,
                         std::vector<std::string>& warnings) {
  TopTools_IndexedMapOfShape faces;
  TopExp::MapShapes(shape, TopAbs_FACE, faces);
  const Handle(ShapeBuild_ReShape) context = new ShapeBuild_ReShape;
  int split = 0;
  std::string first;
  for (int i = 1; i <= faces.Extent(); ++i) {
    const TopoDS_Face face = TopoDS::Face(faces(i));
    KnotLines lines;
    const std::string failure = failure_of([&] {
      lines = kinks_of(face, angle);
      if (lines.empty()) return;
      // Forward: the tool loses a reversed face's orientation in its result.
      ShapeUpgrade_FaceDivide divide(TopoDS::Face(face.Oriented(TopAbs_FORWARD)));
      divide.SetContext(context);
      divide.SetSplitSurfaceTool(new SplitAt(lines));
      divide.SetWireDivideTool(nullptr);
      divide.Perform();
      const TopoDS_Shape parts = divide.Result();
      if (parts.IsNull() || divide.Status(ShapeExtend_FAIL)) throw Standard_Failure("no result");
      labels.inherit(face, parts);
      context->Replace(face.Oriented(TopAbs_FORWARD), parts);
    });
    if (!failure.empty()) {
      warnings.push_back(fmt::format("{} could not be examined for or split at its kinks ({})",
                                     labels.word_for(face), failure));
    } else if (!lines.empty()) {
      ++split;
      if (split == 1) first = labels.word_for(face);
    }
  }
  if (split == 0) return shape;
  warnings.push_back(fmt::format(
      "{} face(s) (the first is {}) have kinks along knot lines inside: split there", split, first));
  const TopoDS_Shape result = context->Apply(shape);
  for (int i = 1; i <= faces.Extent(); ++i) {  // neighbours whose edges were split with a face
    labels.inherit(faces(i), context->Apply(faces(i)));
  }
  return result;
}

}  // namespace flowcage::occ
