#include "occ_bridge/internal/heal.hpp"

#include <fmt/format.h>
#include <BRepBuilderAPI_Sewing.hxx>
#include <BRepTools.hxx>
#include <BRepTools_ReShape.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <Geom_Surface.hxx>
#include <Poly_Triangulation.hxx>
#include <ShapeFix_Shell.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Compound.hxx>
#include <TopoDS_Iterator.hxx>
#include <TopoDS_Shell.hxx>
#include <TopoDS_Solid.hxx>
#include <unordered_map>

#include "occ_bridge/internal/face_edges.hpp"
#include "occ_bridge/internal/kernel_scope.hpp"

namespace flowcage::occ {

namespace {

using Shapes = std::vector<TopoDS_Shape>;

TopoDS_Compound compound_of(const Shapes& shapes) {
  TopoDS_Compound compound;
  BRep_Builder builder;
  builder.MakeCompound(compound);
  for (const TopoDS_Shape& shape : shapes) builder.Add(compound, shape);
  return compound;
}

Shapes explore(const TopoDS_Shape& shape, TopAbs_ShapeEnum kind, TopAbs_ShapeEnum avoid = TopAbs_SHAPE) {
  Shapes found;
  for (TopExp_Explorer it(shape, kind, avoid); it.More(); it.Next()) found.push_back(it.Current());
  return found;
}

bool closed(const TopoDS_Shape& shell) {
  const FaceEdges topology = face_edges_of(shell);
  return topology.face_count() > 0 && topology.free_edge_count() == 0;
}

TopoDS_Shape solid_of(const TopoDS_Shape& shell) {
  TopoDS_Solid solid;
  BRep_Builder builder;
  builder.MakeSolid(solid);
  builder.Add(solid, shell);
  return solid;
}

TopoDS_Shape shell_of(const TopoDS_Shape& face) {
  TopoDS_Shell shell;
  BRep_Builder builder;
  builder.MakeShell(shell);
  builder.Add(shell, face);
  return shell;
}

/// The side that each face has in the file, by the face's identity.
using Sides = std::unordered_map<const TopoDS_TShape*, TopAbs_Orientation>;

Sides sides_of(const Shapes& shapes) {
  Sides sides;
  for (const TopoDS_Shape& shape : shapes) {
    for (const TopoDS_Shape& face : explore(shape, TopAbs_FACE)) {
      sides.emplace(face.TShape().get(), face.Orientation());
    }
  }
  return sides;
}

bool consistent(const TopoDS_Shape& shell) {
  const FaceEdges topology = face_edges_of(shell);
  for (Index e = 0; e < topology.edge_count(); ++e) {
    if (topology.is_inconsistent(e)) return false;
  }
  return true;
}

/// The shells that a shell with faces of both sides falls into once its faces agree.
Shapes with_consistent_sides(const TopoDS_Shape& shell, std::vector<std::string>& warnings) {
  if (consistent(shell)) return {shell};
  Shapes result;
  const std::string failure = failure_of([&] {
    ShapeFix_Shell fix;
    fix.FixFaceOrientation(TopoDS::Shell(shell), Standard_True, Standard_False);
    result = explore(fix.Shape(), TopAbs_SHELL);
  });
  if (!failure.empty() || result.empty()) return {shell};
  for (const TopoDS_Shape& fixed : result) {
    if (!consistent(fixed))
      warnings.emplace_back("a shell's faces do not agree on a side (is it one-sided?)");
  }
  return result;
}

/// Closed solids and shells on one side, everything that sewing may still close on the other.
struct Parts {
  Shapes closed, open;
};

Parts parts_of(const TopoDS_Shape& shape, std::vector<std::string>& warnings) {
  Parts parts;
  for (const TopoDS_Shape& solid : explore(shape, TopAbs_SOLID)) {
    const Shapes shells = explore(solid, TopAbs_SHELL);
    if (closed(solid) && consistent(solid)) {
      parts.closed.push_back(solid);
    } else if (closed(solid)) {
      for (const TopoDS_Shape& shell : shells) {
        for (const TopoDS_Shape& part : with_consistent_sides(shell, warnings)) {
          parts.closed.push_back(solid_of(part));
        }
      }
    } else {
      for (const TopoDS_Shape& shell : shells) parts.open.push_back(shell);
    }
  }
  for (const TopoDS_Shape& shell : explore(shape, TopAbs_SHELL, TopAbs_SOLID)) {
    if (closed(shell)) {
      for (const TopoDS_Shape& part : with_consistent_sides(shell, warnings)) {
        parts.closed.push_back(solid_of(part));
      }
    } else {
      parts.open.push_back(shell);
    }
  }
  for (const TopoDS_Shape& face : explore(shape, TopAbs_FACE, TopAbs_SHELL)) {
    if (closed(face)) {
      parts.closed.push_back(solid_of(shell_of(face)));
    } else {
      parts.open.push_back(face);
    }
  }
  return parts;
}

/// One attempt at sewing. The attempt's faces keep their identity or stand for one face of the input.
struct Attempt {
  TopoDS_Shape shape{};
  double tolerance = 0;
  Index free_edges = 0, lost_faces = 0;
  std::vector<std::pair<TopoDS_Shape, TopoDS_Shape>> modified{};  ///< input face, its successor
};

Attempt sew(const Shapes& open, double tolerance, const std::string& stage, Progress& progress) {
  BRepBuilderAPI_Sewing sewing(tolerance);
  for (const TopoDS_Shape& shape : open) sewing.Add(shape);
  const Handle(KernelProgress) bridge = new KernelProgress(progress, stage);
  sewing.Perform(bridge->Start());
  progress.step(stage, 1.0);
  Attempt attempt{.shape = sewing.SewedShape(), .tolerance = tolerance};
  if (attempt.shape.IsNull()) throw Standard_Failure("sewing left nothing");
  for (const TopoDS_Shape& shape : open) {
    for (const TopoDS_Shape& face : explore(shape, TopAbs_FACE)) {
      const TopoDS_Shape successor =
          sewing.IsModified(shape) || sewing.IsModifiedSubShape(face) ? sewing.ModifiedSubShape(face) : face;
      attempt.modified.emplace_back(face, successor);
    }
  }
  const FaceEdges before = face_edges_of(compound_of(open)), after = face_edges_of(attempt.shape);
  attempt.free_edges = after.free_edge_count();
  attempt.lost_faces = before.face_count() - after.face_count();
  return attempt;
}

/// True where most faces of the shell look the other way than in the file.
bool mostly_reversed(const TopoDS_Shape& shell, const Sides& sides) {
  int balance = 0;
  for (const TopoDS_Shape& face : explore(shell, TopAbs_FACE)) {
    const auto found = sides.find(face.TShape().get());
    if (found != sides.end()) balance += found->second == face.Orientation() ? 1 : -1;
  }
  return balance < 0;
}

double signed_volume(const TopoDS_Shape& solid) {
  double volume = 0;
  for (const TopoDS_Shape& shape : explore(solid, TopAbs_FACE)) {
    TopLoc_Location location;
    const auto mesh = BRep_Tool::Triangulation(TopoDS::Face(shape), location);
    if (mesh.IsNull()) continue;
    const gp_Trsf trsf = location.Transformation();
    const bool flip =
        shape.Orientation() == TopAbs_REVERSED;  // also under a mirroring location: the winding mirrors, too
    for (int t = 1; t <= mesh->NbTriangles(); ++t) {
      int a = 0, b = 0, c = 0;
      mesh->Triangle(t).Get(a, b, c);
      const gp_XYZ p = mesh->Node(a).Transformed(trsf).XYZ();
      const gp_XYZ q = mesh->Node(b).Transformed(trsf).XYZ();
      const gp_XYZ r = mesh->Node(c).Transformed(trsf).XYZ();
      volume += (flip ? -1 : 1) * p.Dot(q.Crossed(r)) / 6;
    }
  }
  return volume;
}

/// Area of the face's parameter rectangle in space, divided by its longer extent: at least the face's own
/// mean width.
double untrimmed_width(const TopoDS_Face& face) {
  TopLoc_Location location;
  const Handle(Geom_Surface) surface = BRep_Tool::Surface(face, location);
  double u0 = 0, u1 = 0, v0 = 0, v1 = 0;
  BRepTools::UVBounds(face, u0, u1, v0, v1);
  constexpr int n = 24;
  const double du = (u1 - u0) / n, dv = (v1 - v0) / n;
  double area = 0, extent = 0;
  const gp_Pnt start = surface->Value(u0, v0);
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      gp_Pnt p;
      gp_Vec pu, pv;
      surface->D1(u0 + (i + 0.5) * du, v0 + (j + 0.5) * dv, p, pu, pv);
      area += std::abs(du * dv) * pu.Crossed(pv).Magnitude();
      extent = std::max(extent, p.Distance(start));
    }
  }
  return extent > 0 ? area / extent : 0;
}

}  // namespace

