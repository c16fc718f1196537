#include "occ_bridge/internal/build_model.hpp"

#include <fmt/format.h>
#include <BRepAdaptor_Surface.hxx>
#include <BRepBndLib.hxx>
#include <BRepBuilderAPI_Transform.hxx>
#include <BRepLib.hxx>
#include <BRep_Builder.hxx>
#include <Bnd_Box.hxx>
#include <GeomAbs_SurfaceType.hxx>
#include <TopExp.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Compound.hxx>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <set>

#include "occ_bridge/internal/cad_data.hpp"
#include "occ_bridge/internal/face_edges.hpp"
#include "occ_bridge/internal/feature_edges.hpp"
#include "occ_bridge/internal/feature_graph.hpp"
#include "occ_bridge/internal/heal.hpp"
#include "occ_bridge/internal/kernel_scope.hpp"
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

TopoDS_Shape scaled(const TopoDS_Shape& shape, double factor, FaceNames* names) {
  if (factor == 1) return shape;
  gp_Trsf trsf;
  trsf.SetScale(gp_Pnt(0, 0, 0), factor);
  const TopoDS_Shape result = BRepBuilderAPI_Transform(shape, trsf, Standard_True).Shape();
  if (names != nullptr) {
    TopTools_IndexedMapOfShape before, after;
    TopExp::MapShapes(shape, TopAbs_FACE, before);
    TopExp::MapShapes(result, TopAbs_FACE, after);
    for (int i = 1; i <= std::min(before.Extent(), after.Extent()); ++i) names->inherit(before(i), after(i));
  }
  return result;
}

struct Working {
  TopoDS_Shape shape{};
  double metres = 1;  ///< per length unit of `shape`
};

/// All files in one length unit that suits the kernel.
Working common_unit(const std::vector<FileContent>& contents, FaceNames& names) {
  Working working{.metres = contents.front().shape_unit};
  TopoDS_Compound all;
  BRep_Builder builder;
  builder.MakeCompound(all);
  for (const FileContent& content : contents) {
    builder.Add(all, scaled(content.shape, content.shape_unit / working.metres, &names));
  }
  working.shape = all;
  const double diagonal = rough_diagonal(working.shape);
  if (diagonal > 0 && (diagonal < smallest_diagonal || diagonal > largest_diagonal)) {
    const double factor = std::pow(10.0, 2 - std::round(std::log10(diagonal)));
    working.shape = scaled(working.shape, factor, &names);
    working.metres /= factor;
  }
  return working;
}

const char* kind_of(const TopoDS_Face& face) {
  switch (BRepAdaptor_Surface(face, Standard_False).GetType()) {
    case GeomAbs_Plane:
      return "plane";
    case GeomAbs_Cylinder:
      return "cylinder";
    case GeomAbs_Cone:
      return "cone";
    case GeomAbs_Sphere:
      return "sphere";
    case GeomAbs_Torus:
      return "torus";
    case GeomAbs_BezierSurface:
      return "Bezier";
    case GeomAbs_BSplineSurface:
      return "B-spline";
    case GeomAbs_SurfaceOfRevolution:
      return "revolution";
    case GeomAbs_SurfaceOfExtrusion:
      return "extrusion";
    case GeomAbs_OffsetSurface:
      return "offset";
    default:
      return "other";
  }
}

std::vector<NamedCount> count_kinds(const FaceEdges& topology) {
  std::vector<NamedCount> counts;
  for (Index f = 0; f < topology.face_count(); ++f) {
    const std::string kind = kind_of(topology.face(f));
    auto found = std::ranges::find(counts, kind, &NamedCount::name);
    if (found == counts.end()) found = counts.insert(counts.end(), {kind, 0});
    ++found->count;
  }
  std::ranges::stable_sort(counts, std::ranges::greater{}, &NamedCount::count);
  return counts;
}

Index count(const TopoDS_Shape& shape, TopAbs_ShapeEnum kind) {
  TopTools_IndexedMapOfShape map;
  TopExp::MapShapes(shape, kind, map);
  return map.Extent();
}

void count_topology(const TopoDS_Shape& shape, const FaceEdges& topology, CadSummary& summary) {
  summary.solids = count(shape, TopAbs_SOLID);
  summary.faces = topology.face_count();
  summary.vertices = count(shape, TopAbs_VERTEX);
  for (Index e = 0; e < topology.edge_count(); ++e) summary.edges += topology.degenerated(e) ? 0 : 1;
  TopTools_IndexedMapOfShape shells;
  TopExp::MapShapes(shape, TopAbs_SHELL, shells);
  summary.shells = shells.Extent();
  for (int i = 1; i <= shells.Extent(); ++i) {
    summary.open_shells += face_edges_of(shells(i)).free_edge_count() > 0 ? 1 : 0;
  }
  summary.faces_by_kind = count_kinds(topology);
}

