#pragma once
#include <functional>
#include <map>
#include <vector>

#include "core/blocks/surface_charts.hpp"

namespace flowcage {

/// A point on the border of two charts, in the CAD and as it is mapped.
struct BorderPoint {
  Vec3 position = Vec3::Zero(), mapped = Vec3::Zero();
  Index chain = no_index;  ///< the sharp chain it lies on; no_index where the border is smooth
};

/// Where charts meet.
struct ChartBorders {
  std::map<std::array<Index, 2>, std::vector<BorderPoint>> between;  ///< key: the two charts, ascending
  /// Points of the tessellation where three charts or more meet.
  struct Corner {
    std::vector<Index> charts;  ///< ascending
    Vec3 position = Vec3::Zero(), mapped = Vec3::Zero();
  };
  std::vector<Corner> corners;
};

/// Samples the borders not coarser than `spacing`. `map` takes a point of the CAD to the mapped box.
ChartBorders chart_borders(const Tessellation& cad, const SurfaceCharts& charts, double spacing,
                           const std::function<Vec3(const Vec3&)>& map);

}  // namespace flowcage
