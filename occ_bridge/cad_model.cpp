#include "occ_bridge/cad_model.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>

#include "occ_bridge/internal/build_model.hpp"
#include "occ_bridge/internal/cad_data.hpp"
#include "occ_bridge/internal/isolate.hpp"
#include "occ_bridge/internal/read_files.hpp"
#include "occ_bridge/internal/shape_rep.hpp"
#include "occ_bridge/internal/sniff.hpp"
#include "occ_bridge/internal/unite.hpp"

namespace flowcage {

namespace {

/// The tessellation's vertices lie on the faces, but the faces bulge beyond them between the vertices. In
/// each of the six directions d the outermost vertex x climbs to the surface's own extreme place: the point
/// nearest to x + t d maximises d.x' - |x' - x|^2 / (2 t) (proximal point method), so d.x never falls.
Box3 bounds_of_surface(const TargetSurface& surface, Box3 bounds) {
  const std::vector<Vec3>& vertices = surface.tessellation().points;
  const double step = 4 * bounds.diagonal().norm();
  if (!(step > 0) || !std::isfinite(step)) return bounds;
  std::array<Vec3, 6> directions, places;
  for (int k = 0; k < 6; ++k) {
    const Vec3 direction = (k % 2 == 0 ? 1.0 : -1.0) * Vec3::Unit(k / 2);
    directions[k] = direction;
    places[k] = *std::max_element(vertices.begin(), vertices.end(), [&](const Vec3& a, const Vec3& b) {
      return direction.dot(a) < direction.dot(b);
    });
  }
  for (int round = 0; round < 12; ++round) {
    std::array<Vec3, 6> queries;
    std::array<SurfacePoint, 6> feet;
    for (int k = 0; k < 6; ++k) queries[k] = places[k] + step * directions[k];
    surface.closest_points(queries, {}, feet);
    double gain = 0;
    for (int k = 0; k < 6; ++k) {
      if (feet[k].status == FootStatus::failed) continue;
      gain = std::max(gain, directions[k].dot(feet[k].position - places[k]));
      places[k] = feet[k].position;
      bounds.extend(places[k]);
    }
    if (!(gain > 1e-12 * step)) break;
  }
  return bounds;
}

CadModel finished(occ::PreparedModel prepared, const CadReadSettings& settings, Progress& progress) {
  if (settings.unite) prepared = occ::united(std::move(prepared), settings, progress);
  auto data = occ::build_model(std::move(prepared), settings, progress);
  progress.step("prepare nearest points", 0.0);
  data->projector.emplace(data->faces);
  const std::vector<std::string>& notes = data->projector->notes();
  data->summary.warnings.insert(data->summary.warnings.end(), notes.begin(), notes.end());
  for (const std::string& warning : data->summary.warnings) progress.warn(warning);
  const Box3 bounds = bounds_of_surface(CadModel(data), data->bounds);
  data->bounds = bounds;
  data->summary.bounds = bounds;
  data->summary.diagonal = bounds.diagonal().norm();
  progress.step("tell open borders apart", 0.0);
  data->summary.borders = find_open_borders(CadModel(data));
  return CadModel(std::move(data));
}

}  // namespace

void CadModel::closest_points(std::span<const Vec3> queries, std::span<const SurfacePoint> hints,
                              std::span<SurfacePoint> results) const {
  data_->projector->closest_points(queries, hints, results);
}

void CadModel::closest_compatible(std::span<const Vec3> queries, std::span<const Vec3> normals,
                                  double min_cosine, double max_distance,
                                  std::span<SurfacePoint> results) const {
  data_->projector->closest_compatible(queries, normals, min_cosine, max_distance, results);
}

void CadModel::intersect_lines(std::span<const Vec3> queries, std::span<const Vec3> directions,
                               double min_cosine, double max_distance,
                               std::span<SurfacePoint> results) const {
  data_->projector->intersect_lines(queries, directions, min_cosine, max_distance, results);
}

const FeatureGraph& CadModel::features() const {
  return data_->features;
}

CurvePoint CadModel::chain_point(Index chain, double s) const {
  const occ::ChainCurve& curve = data_->curves[chain];
  const FeatureChain& known = data_->features.chains[chain];
  if (known.start == no_index && known.length > 0) {  // a closed loop without corner
    s = std::fmod(s, known.length);
    if (s < 0) s += known.length;
  }
  return curve.point(s);
}

CurvePoint CadModel::closest_on_chain(Index chain, const Vec3& query) const {
  return data_->curves[chain].closest(query);
}

const Tessellation& CadModel::tessellation() const {
  return data_->tessellation;
}

Index CadModel::face_count() const {
  return static_cast<Index>(data_->faces.size());
}

std::string CadModel::face_name(Index face) const {
  return data_->labels[face].group;
}

const CadFace& CadModel::face(Index face) const {
  return data_->labels[face];
}

Box3 CadModel::bounds() const {
  return data_->bounds;
}

const CadSummary& CadModel::summary() const {
  return data_->summary;
}

CadModel read_cad(std::span<const std::string> files, const CadReadSettings& settings, Progress& progress) {
  if (files.empty()) throw Error(ErrorKind::usage, "no CAD file", "name at least one STEP or IGES file");
  std::string all;
  double megabytes = 0;
  for (const std::string& file : files) {
    occ::sniff_cad_file(file);  // clear errors at once, before a process is started
    megabytes += 1e-6 * static_cast<double>(std::filesystem::file_size(file));
    if (!all.empty()) all += ", ";
    all += file;
  }
  const auto work = [&] {
    Progress nobody;
    occ::FaceLabels labels;
    std::vector<occ::FileContent> contents;
    for (const std::string& file : files) {
      contents.push_back(occ::read_cad_file(file, settings.cad_unit, labels, nobody));
    }
    occ::PreparedModel prepared = occ::prepare_model(contents, labels, settings, nobody);
    std::string bytes = occ::bytes_of(prepared);
    occ::build_model(std::move(prepared), settings, nobody);  // whether it survives this, too
    return bytes;
  };
  const std::string bytes = occ::run_isolated(
      work,
      {.file = all,
       .stage = fmt::format("read {}", all),
       .limit_seconds = settings.time_limit_seconds + megabytes * settings.time_limit_per_megabyte},
      progress);
  return finished(occ::prepared_from(bytes), settings, progress);
}

CadModel cad_model_of(const Shape& shape, const CadReadSettings& settings, Progress& progress) {
  occ::FaceLabels labels;
  const occ::FileContent content = occ::content_of(shape.rep().shape, labels);
  return finished(occ::prepare_model({content}, labels, settings, progress), settings, progress);
}

}  // namespace flowcage
