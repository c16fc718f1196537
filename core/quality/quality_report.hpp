#pragma once
#include <string>
#include <vector>

#include "core/base/progress.hpp"
#include "core/mesh/hex_adjacency.hpp"

namespace flowcage {

/// Counts in equal bins over [low, high]; a value outside is counted in the bin at that end.
struct Histogram {
  double low = 0, high = 1;
  std::vector<Offset> counts;
};

/// One of the worst cells (or, for a face metric, faces) of a metric.
struct WorstCell {
  double value = 0;
  Offset cell = 0;  ///< of a face: its owner
  Index block = 0;
  Vec3 place = Vec3::Zero();  ///< the cell's or face's centre
};

/// One metric over a whole mesh. If there is no cell or face to measure: count 0, all values 0.
struct MetricSummary {
  Offset count = 0;
  double min = 0, mean = 0, max = 0;
  Histogram histogram;
  std::vector<WorstCell> worst;  ///< worst first; ties by cell number
};

/// The quality table of a mesh. Every figure of OpenFOAM's is computed as checkMesh (v1912) does, see
/// foam_metrics.hpp. The thresholds are checkMesh's.
struct QualityReport {
  Offset points = 0, cells = 0, internal_faces = 0, boundary_faces = 0;
  Index blocks = 0;

  Offset inverted_cells = 0;      ///< the Jacobian is not positive at some corner
  MetricSummary scaled_jacobian;  ///< of cells, worst is least; jacobian.hpp
  MetricSummary
      non_orthogonality;       ///< of inner faces, degrees; mean = acos(mean cosine), as checkMesh prints
  MetricSummary skewness;      ///< of all faces
  MetricSummary aspect_ratio;  ///< of cells
  double max_openness = 0;

  double min_volume = 0, max_volume = 0, total_volume = 0;  ///< m^3
  double min_face_area = 0, max_face_area = 0;              ///< m^2

  Offset open_cells = 0;                ///< openness > 1e-6
  Offset high_aspect_cells = 0;         ///< > 1000
  Offset not_positive_volumes = 0;      ///< volume < 1e-300
  Offset zero_area_faces = 0;           ///< area < 1e-300
  Offset severely_non_orthogonal = 0;   ///< 70 to 90 degrees: a note of checkMesh's, no failure
  Offset non_orthogonality_errors = 0;  ///< 90 degrees and more
  Offset wrong_pyramids = 0;            ///< face pyramids of volume < -1e-15 m^3
  Offset skew_faces = 0;                ///< > 4
};

struct QualitySettings {
  int worst_count = 10;  ///< entries in each list of worst cells, >= 0
};

/// Measures a mesh. The same bits on any number of threads. A figure that is no number (a coordinate is not
/// finite) counts as the worst value: scaled Jacobian -1, 180 degrees, 1e300.
/// Memory: 24 bytes a cell beside the adjacency's.
QualityReport measure_quality(const HexView& mesh, const HexAdjacency& adjacency,
                              const QualitySettings& settings = {}, Progress* progress = nullptr);

/// The checks of default checkMesh that this mesh fails, one sentence each; empty where it says "Mesh OK"
/// (the topology is valid by construction: HexAdjacency).
std::vector<std::string> check_mesh_failures(const QualityReport& report);

}  // namespace flowcage
