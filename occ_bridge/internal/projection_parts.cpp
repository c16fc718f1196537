#include "occ_bridge/internal/projection_parts.hpp"

#include <BRepAdaptor_Curve.hxx>
#include <BRep_Tool.hxx>
#include <GeomAdaptor_Curve.hxx>
#include <Geom_Curve.hxx>
#include <Standard_Failure.hxx>
#include <TColStd_Array1OfReal.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Vertex.hxx>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/error.hpp"
#include "core/base/parallel.hpp"
#include "occ_bridge/internal/occ_patch.hpp"

namespace flowcage {
namespace {

// Relative to the model's diagonal.
constexpr double polygon_precision = 1e-6;  // of the trimming polygons
constexpr double smallest_cell = 1e-9;
constexpr double curve_flatness = 0.01;

/// An edge without a space curve: its parameter curve on the surface.
class CurveOnPatch final : public ParametricCurve {
 public:
  CurveOnPatch(Handle(Geom2d_Curve) pcurve, Handle(Geom_Surface) surface, double first, double last)
      : pcurve_(std::move(pcurve)), surface_(std::move(surface)), first_(first), last_(last) {}
  CurveDerivatives second(double t) const override {
    gp_Pnt2d uv;
    gp_Vec2d d, dd;
    pcurve_->D2(t, uv, d, dd);
    gp_Pnt p;
    gp_Vec u, v, uu, vv, uv_;
    surface_->D2(uv.X(), uv.Y(), p, u, v, uu, vv, uv_);
    const gp_Vec first = u * d.X() + v * d.Y();
    const gp_Vec second =
        u * dd.X() + v * dd.Y() + uu * (d.X() * d.X()) + uv_ * (2 * d.X() * d.Y()) + vv * (d.Y() * d.Y());
    return {to_vec3(p), to_vec3(first), to_vec3(second)};
  }
  std::array<double, 2> domain() const override { return {first_, last_}; }

