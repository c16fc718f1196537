#pragma once
#include <vector>

#include "cli/json_report.hpp"
#include "core/curve/curved_bound.hpp"
#include "core/curve/curved_mesh.hpp"
#include "core/pipeline.hpp"

namespace flowcage {

/// The curved mesh of --order, with what was measured of it.
struct CurvedJob {
  CurvedMesh mesh;
  CurveReport report;
  CurvedValidity validity;
};

/// Refuses --order without the snap that it starts from, and with formats of linear cells. Throws
/// Error(usage).
void check_order(const Options& options);

/// Makes and measures it; its gates (nodes on the CAD, every cell proved valid) are added to the result's.
CurvedJob make_curved(VolumeResult& result, const TargetSurface& target, int order, Progress& progress);

/// "curved" of the JSON.
Json curved_json(const CurvedJob& job, double diagonal);

}  // namespace flowcage