SewnShape sew_open_parts(const TopoDS_Shape& shape, const SewSettings& settings, FaceLabels& labels,
                         std::vector<std::string>& warnings, Progress& progress) {
  Parts parts = parts_of(shape, warnings);
  SewnShape result;
  if (!parts.open.empty()) {
    const TopoDS_Compound open = compound_of(parts.open);
    Attempt best{.shape = open, .free_edges = face_edges_of(open).free_edge_count()};
    result.free_edges_before = best.free_edges;
    for (const double relative : settings.tolerances) {
      if (best.free_edges == 0) break;
      const std::string stage = fmt::format("sew at {:g} of the diagonal", relative);
      progress.step(stage, 0.0);
      Attempt attempt;
      const std::string failure =
          failure_of([&] { attempt = sew(parts.open, relative * settings.diagonal, stage, progress); });
      if (!failure.empty()) {
        warnings.push_back(stage + " failed (" + failure + ")");
      } else if (attempt.free_edges < best.free_edges) {
        best = std::move(attempt);
      }
    }
    Sides sides = sides_of(parts.open);
    for (const auto& [before, after] : best.modified) {
      labels.inherit(before, after);
      if (!after.IsNull()) sides.emplace(after.TShape().get(), before.Orientation());
    }
    if (best.lost_faces > 0) {
      warnings.push_back(
          fmt::format("sewing removed {} face(s) smaller than its tolerance", best.lost_faces));
    }
    result.tolerance = best.tolerance;
    result.free_edges = best.free_edges;
    parts.open.clear();
    for (const TopoDS_Shape& face : explore(best.shape, TopAbs_FACE, TopAbs_SHELL)) {
      if (closed(face)) {
        parts.closed.push_back(solid_of(shell_of(face)));
      } else {
        parts.open.push_back(face);
      }
    }
    for (const TopoDS_Shape& sewn : explore(best.shape, TopAbs_SHELL)) {
      for (TopoDS_Shape shell : with_consistent_sides(sewn, warnings)) {
        if (closed(shell)) {
          parts.closed.push_back(solid_of(shell));
        } else {
          if (mostly_reversed(shell, sides)) shell.Reverse();
          parts.open.push_back(shell);
        }
      }
    }
  }
  Shapes all = parts.closed;
  all.insert(all.end(), parts.open.begin(), parts.open.end());
  result.shape = compound_of(all);
  return result;
}

