#include "core/quality/quality_report.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "core/base/parallel.hpp"
#include "core/quality/foam_metrics.hpp"

namespace flowcage {
namespace {

constexpr double very_small = 1e-300, small = 1e-15;
constexpr double no_number = 1e300;  // stands for a figure that is none

double degrees(double cosine) {
  return std::acos(std::clamp(cosine, -1.0, 1.0)) * 180 / std::numbers::pi;
}

struct MetricShape {
  double low, high;
  int bins;
  double worst;  // what stands for no number; its side of the range is the bad one
  bool least_is_worst;
};
constexpr MetricShape scaled_jacobian_shape{-1, 1, 20, -1, true};
constexpr MetricShape non_orthogonality_shape{0, 90, 18, 180, false};
constexpr MetricShape skewness_shape{0, 4, 16, no_number, false};
constexpr MetricShape aspect_ratio_shape{0, 1000, 20, no_number, false};

// A MetricSummary in the making; parts are joined in order.
class Gatherer {
 public:
  Gatherer() = default;
  Gatherer(const MetricShape& shape, int keep) : shape_(shape), keep_(static_cast<std::size_t>(keep)) {
    summary_.histogram = {shape.low, shape.high, std::vector<Offset>(static_cast<std::size_t>(shape.bins))};
  }

  void add(double value, Offset cell, Index block, const Vec3& where) {
    if (!std::isfinite(value)) value = shape_.worst;
    MetricSummary& s = summary_;
    s.min = s.count == 0 ? value : std::min(s.min, value);
    s.max = s.count == 0 ? value : std::max(s.max, value);
    ++s.count;
    sum_ += value;
    const double bin = (value - shape_.low) / (shape_.high - shape_.low) * shape_.bins;
    ++s.histogram.counts[static_cast<std::size_t>(std::clamp(bin, 0.0, shape_.bins - 1.0))];
    keep_if_bad({value, cell, block, where});
  }

  void join(const Gatherer& b) {
    if (b.summary_.count == 0) return;
    MetricSummary& s = summary_;
    s.min = s.count == 0 ? b.summary_.min : std::min(s.min, b.summary_.min);
    s.max = s.count == 0 ? b.summary_.max : std::max(s.max, b.summary_.max);
    s.count += b.summary_.count;
    sum_ += b.sum_;
    for (std::size_t i = 0; i < s.histogram.counts.size(); ++i) {
      s.histogram.counts[i] += b.summary_.histogram.counts[i];
    }
    for (const WorstCell& w : b.summary_.worst) keep_if_bad(w);
  }

  MetricSummary finish() {
    if (summary_.count > 0) summary_.mean = sum_ / static_cast<double>(summary_.count);
    return std::move(summary_);
  }

 private:
  bool worse(double a, double b) const { return shape_.least_is_worst ? a < b : a > b; }
  void keep_if_bad(const WorstCell& candidate) {
    auto& list = summary_.worst;
    if (list.size() == keep_ && (keep_ == 0 || !worse(candidate.value, list.back().value))) return;
    // Equal values keep the order in which they came, which is that of the cells.
    const auto at = std::find_if(list.begin(), list.end(),
                                 [&](const WorstCell& w) { return worse(candidate.value, w.value); });
    list.insert(at, candidate);
    if (list.size() > keep_) list.pop_back();
  }

  MetricShape shape_{};
  std::size_t keep_ = 0;
  MetricSummary summary_;
  double sum_ = 0;
};

struct Range {
  double min = no_number, max = -no_number;
  void add(double value) {
    min = std::min(min, value);
    max = std::max(max, value);
  }
  void join(const Range& b) {
    min = std::min(min, b.min);
    max = std::max(max, b.max);
  }
};

struct CellPart {
  Gatherer scaled_jacobian, aspect_ratio;
  Range volume;
  double total_volume = 0, max_openness = 0;
  Offset inverted = 0, open = 0, high_aspect = 0, not_positive = 0;
};

struct FacePart {
  Gatherer non_orthogonality, skewness;
  Range area;
  double sum_cosine = 0;
  Offset zero_area = 0, severe = 0, errors = 0, pyramids = 0, skew = 0;
};

class Measurement {
 public:
  Measurement(const HexView& mesh, const HexAdjacency& adjacency, const QualitySettings& settings)
      : mesh_(mesh), adjacency_(adjacency), keep_(settings.worst_count) {}

