#include "occ_bridge/internal/prepared_model.hpp"

#include <fmt/format.h>
#include <BRepBndLib.hxx>
#include <BRepLib.hxx>
#include <BRep_Builder.hxx>
#include <Bnd_Box.hxx>
#include <TopExp.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS_Compound.hxx>
#include <cmath>
#include <numbers>

#include "occ_bridge/internal/face_edges.hpp"
#include "occ_bridge/internal/heal.hpp"
#include "occ_bridge/internal/kernel_scope.hpp"
#include "occ_bridge/internal/scaled.hpp"
#include "occ_bridge/internal/select_faces.hpp"
#include "occ_bridge/internal/split_kinks.hpp"
#include "occ_bridge/internal/tessellate.hpp"

namespace flowcage::occ {

namespace {

constexpr double radians = std::numbers::pi / 180;

/// The kernel's tolerances are absolute (1e-7) and meant for millimetres: models are worked on at a size that
/// suits them, and become metres at the end.
constexpr double smallest_diagonal = 1, largest_diagonal = 1e6;

double rough_diagonal(const TopoDS_Shape& shape) {
  Bnd_Box box;
  BRepBndLib::Add(shape, box, Standard_False);
  if (box.IsVoid() || box.IsOpen()) return 0;
  return std::sqrt(box.SquareExtent());
}

TopoDS_Shape scaled_with_labels(const TopoDS_Shape& shape, double factor, FaceLabels& labels) {
  const TopoDS_Shape result = scaled(shape, factor);
  TopTools_IndexedMapOfShape before, after;
  TopExp::MapShapes(shape, TopAbs_FACE, before);
  TopExp::MapShapes(result, TopAbs_FACE, after);
  for (int i = 1; i <= std::min(before.Extent(), after.Extent()); ++i) labels.inherit(before(i), after(i));
  return result;
}

struct Working {
  TopoDS_Shape shape{};
  double metres = 1;  ///< per length unit of `shape`
};

/// All files in one length unit that suits the kernel.
Working common_unit(const std::vector<FileContent>& contents, FaceLabels& labels) {
  Working working{.metres = contents.front().shape_unit};
  TopoDS_Compound all;
  BRep_Builder builder;
  builder.MakeCompound(all);
  for (const FileContent& content : contents) {
    builder.Add(all, scaled_with_labels(content.shape, content.shape_unit / working.metres, labels));
  }
  working.shape = all;
  const double diagonal = rough_diagonal(working.shape);
  if (diagonal > 0 && (diagonal < smallest_diagonal || diagonal > largest_diagonal)) {
    const double factor = std::pow(10.0, 2 - std::round(std::log10(diagonal)));
    working.shape = scaled_with_labels(working.shape, factor, labels);
    working.metres /= factor;
  }
  return working;
}

Index count(const TopoDS_Shape& shape, TopAbs_ShapeEnum kind) {
  TopTools_IndexedMapOfShape map;
  TopExp::MapShapes(shape, kind, map);
  return map.Extent();
}

}  // namespace

PreparedModel prepare_model(std::vector<FileContent> contents, FaceLabels& labels,
                            const CadReadSettings& settings, Progress& progress) {
  const KernelScope scope;
  PreparedModel model;
  CadSummary& summary = model.summary;
  for (const FileContent& content : contents) {
    summary.files.push_back({content.file, content.format, content.unit, content.unit_in_metres,
                             count(content.shape, TopAbs_SOLID), count(content.shape, TopAbs_FACE),
                             content.shape_unit * rough_diagonal(content.shape)});
    summary.solid_names.insert(summary.solid_names.end(), content.solid_names.begin(),
                               content.solid_names.end());
    const std::string prefix = contents.size() > 1 ? content.file + ": " : "";
    for (const std::string& warning : content.warnings) summary.warnings.push_back(prefix + warning);
  }
  summary.unit = settings.cad_unit.empty() ? contents.front().unit : settings.cad_unit;

  summary.faces_left_out = select_faces(contents, labels, {settings.include, settings.exclude});

  Working working = common_unit(contents, labels);
  const double rough = rough_diagonal(working.shape);
  if (!(rough > 0) || !std::isfinite(rough)) {
    throw input_error(contents.front().file, 0, "its shapes have no finite size",
                      "export the file again from the CAD system");
  }
  failure_of([&] { BRepLib::BuildCurves3d(working.shape); });
  // Sew before splitting: halves of edges are harder to match. Splitting can bare strips without an area.
  constexpr double sliver = 1e-7;       // relative to the diagonal: below the finest sewing tolerance
  constexpr double kink = 1 * radians;  // far below any crease angle: Newton's method wants smooth faces
  const SewSettings sewing{settings.sewing_tolerances, rough};
  working.shape = without_slivers(working.shape, sliver * rough, labels, summary.warnings);
  SewnShape sewn = sew_open_parts(working.shape, sewing, labels, summary.warnings, progress);
  summary.free_edges_before = sewn.free_edges_before;
  summary.free_edges_sewn = sewn.free_edges;
  summary.sewing_tolerance = sewn.tolerance * working.metres;
  progress.step("split faces at kinks", 0.0);
  sewn.shape = split_kinks(sewn.shape, kink, labels, summary.warnings);
  const TopoDS_Shape bared = without_slivers(sewn.shape, sliver * rough, labels, summary.warnings);
  if (!bared.IsSame(sewn.shape)) {
    sewn = sew_open_parts(bared, sewing, labels, summary.warnings, progress);
    summary.free_edges_sewn = sewn.free_edges;
    summary.sewing_tolerance = std::max(summary.sewing_tolerance, sewn.tolerance * working.metres);
  }

  triangulate_faces(sewn.shape,
                    {.deflection = settings.deflection * rough,
                     .scale = working.metres,
                     .angle_degrees = settings.tessellation_angle_degrees},
                    labels, summary, progress);
  model.shape = orient_outward(sewn.shape);
  model.metres = working.metres;
  model.deflection = settings.deflection * rough;
  const FaceEdges topology = face_edges_of(model.shape);
  for (Index f = 0; f < topology.face_count(); ++f) model.labels.push_back(labels.of(topology.face(f)));
  choose_groups(model.labels);
  name_faces(model.labels, settings.named);
  return model;
}

}  // namespace flowcage::occ
