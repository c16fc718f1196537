#pragma once
#include <vector>

#include "core/base/progress.hpp"
#include "core/blocks/ambient_map.hpp"
#include "core/blocks/chart_borders.hpp"

namespace flowcage {

/// What is made once of a CAD, whatever grid is laid over it then: its surface in charts, the map that makes
/// them flat, and the body in the mapped box.
struct AmbientSurface {
  AmbientFrame frame;
  AmbientBody body;
  double volume = 0;  ///< that its triangles enclose; negative where the CAD's normals point inward
  SurfaceCharts charts;
  std::vector<KnifeLine> knives;
  AmbientMap map;
  ChartBorders borders;
  std::vector<Vec3> mapped;           ///< the body's points in the mapped box
  std::vector<Index> triangle_chart;  ///< #triangles of the body; no_index on fans
};
AmbientSurface ambient_surface(const TargetSurface& target, const AmbientSettings& settings,
                               Progress& progress);

}  // namespace flowcage