void warn_of_odd_size(CadSummary& summary) {
  constexpr double small = 1e-3, large = 1e3;
  if (summary.diagonal < small || summary.diagonal > large) {
    summary.warnings.push_back(
        fmt::format("odd size: the diagonal is {:.4g} m with the unit '{}'; --cad-unit "
                    "overrules the unit where the file states a wrong one",
                    summary.diagonal, summary.unit));
  }
}

}  // namespace

std::shared_ptr<const CadModel::Data> build_model(const std::vector<FileContent>& contents, FaceNames& names,
                                                  const CadReadSettings& settings, Progress& progress) {
  const KernelScope scope;
  auto data = std::make_shared<CadModel::Data>();
  CadSummary& summary = data->summary;
  for (const FileContent& content : contents) {
    summary.files.push_back({content.file, content.format, content.unit, content.unit_in_metres,
                             count(content.shape, TopAbs_SOLID), count(content.shape, TopAbs_FACE)});
    summary.solid_names.insert(summary.solid_names.end(), content.solid_names.begin(),
                               content.solid_names.end());
    const std::string prefix = contents.size() > 1 ? content.file + ": " : "";
    for (const std::string& warning : content.warnings) summary.warnings.push_back(prefix + warning);
  }
  summary.unit = settings.cad_unit.empty() ? contents.front().unit : settings.cad_unit;

  Working working = common_unit(contents, names);
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
  working.shape = without_slivers(working.shape, sliver * rough, summary.warnings);
  SewnShape sewn = sew_open_parts(working.shape, sewing, names, summary.warnings, progress);
  summary.free_edges_before = sewn.free_edges_before;
  summary.sewing_tolerance = sewn.tolerance * working.metres;
  progress.step("split faces at kinks", 0.0);
  sewn.shape = split_kinks(sewn.shape, kink, names, summary.warnings);
  const TopoDS_Shape bared = without_slivers(sewn.shape, sliver * rough, summary.warnings);
  if (!bared.IsSame(sewn.shape)) {
    sewn = sew_open_parts(bared, sewing, names, summary.warnings, progress);
    summary.sewing_tolerance = std::max(summary.sewing_tolerance, sewn.tolerance * working.metres);
  }

  triangulate_faces(sewn.shape,
                    {.deflection = settings.deflection * rough,
                     .scale = working.metres,
                     .angle_degrees = settings.tessellation_angle_degrees},
                    summary.warnings, progress);
  const TopoDS_Shape shape = orient_outward(sewn.shape);
  const FaceEdges topology = face_edges_of(shape);
  summary.free_edges = topology.free_edge_count();
  count_topology(shape, topology, summary);

  data->tessellation = collect_triangles(topology, working.metres);
  if (data->tessellation.triangles.empty()) {
    throw input_error(contents.front().file, 0, "none of its faces can be triangulated",
                      "repair the model in the CAD system");
  }
  for (const auto& triangle : data->tessellation.triangles) {
    for (const Index p : triangle) data->bounds.extend(data->tessellation.points[p]);
  }
  summary.triangles = static_cast<Index>(data->tessellation.triangles.size());
  summary.bounds = data->bounds;
  summary.diagonal = data->bounds.diagonal().norm();
  warn_of_odd_size(summary);

  progress.step("find sharp edges", 0.0);
  const FeatureEdges edges =
      find_feature_edges(topology, settings.crease_angle_degrees * radians, summary.warnings);
  summary.sharp_edges = edges.sharp_edges;
  summary.partly_sharp_edges = edges.partly_sharp_edges;
  summary.crowded_edges = edges.crowded_edges;
  if (edges.crowded_edges > 0) {
    summary.warnings.push_back(fmt::format("{} edge(s) bound more than two faces", edges.crowded_edges));
  }
  ChainSet chains = join_feature_runs(topology, edges.runs,
                                      {.corner_angle = settings.corner_angle_degrees * radians,
                                       .scale = working.metres,
                                       .deviation = 1e-4 * summary.diagonal});
  data->features = std::move(chains.graph);
  data->curves = std::move(chains.curves);
  summary.corners = static_cast<Index>(data->features.corners.size());
  for (const FeatureChain& chain : data->features.chains) {
    ++(chain.kind == ChainKind::sharp ? summary.sharp_chains : summary.boundary_chains);
  }

  std::set<std::string> distinct;
  for (Index f = 0; f < topology.face_count(); ++f) {
    data->face_names.push_back(names.of(topology.face(f)));
    if (!data->face_names.back().empty()) distinct.insert(data->face_names.back());
  }
  summary.face_names.assign(distinct.begin(), distinct.end());

  TopTools_IndexedMapOfShape faces;
  TopExp::MapShapes(scaled(shape, working.metres, nullptr), TopAbs_FACE, faces);
  for (int i = 1; i <= faces.Extent(); ++i) data->faces.push_back(TopoDS::Face(faces(i)));
  if (static_cast<Index>(data->faces.size()) != topology.face_count()) {
    throw Error(ErrorKind::internal, "scaling the model to metres changed its number of faces",
                "please report this file");
  }
  for (const std::string& warning : summary.warnings) progress.warn(warning);
  return data;
}

}  // namespace flowcage::occ