TopoDS_Shape orient_outward(const TopoDS_Shape& shape) {
  Shapes parts;
  for (TopoDS_Iterator it(shape); it.More(); it.Next()) {
    TopoDS_Shape part = it.Value();
    if (part.ShapeType() == TopAbs_SOLID && signed_volume(part) < 0) part.Reverse();
    parts.push_back(part);
  }
  return compound_of(parts);
}

TopoDS_Shape without_slivers(const TopoDS_Shape& shape, double width, const FaceLabels& labels,
                             std::vector<std::string>& warnings) {
  const Handle(BRepTools_ReShape) context = new BRepTools_ReShape;
  int removed = 0;
  std::string where;
  const FaceEdges topology = face_edges_of(shape);
  for (Index f = 0; f < topology.face_count(); ++f) {
    double mean_width = width;
    const std::string failure = failure_of([&] { mean_width = untrimmed_width(topology.face(f)); });
    if (!failure.empty() || mean_width >= width) continue;
    if (removed++ == 0) where = labels.word_for(topology.face(f));
    context->Remove(topology.face(f));
  }
  if (removed == 0 || removed == topology.face_count()) return shape;
  warnings.push_back(
      fmt::format("{} face(s) without an area (the first is {}) are left out", removed, where));
  return context->Apply(shape);
}

}  // namespace flowcage::occ
