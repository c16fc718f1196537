#include "occ_bridge/internal/build_model.hpp"

#include <fmt/format.h>
#include <BRepAdaptor_Surface.hxx>
#include <GeomAbs_SurfaceType.hxx>
#include <TopExp.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <algorithm>
#include <numbers>

#include "core/mesh/opening_names.hpp"
#include "occ_bridge/internal/cad_data.hpp"
#include "occ_bridge/internal/face_edges.hpp"
#include "occ_bridge/internal/feature_edges.hpp"
#include "occ_bridge/internal/feature_graph.hpp"
#include "occ_bridge/internal/scaled.hpp"
#include "occ_bridge/internal/tessellate.hpp"
#include "occ_bridge/internal/tips.hpp"

namespace flowcage::occ {

namespace {

constexpr double radians = std::numbers::pi / 180;

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

void count_values(const std::vector<CadFace>& faces, std::string CadFace::*field,
                  std::vector<NamedCount>& counts) {
  for (const CadFace& face : faces) {
    if ((face.*field).empty()) continue;
    auto found = std::ranges::find(counts, face.*field, &NamedCount::name);
    if (found == counts.end()) found = counts.insert(counts.end(), {face.*field, 0});
    ++found->count;
  }
}

/// Kinds and bounds of the faces, and what is said of how many.
void describe_faces(const FaceEdges& topology, CadModel::Data& data) {
  for (Index f = 0; f < topology.face_count(); ++f) data.labels[f].kind = kind_of(topology.face(f));
  const Tessellation& mesh = data.tessellation;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (const Index p : mesh.triangles[t]) data.labels[mesh.triangle_face[t]].bounds.extend(mesh.points[p]);
  }
  count_values(data.labels, &CadFace::group, data.summary.groups);
  count_values(data.labels, &CadFace::part, data.summary.parts);
  count_values(data.labels, &CadFace::layer, data.summary.layers);
  count_values(data.labels, &CadFace::color, data.summary.colors);
}

/// No file tells whether its unit is right; sizes that are rare for bodies in a flow are worth a look.
void warn_of_odd_size(CadSummary& summary) {
  constexpr double small = 1e-3, large = 1e3, small_for_part_units = 0.25, far_apart = 100;
  if (summary.diagonal < small || summary.diagonal > large) {
    summary.warnings.push_back(
        fmt::format("odd size: the diagonal is {:.4g} m with the unit '{}'; --cad-unit "
                    "overrules the unit where the file states a wrong one",
                    summary.diagonal, summary.unit));
    return;
  }
  for (const CadFile& file : summary.files) {
    // Millimetres are what many systems declare when nobody chose; that turns a blade of 117 m into 117 mm.
    if (file.unit_in_metres > 0 && file.unit_in_metres < 0.1 && file.diagonal < small_for_part_units) {
      summary.warnings.push_back(fmt::format(
          "check the unit of {}: in '{}' as declared its diagonal is {:.4g} m; where its numbers are "
          "metres, {:.4g} m, say --cad-unit m",
          file.name, file.unit, file.diagonal, file.diagonal / file.unit_in_metres));
    }
  }
  const auto [least, most] = std::ranges::minmax_element(summary.files, {}, &CadFile::diagonal);
  if (most->diagonal > far_apart * least->diagonal) {
    summary.warnings.push_back(fmt::format(
        "odd sizes: {} has a diagonal of {:.4g} m, {} of {:.4g} m; does one of them state a wrong unit?",
        least->name, least->diagonal, most->name, most->diagonal));
  }
}

}  // namespace

std::shared_ptr<CadModel::Data> build_model(PreparedModel prepared, const CadReadSettings& settings,
                                            Progress& progress) {
  auto data = std::make_shared<CadModel::Data>();
  data->summary = std::move(prepared.summary);
  CadSummary& summary = data->summary;
  const TopoDS_Shape& shape = prepared.shape;
  const FaceEdges topology = face_edges_of(shape);
  summary.free_edges = topology.free_edge_count();
  count_topology(shape, topology, summary);

  data->tessellation = collect_triangles(topology, prepared.metres);
  if (data->tessellation.triangles.empty()) {
    throw input_error(summary.files.front().name, 0, "none of its faces can be triangulated",
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
  std::vector<std::string> openings;
  for (const CadFace& face : prepared.labels) {
    openings.push_back(patch_type_of_name(face.group) == PatchType::wall ? "" : face.group);
  }
  const FeatureEdges edges =
      find_feature_edges(topology, settings.crease_angle_degrees * radians, openings, summary.warnings);
  summary.sharp_edges = edges.sharp_edges;
  summary.partly_sharp_edges = edges.partly_sharp_edges;
  summary.crowded_edges = edges.crowded_edges;
  if (edges.crowded_edges > 0) {
    summary.warnings.push_back(fmt::format("{} edge(s) bound more than two faces", edges.crowded_edges));
  }
  ChainSet chains = join_feature_runs(topology, edges.runs,
                                      {.corner_angle = settings.corner_angle_degrees * radians,
                                       .scale = prepared.metres,
                                       .deviation = 1e-4 * summary.diagonal});
  data->features = std::move(chains.graph);
  data->curves = std::move(chains.curves);
  summary.corners = static_cast<Index>(data->features.corners.size());
  for (const FeatureChain& chain : data->features.chains) {
    ++(chain.kind == ChainKind::sharp ? summary.sharp_chains : summary.boundary_chains);
    const auto body = [&](Index face) { return prepared.bodies[face]; };
    const bool meeting = !prepared.bodies.empty() && std::ranges::any_of(chain.faces, [&](Index face) {
      return body(face) != body(chain.faces.front());
    });
    summary.intersection_chains += meeting ? 1 : 0;
  }

  data->labels = std::move(prepared.labels);
  describe_faces(topology, *data);

  TopTools_IndexedMapOfShape faces;
  TopExp::MapShapes(scaled(shape, prepared.metres), TopAbs_FACE, faces);
  for (int i = 1; i <= faces.Extent(); ++i) data->faces.push_back(TopoDS::Face(faces(i)));
  if (static_cast<Index>(data->faces.size()) != topology.face_count()) {
    throw Error(ErrorKind::internal, "scaling the model to metres changed its number of faces",
                "please report this file");
  }
  data->features.tips = find_tips(data->faces, data->features, settings.crease_angle_degrees * radians,
                                  1e-6 * summary.diagonal);
  summary.tips = static_cast<Index>(data->features.tips.size());
  return data;
}

}  // namespace flowcage::occ
