#include "cli/report/scene.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "cli/json_report.hpp"
#include "core/mesh/thinned_blocks.hpp"
#include "core/mesh/visit_cells.hpp"
#include "core/quality/jacobian.hpp"

namespace flowcage {
namespace {

/// Points that share a cell of a grid become one; triangles that vanish by that are left out.
SceneSurface clustered(const SceneSurface& fine, const Box3& box, double edge) {
  SceneSurface coarse{.names = fine.names};
  std::map<std::array<Offset, 3>, Index> seen;
  std::vector<Index> number;
  for (const Vec3& p : fine.points) {
    std::array<Offset, 3> cell{};
    for (int a = 0; a < 3; ++a) cell[a] = static_cast<Offset>(std::floor((p[a] - box.min()[a]) / edge));
    const auto [at, fresh] = seen.emplace(cell, static_cast<Index>(coarse.points.size()));
    if (fresh) coarse.points.push_back(p);
    number.push_back(at->second);
  }
  for (std::size_t f = 0; f < fine.faces.size(); ++f) {
    std::array<Index, 4> face{};
    for (int c = 0; c < 4; ++c) face[c] = number[fine.faces[f][c]];
    if (face[0] == face[1] || face[1] == face[2] || face[2] == face[0]) continue;
    coarse.faces.push_back(face);
    coarse.name.push_back(fine.name[f]);
    coarse.region.push_back(fine.region[f]);
  }
  return coarse;
}

void keep_used_points(SceneSurface& surface) {
  std::vector<Index> number(surface.points.size(), no_index);
  std::vector<Vec3> points;
  std::vector<float> deviation;
  for (auto& face : surface.faces) {
    for (Index& p : face) {
      if (number[p] == no_index) {
        number[p] = static_cast<Index>(points.size());
        points.push_back(surface.points[p]);
        if (!surface.deviation.empty()) deviation.push_back(surface.deviation[p]);
      }
      p = number[p];
    }
  }
  surface.points = std::move(points);
  surface.deviation = std::move(deviation);
}

SceneSurface cad_surface(const TargetSurface& cad) {
  SceneSurface surface;
  const Tessellation& tessellation = cad.tessellation();
  std::map<std::string, Index> known;
  std::vector<Index> name_of_face;
  for (Index f = 0; f < cad.face_count(); ++f) {
    const std::string name = cad.face_name(f);
    const auto [at, fresh] = known.emplace(name, static_cast<Index>(surface.names.size()));
    if (fresh) surface.names.push_back({name, "CAD", palette_color(surface.names.size())});
    name_of_face.push_back(at->second);
  }
  surface.points = tessellation.points;
  surface.region = tessellation.triangle_face;
  for (std::size_t t = 0; t < tessellation.triangles.size(); ++t) {
    const auto& [a, b, c] = tessellation.triangles[t];
    surface.faces.push_back({a, b, c, c});
    surface.name.push_back(name_of_face[tessellation.triangle_face[t]]);
  }
  return surface;
}

/// A patch of the mesh has the colour of the CAD's faces of that name.
Rgb color_of(const std::string& name, const Scene& scene) {
  const auto cad = std::ranges::find(scene.cad.names, name, &SceneName::name);
  return cad != scene.cad.names.end() ? cad->color
                                      : palette_color(scene.cad.names.size() + scene.mesh.names.size());
}

std::vector<float> in_diagonals(std::span<const double> metres, double diagonal) {
  std::vector<float> values;
  for (const double d : metres) values.push_back(static_cast<float>(d / diagonal));
  return values;
}

/// Four bins a decade.
void count_deviation(Histogram& histogram, double diagonals) {
  if (histogram.counts.empty()) histogram = {-9, -1, std::vector<Offset>(32)};
  const double bin = diagonals > 0 ? std::floor(4 * (std::log10(diagonals) - histogram.low)) : 0;
  ++histogram.counts[static_cast<std::size_t>(std::clamp(bin, 0.0, 31.0))];
}

void count_wall_deviations(Scene& scene, const VolumeResult& result) {
  std::vector<bool> counted(result.deviation.size(), false);
  for (const BoundaryPatch& patch : result.mesh.patches()) {
    if (patch.type == PatchType::farfield || patch.type == PatchType::symmetry) continue;
    for (const auto& quad : patch.quads) {
      for (const Index p : quad) {
        if (!counted[p]) count_deviation(scene.deviation, result.deviation[p] / scene.diagonal);
        counted[p] = true;
      }
    }
  }
}

void add_polygon(SceneSurface& surface, std::span<const Index> corners, Index name) {
  if (corners.size() == 4) {
    surface.faces.push_back({corners[0], corners[1], corners[2], corners[3]});
    surface.name.push_back(name);
    return;
  }
  for (std::size_t c = 2; c < corners.size(); ++c) {
    surface.faces.push_back({corners[0], corners[c - 1], corners[c], corners[c]});
    surface.name.push_back(name);
  }
}

void add_boundary(Scene& scene, const BlockMesh& mesh, std::span<const float> quality) {
  SceneSurface& surface = scene.mesh;
  surface.points.assign(mesh.points().begin(), mesh.points().end());
  for (std::size_t p = 0; p < mesh.patches().size(); ++p) {
    const BoundaryPatch& patch = mesh.patches()[p];
    surface.names.push_back({patch.name, patch_type_name(patch.type), color_of(patch.name, scene)});
    for (std::size_t q = 0; q < patch.quads.size(); ++q) {
      const auto& quad = patch.quads[q];  // seen from outside of the fluid
      surface.faces.push_back({quad[3], quad[2], quad[1], quad[0]});
      surface.name.push_back(static_cast<Index>(p));
      surface.block.push_back(mesh.block_of(patch.owner[q]));
      surface.quality.push_back(quality[patch.owner[q]]);
    }
  }
}

void add_cells(Scene& scene, const BlockMesh& mesh, std::vector<float> quality) {
  SceneVolume& volume = scene.volume;
  volume.points.assign(mesh.points().begin(), mesh.points().end());
  volume.quality = std::move(quality);
  for (Index b = 0; b < mesh.block_count(); ++b) {
    const auto dims = mesh.dims(b);
    volume.dims.push_back(dims);
    for (Index k = 0; k <= dims[2]; ++k) {
      for (Index j = 0; j <= dims[1]; ++j) {
        for (Index i = 0; i <= dims[0]; ++i) volume.numbers.push_back(mesh.point_number(b, i, j, k));
      }
    }
  }
}

void add_worst(Scene& scene, const BlockMesh& mesh, const char* metric, const MetricSummary& summary) {
  for (const WorstCell& worst : summary.worst) {
    HexPoints cell{};
    mesh.read_cells(worst.cell, {&cell, 1});
    scene.worst.push_back({metric, corners_of(mesh, cell)});
  }
}

Offset boundary_faces(const BlockMesh& mesh) {
  Offset count = 0;
  for (const BoundaryPatch& patch : mesh.patches()) count += static_cast<Offset>(patch.quads.size());
  return count;
}

/// Colours show less than the tables say.
constexpr const char* deviation_note =
    "deviation: colours and histogram are of the mesh's points; the largest one is searched for between "
    "them, too";

}  // namespace

Scene cad_scene(const TargetSurface& cad, const SceneLimits& limits) {
  Scene scene{.diagonal = cad.diagonal(), .body = cad.bounds(), .cad = cad_surface(cad)};
  const std::size_t triangles = scene.cad.faces.size();
  double edge = 1e-3 * scene.diagonal;
  while (scene.cad.faces.size() > static_cast<std::size_t>(limits.triangles)) {
    scene.cad = clustered(scene.cad, scene.body, edge);
    edge *= 1.5;
  }
  scene.shown.push_back(scene.cad.faces.size() == triangles
                            ? fmt::format("CAD: all {} triangles of its tessellation", triangles)
                            : fmt::format("CAD: {} triangles, clustered from {}: details are lost",
                                          scene.cad.faces.size(), triangles));
  for (const FeatureChain& chain : cad.features().chains) scene.edges.push_back(chain.polyline);
  return scene;
}

Scene surface_scene(const TargetSurface& cad, const SurfaceResult& result, double tolerance,
                    const SceneLimits& limits) {
  Scene scene = cad_scene(cad, limits);
  scene.tolerance = tolerance;
  SceneSurface& surface = scene.mesh;
  for (const std::string& name : result.mesh.patch_names) {
    surface.names.push_back({name, "wall", color_of(name, scene)});
  }
  // A level's vertices are the first ones of the next: a coarser level is a part of the same points.
  const Csr<Index>* faces = &result.mesh.faces;
  const std::vector<Index>* patch = &result.mesh.face_patch;
  for (auto level = result.fit.levels.rbegin(); level != result.fit.levels.rend(); ++level) {
    if (faces->size() <= limits.faces) break;
    faces = &level->topology.face_vertices;
    patch = &level->topology.face_patch;
  }
  for (Index f = 0; f < faces->size(); ++f) add_polygon(surface, (*faces)[f], (*patch)[f]);
  surface.points = result.mesh.points;
  surface.deviation = in_diagonals(result.deviation, scene.diagonal);
  for (const float d : surface.deviation) count_deviation(scene.deviation, d);
  keep_used_points(surface);
  scene.shown.emplace_back(deviation_note);
  scene.shown.push_back(faces->size() == result.mesh.faces.size()
                            ? fmt::format("fitted surface: all {} faces", faces->size())
                            : fmt::format("fitted surface: {} faces of a coarser level; the result has {}",
                                          faces->size(), result.mesh.faces.size()));
  return scene;
}

Scene volume_scene(const TargetSurface& cad, const VolumeResult& result, double tolerance,
                   const SceneLimits& limits) {
  Scene scene = cad_scene(cad, limits);
  scene.tolerance = tolerance;
  const BlockMesh& mesh = result.mesh;
  const std::vector<float> quality = scaled_jacobians(mesh);
  const ThinnedBlocks thinned = thin_blocks(mesh, limits.cells);
  std::vector<float> least = least_of_covered(mesh, thinned, quality);
  const Offset faces = boundary_faces(mesh);
  if (faces <= limits.faces) {
    add_boundary(scene, mesh, quality);
    scene.mesh.deviation = in_diagonals(result.deviation, scene.diagonal);
    scene.shown.push_back(fmt::format("boundary of the mesh: all {} faces", faces));
  } else {
    add_boundary(scene, thinned.mesh, least);
    std::vector<double> deviation;
    for (const Index p : thinned.point) deviation.push_back(result.deviation[p]);
    scene.mesh.deviation = in_diagonals(deviation, scene.diagonal);
    scene.shown.push_back(fmt::format("boundary of the mesh: {} faces for {}, each for up to {} x {}",
                                      scene.mesh.faces.size(), faces, thinned.stride, thinned.stride));
  }
  keep_used_points(scene.mesh);
  count_wall_deviations(scene, result);
  add_cells(scene, thinned.mesh, std::move(least));
  scene.volume.stride = thinned.stride;
  scene.shown.push_back(
      thinned.stride == 1
          ? fmt::format("cutting plane: all {} cells", mesh.cell_count())
          : fmt::format("cutting plane: {} cells for {}, each for up to {} x {} x {} and with the least "
                        "scaled Jacobian among them",
                        thinned.mesh.cell_count(), mesh.cell_count(), thinned.stride, thinned.stride,
                        thinned.stride));
  scene.shown.emplace_back(deviation_note);
  add_worst(scene, mesh, "scaled_jacobian", result.quality.scaled_jacobian);
  add_worst(scene, mesh, "non_orthogonality", result.quality.non_orthogonality);
  add_worst(scene, mesh, "skewness", result.quality.skewness);
  add_worst(scene, mesh, "aspect_ratio", result.quality.aspect_ratio);
  return scene;
}

}  // namespace flowcage