 private:
  Handle(Geom2d_Curve) pcurve_;
  Handle(Geom_Surface) surface_;
  double first_, last_;
};

Box3 grown(const Box3& box, double by) {
  return {box.min() - Vec3::Constant(by), box.max() + Vec3::Constant(by)};
}

/// The outline polygon's extent in space: rough, for scales only.
Box3 vertex_box(const std::vector<TopoDS_Face>& faces) {
  Box3 box;
  for (const TopoDS_Face& face : faces) {
    for (TopExp_Explorer it(face, TopAbs_EDGE); it.More(); it.Next()) {
      try {
        const TopoDS_Edge edge = TopoDS::Edge(it.Current());
        if (BRep_Tool::Degenerated(edge)) continue;
        const BRepAdaptor_Curve curve(edge);
        for (int i = 0; i <= 4; ++i) {
          const double t = curve.FirstParameter() + (curve.LastParameter() - curve.FirstParameter()) * i / 4;
          const Vec3 p = to_vec3(curve.Value(t));
          if (p.allFinite()) box.extend(p);
        }
      } catch (const Standard_Failure&) {
        continue;  // the face's own turn reports it
      }
    }
  }
  return box;
}

/// The patch's sides that are not the window's (kinks inside of the face), or all where edges are missing.
std::array<bool, 4> open_sides(const BoundedPatch& patch, const FaceOutline& outline) {
  const Eigen::AlignedBox2d domain = patch.domain();
  const auto inner = [&](const Vec2& side, const Vec2& border, int axis) {
    return !outline.bounded || std::abs(side[axis] - border[axis]) > 1e-9 * outline.window.sizes()[axis];
  };
  return {inner(domain.min(), outline.window.min(), 0), inner(domain.max(), outline.window.max(), 0),
          inner(domain.min(), outline.window.min(), 1), inner(domain.max(), outline.window.max(), 1)};
}

void add_face(const TopoDS_Face& oriented, Index number, ProjectionParts& parts) {
  ProjectedFace& kept = parts.faces[number];
  const TopoDS_Face face = TopoDS::Face(oriented.Oriented(TopAbs_FORWARD));
  const FaceOutline outline = face_outline(face, polygon_precision * parts.length);
  kept.reversed = oriented.Orientation() == TopAbs_REVERSED;
  kept.classifier = std::make_unique<ExactClassifier>(face);
  kept.first_patch = static_cast<Index>(parts.patches.size());
  kept.trim_margin = 4 * outline.precision + 1e-9 * parts.length;
  TrimOutline trim;
  trim.segments = outline.segments;
  if (!trim.segments.empty()) {
    trim.reference = clear_point(outline);
    trim.reference_inside = kept.classifier->inside(trim.reference);
  }
  auto patches = smooth_patches(BRep_Tool::Surface(face), outline.window);
  double size = 0;
  for (const auto& patch : patches) {
    const Eigen::AlignedBox2d box = patch->domain();
    Box3 corners;
    for (int i = 0; i < 25; ++i) {
      const int row = i / 5, column = i % 5;
      const Vec2 fraction(0.25 * column, 0.25 * row);
      const Vec3 p = patch->first(box.min() + fraction.cwiseProduct(box.sizes())).position;
      if (!p.allFinite()) throw Error(ErrorKind::input, "a surface is not finite", "repair the CAD");
      corners.extend(p);
    }
    size = std::max(size, corners.diagonal().norm());
  }
  CellSettings settings;
  settings.max_size = 0.34 * size;
  settings.max_trimmed_size = 0.1 * size;
  settings.min_size = smallest_cell * parts.length;
  settings.margin = 2 * kept.trim_margin;
  const std::size_t first_cell = parts.cells.cells.size();
  try {
    for (auto& patch : patches) {
      settings.open_sides = open_sides(*patch, outline);
      append_cells(*patch, static_cast<Index>(parts.patches.size()), trim, settings, parts.cells);
      parts.patches.push_back(std::move(patch));
      parts.patch_face.push_back(number);
    }
  } catch (...) {
    parts.cells.cells.resize(first_cell);
    throw;
  }
  kept.patch_count = static_cast<Index>(parts.patches.size()) - kept.first_patch;
  // A face collapsed to a curve (fillers at sharp trailing edges) has no normal to answer with; its
  // neighbours' borders run where it is.
  const bool has_area = std::any_of(parts.cells.cells.begin() + static_cast<std::ptrdiff_t>(first_cell),
                                    parts.cells.cells.end(), [&](const PatchCell& cell) {
                                      const PatchPoint at =
                                          parts.patches[cell.patch]->first(cell.box.center());
                                      return at.du.cross(at.dv).norm() > 1e-9 * at.du.norm() * at.dv.norm();
                                    });
  if (!has_area) {
    parts.cells.cells.resize(first_cell);
    throw Error(ErrorKind::input, "it has no area", "repair the CAD");
  }
  kept.usable = true;
}

/// Pieces of a curve between breaks, halved until within curve_flatness of their chord. The bound is the
/// linear interpolant's error, dt^2 / 8 max|C''|, with five samples a piece and a factor of two.
void add_pieces(const ParametricCurve& curve, Index number, const std::vector<double>& breaks,
                ProjectionParts& parts) {
  struct Task {
    double low, high;
    int depth;
  };
  std::vector<Task> tasks;
  for (std::size_t i = 0; i + 1 < breaks.size(); ++i) tasks.push_back({breaks[i], breaks[i + 1], 0});
  while (!tasks.empty()) {
    const Task task = tasks.back();
    tasks.pop_back();
    double bend = 0, reach = 0;
    const Vec3 a = curve.second(task.low).position, b = curve.second(task.high).position;
    for (int i = 0; i <= 4; ++i) {
      const CurveDerivatives at = curve.second(task.low + (task.high - task.low) * i / 4);
      bend = std::max(bend, at.dd.norm());
      reach = std::max(reach, (at.position - a).norm());
    }
    const double dt = task.high - task.low, slack = 2 * dt * dt / 8 * bend;
    if (!std::isfinite(slack))
      throw Error(ErrorKind::input, "an edge's curve is not finite", "repair the CAD");
    const double chord = (b - a).norm();
    if (slack > curve_flatness * chord && std::max(reach, chord) > smallest_cell * parts.length &&
        task.depth < 24) {
      const double middle = 0.5 * (task.low + task.high);
      tasks.push_back({task.low, middle, task.depth + 1});
      tasks.push_back({middle, task.high, task.depth + 1});
      continue;
    }
    parts.pieces.push_back({number, task.low, task.high, a, b, slack, false});
  }
}

void add_edge(const TopoDS_Edge& edge, const std::vector<TopoDS_Face>& faces, const std::vector<Index>& users,
              ProjectionParts& parts) {
  if (BRep_Tool::Degenerated(edge)) return;
  BorderCurve border;
  for (const Index user : users) {
    double first = 0, last = 0;
    const TopoDS_Face face = TopoDS::Face(faces[user].Oriented(TopAbs_FORWARD));
    border.sides.push_back({user, BRep_Tool::CurveOnSurface(edge, face, first, last)});
  }
  double first = 0, last = 0;
  std::vector<double> breaks;
  const Handle(Geom_Curve) space = BRep_Tool::Curve(edge, first, last);
  if (!space.IsNull()) {
    const GeomAdaptor_Curve adaptor(space, first, last);
    TColStd_Array1OfReal ends(1, adaptor.NbIntervals(GeomAbs_CN) + 1);
    adaptor.Intervals(ends, GeomAbs_CN);
    breaks.assign(ends.begin(), ends.end());
    border.curve = std::make_unique<OccCurve>(space, first, last);
  } else {
    const TopoDS_Face face = TopoDS::Face(faces[users.front()].Oriented(TopAbs_FORWARD));
    const Handle(Geom2d_Curve) pcurve = BRep_Tool::CurveOnSurface(edge, face, first, last);
    if (pcurve.IsNull()) return;
    for (int i = 0; i <= 64; ++i) breaks.push_back(first + (last - first) * i / 64);
    border.curve = std::make_unique<CurveOnPatch>(pcurve, BRep_Tool::Surface(face), first, last);
  }
  if (!(last > first)) return;
  const auto number = static_cast<Index>(parts.curves.size());
  const std::size_t first_piece = parts.pieces.size();
  try {
    add_pieces(*border.curve, number, breaks, parts);
  } catch (const Error&) {
    parts.pieces.resize(first_piece);
    throw;
  }
  // A vertex is a point of the model in its own right: where it lies off the curve's end, it may be nearer.
  TopoDS_Vertex ends[2];
  TopExp::Vertices(TopoDS::Edge(edge.Oriented(TopAbs_FORWARD)), ends[0], ends[1]);
  for (int end = 0; end < 2; ++end) {
    if (ends[end].IsNull()) continue;
    const double t = end == 0 ? first : last;
    const Vec3 p = to_vec3(BRep_Tool::Pnt(ends[end]));
    const double gap = (p - border.curve->second(t).position).norm();
    if (gap > 1e-10 * parts.length) parts.pieces.push_back({number, t, t, p, p, 0, true});
  }
  parts.curves.push_back(std::move(border));
}

/// The unit du x dv, zero where the parametrisation is singular.
Vec3 regular_normal(const BoundedPatch& patch, const Vec2& uv) {
  const PatchPoint at = patch.first(uv);
  const Vec3 n = at.du.cross(at.dv);
  const Vec2 sizes = patch.domain().sizes();
  // Collapsed: one direction's length over the whole domain is nothing beside the other's.
  const double along_u = at.du.norm() * sizes.x(), along_v = at.dv.norm() * sizes.y();
  const bool regular =
      along_u > 1e-7 * along_v && along_v > 1e-7 * along_u && n.norm() > 1e-9 * at.du.norm() * at.dv.norm();
  return regular ? Vec3(n.normalized()) : Vec3::Zero();
}

/// The mean of normals a little inside: over a collapsed direction's whole length (a pole), else toward the
/// middle.
Vec3 limit_normal(const BoundedPatch& patch, const Vec2& uv) {
  const Eigen::AlignedBox2d domain = patch.domain();
  const Vec2 sizes = domain.sizes();
  const PatchPoint at = patch.first(uv);
  const double along_u = at.du.norm() * sizes.x(), along_v = at.dv.norm() * sizes.y();
  const int collapsed = along_u <= 1e-7 * along_v ? 0 : along_v <= 1e-7 * along_u ? 1 : -1;
  for (const double reach : {1e-5, 1e-3, 1e-1}) {
    Vec3 sum = Vec3::Zero();
    for (int i = 0; i < 16; ++i) {
      Vec2 near = uv + reach * (domain.center() - uv);
      if (collapsed >= 0) near[collapsed] = domain.min()[collapsed] + (i + 0.5) / 16 * sizes[collapsed];
      const PatchPoint p = patch.first(near);
      const Vec3 n = p.du.cross(p.dv);
      if (n.norm() > 1e-12 * p.du.norm() * p.dv.norm()) sum += n.normalized();
    }
    if (sum.norm() > 1) return sum.normalized();
  }
  return Vec3::Zero();
}

/// Polynomials that agree with cells and pieces to the rounding of an evaluation.
void add_polynomials(ProjectionParts& parts) {
  constexpr Offset grain = 64;
  std::vector<CellPolynomials::Fitted> fitted(parts.cells.cells.size());
  const auto tolerance = [&](const Vec3& p) {
    return 1e-14 * parts.length + 4 * std::numeric_limits<double>::epsilon() * p.cwiseAbs().maxCoeff();
  };
  const auto scaled_to = [](std::span<const double> unit, double low, double high) {
    std::vector<double> result;
    for (const double x : unit) result.push_back(0.5 * ((1 - x) * low + (1 + x) * high));
    return result;
  };
  parallel_for(static_cast<Offset>(fitted.size()), grain, [&](Offset begin, Offset end) {
    for (Offset c = begin; c < end; ++c) {
      const PatchCell& cell = parts.cells.cells[c];
      const auto sample = [&](std::span<const double> s, std::span<const double> t, std::span<Vec3> points) {
        const auto u = scaled_to(s, cell.box.min().x(), cell.box.max().x());
        const auto v = scaled_to(t, cell.box.min().y(), cell.box.max().y());
        parts.patches[cell.patch]->positions(u, v, points);
      };
      fitted[c] = fit_cell_polynomial(sample, CellKind::surface, tolerance(cell.p00));
    }
  });
  for (const auto& f : fitted) parts.cell_polynomials.append(f);
  fitted.assign(parts.pieces.size(), {});
  parallel_for(static_cast<Offset>(fitted.size()), grain, [&](Offset begin, Offset end) {
    for (Offset c = begin; c < end; ++c) {
      const CurvePiece& piece = parts.pieces[c];
      if (piece.vertex) continue;
      const ParametricCurve& curve = *parts.curves[piece.curve].curve;
      const auto sample = [&](std::span<const double> s, std::span<const double>, std::span<Vec3> points) {
        const auto t = scaled_to(s, piece.low, piece.high);
        for (std::size_t i = 0; i < t.size(); ++i) points[i] = curve.second(t[i]).position;
      };
      fitted[c] = fit_cell_polynomial(sample, CellKind::curve, tolerance(piece.a));
    }
  });
  for (const auto& f : fitted) parts.piece_polynomials.append(f);
}

}  // namespace

ProjectionParts build_projection(const std::vector<TopoDS_Face>& faces) {
  ProjectionParts parts;
  const Box3 box = vertex_box(faces);
  parts.length = box.isEmpty() ? 1.0 : std::max(box.diagonal().norm(), 1e-12);
  parts.faces.resize(faces.size());
  const auto note = [&](std::size_t face, const std::string& why) {
    parts.notes.push_back("face " + std::to_string(face) + " is left out: " + why);
  };
  for (std::size_t f = 0; f < faces.size(); ++f) {
    try {
      add_face(faces[f], static_cast<Index>(f), parts);
    } catch (const Standard_Failure& failure) {
      note(f, failure.GetMessageString());
    } catch (const Error& error) {
      note(f, error.what());
    }
  }
  TopTools_IndexedMapOfShape edges;
  std::vector<std::vector<Index>> users;
  for (std::size_t f = 0; f < faces.size(); ++f) {
    if (!parts.faces[f].usable) continue;
    for (TopExp_Explorer it(faces[f], TopAbs_EDGE); it.More(); it.Next()) {
      const int number = edges.Add(it.Current());
      users.resize(static_cast<std::size_t>(edges.Extent()));
      users[number - 1].push_back(static_cast<Index>(f));
    }
  }
  for (int e = 1; e <= edges.Extent(); ++e) {
    auto& of_edge = users[e - 1];
    of_edge.erase(std::unique(of_edge.begin(), of_edge.end()), of_edge.end());
    try {
      add_edge(TopoDS::Edge(edges(e)), faces, of_edge, parts);
    } catch (const Standard_Failure& failure) {
      parts.notes.push_back("an edge of face " + std::to_string(of_edge.front()) +
                            " is left out: " + failure.GetMessageString());
    } catch (const Error& error) {
      parts.notes.push_back("an edge of face " + std::to_string(of_edge.front()) +
                            " is left out: " + error.what());
    }
  }
  add_polynomials(parts);
  std::vector<Box3> boxes;
  std::vector<HullItem> hulls;
  for (const PatchCell& cell : parts.cells.cells) {
    hulls.push_back({{cell.p00, cell.p10, cell.p01, cell.p11}, cell.slack});
  }
  for (const CurvePiece& piece : parts.pieces) {
    hulls.push_back({{piece.a, piece.b, piece.a, piece.b}, piece.slack});
  }
  for (const HullItem& hull : hulls) {
    Box3 corners;
    for (const Vec3& p : hull.points) corners.extend(p);
    boxes.push_back(grown(corners, hull.slack));
  }
  parts.tree = build_box_tree(boxes);
  parts.near_tree = build_oriented_tree(parts.tree, hulls);
  return parts;
}

Vec3 face_normal(const ProjectionParts& parts, Index face, const Vec2& uv) {
  const ProjectedFace& kept = parts.faces[face];
  if (!kept.usable) return Vec3::Zero();
  const double sign = kept.reversed ? -1 : 1;
  // The patches that hold (u, v), several at a kink; the nearest ones where none does.
  double nearest = std::numeric_limits<double>::infinity();
  const auto distance = [&](Index p) { return parts.patches[p]->domain().squaredExteriorDistance(uv); };
  const Index last = kept.first_patch + kept.patch_count;
  for (Index p = kept.first_patch; p < last; ++p) nearest = std::min(nearest, distance(p));
  for (auto* const rule : {&regular_normal, &limit_normal}) {
    for (Index p = kept.first_patch; p < last; ++p) {
      if (distance(p) > nearest) continue;
      const Eigen::AlignedBox2d domain = parts.patches[p]->domain();
      const Vec3 n = (*rule)(*parts.patches[p], uv.cwiseMax(domain.min()).cwiseMin(domain.max()));
      if (n != Vec3::Zero()) return sign * n;
    }
  }
  // A patch without area here: the face's first middle that has a normal.
  for (Index p = kept.first_patch; p < last; ++p) {
    const Vec3 n = regular_normal(*parts.patches[p], parts.patches[p]->domain().center());
    if (n != Vec3::Zero()) return sign * n;
  }
  return Vec3::Zero();
}

}  // namespace flowcage