  void cells(QualityReport& report) {
    centres_.resize(static_cast<std::size_t>(mesh_.cell_count()));
    CellPart all = parallel_reduce(
        mesh_.cell_count(), cell_grain, new_cell_part(),
        [&](Offset begin, Offset end) {
          CellPart part = new_cell_part();
          visit_cells(mesh_, begin, end, [&](Offset c, const HexPoints& points) {
            add_cell(c, corners_of(mesh_, points), part);
          });
          return part;
        },
        [](CellPart a, const CellPart& b) {
          a.scaled_jacobian.join(b.scaled_jacobian);
          a.aspect_ratio.join(b.aspect_ratio);
          a.volume.join(b.volume);
          a.total_volume += b.total_volume;
          a.max_openness = std::max(a.max_openness, b.max_openness);
          a.inverted += b.inverted;
          a.open += b.open;
          a.high_aspect += b.high_aspect;
          a.not_positive += b.not_positive;
          return a;
        });
    report.scaled_jacobian = all.scaled_jacobian.finish();
    report.aspect_ratio = all.aspect_ratio.finish();
    report.min_volume = all.volume.min;
    report.max_volume = all.volume.max;
    report.total_volume = all.total_volume;
    report.max_openness = all.max_openness;
    report.inverted_cells = all.inverted;
    report.open_cells = all.open;
    report.high_aspect_cells = all.high_aspect;
    report.not_positive_volumes = all.not_positive;
  }

  void faces(QualityReport& report) {
    FacePart all = parallel_reduce(
        mesh_.cell_count(), cell_grain, new_face_part(),
        [&](Offset begin, Offset end) {
          FacePart part = new_face_part();
          visit_neighbours(mesh_, adjacency_, begin, end,
                           [&](Offset c, const HexPoints& points, const CellNeighbours& across) {
                             add_faces(c, points, across, part);
                           });
          return part;
        },
        [](FacePart a, const FacePart& b) {
          a.non_orthogonality.join(b.non_orthogonality);
          a.skewness.join(b.skewness);
          a.area.join(b.area);
          a.sum_cosine += b.sum_cosine;
          a.zero_area += b.zero_area;
          a.severe += b.severe;
          a.errors += b.errors;
          a.pyramids += b.pyramids;
          a.skew += b.skew;
          return a;
        });
    report.non_orthogonality = all.non_orthogonality.finish();
    if (report.non_orthogonality.count > 0) {
      // checkMesh's average is the angle of the mean cosine, not the mean angle.
      const double mean = all.sum_cosine / static_cast<double>(report.non_orthogonality.count);
      report.non_orthogonality.mean = std::isfinite(mean) ? degrees(mean) : non_orthogonality_shape.worst;
    }
    report.skewness = all.skewness.finish();
    report.min_face_area = all.area.min;
    report.max_face_area = all.area.max;
    report.zero_area_faces = all.zero_area;
    report.severely_non_orthogonal = all.severe;
    report.non_orthogonality_errors = all.errors;
    report.wrong_pyramids = all.pyramids;
    report.skew_faces = all.skew;
  }

 private:
  CellPart new_cell_part() const {
    CellPart part;
    part.scaled_jacobian = Gatherer(scaled_jacobian_shape, keep_);
    part.aspect_ratio = Gatherer(aspect_ratio_shape, keep_);
    return part;
  }
  FacePart new_face_part() const {
    FacePart part;
    part.non_orthogonality = Gatherer(non_orthogonality_shape, keep_);
    part.skewness = Gatherer(skewness_shape, keep_);
    return part;
  }

  void add_cell(Offset c, const HexCorners& corners, CellPart& part) {
    const CellGeometry cell = cell_geometry(corners);
    centres_[c] = cell.centre;
    const Index block = mesh_.block_of(c);
    const JacobianVerdict verdict = judge_jacobians(corners);
    part.scaled_jacobian.add(verdict.scaled_jacobian, c, block, cell.centre);
    const double aspect = cell_aspect_ratio(cell), openness = cell_openness(cell);
    part.aspect_ratio.add(aspect, c, block, cell.centre);
    part.max_openness = std::max(part.max_openness, openness);
    part.volume.add(std::isfinite(cell.volume) ? cell.volume : -no_number);
    part.total_volume += cell.volume;
    part.inverted += verdict.inverted;
    part.open += !(openness <= 1e-6);
    part.high_aspect += !(aspect <= 1000);
    part.not_positive += !(cell.volume >= very_small);
  }

  // The faces that cell c owns: inner ones toward a higher cell number, and those of the boundary.
  void add_faces(Offset c, const HexPoints& points, const CellNeighbours& neighbours, FacePart& part) const {
    const Index block = mesh_.block_of(c);
    const Vec3& own = centres_[c];
    for (int f = 0; f < 6; ++f) {
      const Index across = neighbours[f];
      if (across >= 0 && across < c) continue;
      std::array<Vec3, 4> quad;
      const auto corners = face_points(points, f);
      for (int i = 0; i < 4; ++i) quad[i] = mesh_.points()[corners[i]];
      const FaceGeometry face = face_geometry(quad);
      const double area = face.area.norm();
      part.area.add(std::isfinite(area) ? area : 0.0);
      part.zero_area += !(area >= very_small);
      part.pyramids += !(face.area.dot(face.centre - own) / 3 >= -small);
      double skewness = 0;
      if (across >= 0) {
        const Vec3& other = centres_[across];
        const double cosine = face_orthogonality(face.area, own, other);
        part.non_orthogonality.add(degrees(cosine), c, block, face.centre);
        part.sum_cosine += cosine;
        part.errors += !(cosine > small);
        part.severe += cosine > small && cosine < std::cos(70 * std::numbers::pi / 180);
        part.pyramids += !(face.area.dot(other - face.centre) / 3 >= -small);
        skewness = face_skewness(quad, face, {own, other});
      } else {
        skewness = boundary_face_skewness(quad, face, own);
      }
      part.skewness.add(skewness, c, block, face.centre);
      part.skew += !(skewness <= 4);
    }
  }

  const HexView& mesh_;
  const HexAdjacency& adjacency_;
  int keep_;
  std::vector<Vec3> centres_;
};

}  // namespace

QualityReport measure_quality(const HexView& mesh, const HexAdjacency& adjacency,
                              const QualitySettings& settings, Progress* progress) {
  QualityReport report;
  report.points = static_cast<Offset>(mesh.points().size());
  report.cells = mesh.cell_count();
  report.internal_faces = adjacency.internal_faces;
  report.boundary_faces = adjacency.boundary_faces();
  report.blocks = mesh.block_count();
  if (report.cells == 0) return report;
  Measurement measurement(mesh, adjacency, settings);
  if (progress) progress->step("quality, cells", 0);
  measurement.cells(report);
  if (progress) progress->step("quality, faces", 0.5);
  measurement.faces(report);
  return report;
}

std::vector<std::string> check_mesh_failures(const QualityReport& r) {
  std::vector<std::string> failures;
  const auto check = [&](Offset count, const std::string& sentence) {
    if (count > 0) failures.push_back(fmt::format("{} {}", count, sentence));
  };
  check(r.open_cells, fmt::format("open cells (openness {:.3g}, limit 1e-6)", r.max_openness));
  check(r.high_aspect_cells,
        fmt::format("cells of high aspect ratio ({:.4g}, limit 1000)", r.aspect_ratio.max));
  check(r.zero_area_faces, "faces without area");
  check(r.not_positive_volumes, fmt::format("cells without positive volume ({:.4g})", r.min_volume));
  check(r.non_orthogonality_errors,
        fmt::format("faces at 90 degrees and more ({:.4g})", r.non_orthogonality.max));
  check(r.wrong_pyramids, "face pyramids of negative volume");
  check(r.skew_faces, fmt::format("skew faces ({:.4g}, limit 4)", r.skewness.max));
  return failures;
}

}  // namespace flowcage
