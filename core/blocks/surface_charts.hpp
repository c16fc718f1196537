#pragma once
#include <array>
#include <vector>

#include "core/target/target_surface.hpp"

namespace flowcage {

/// The CAD's triangles in charts: connected parts, bounded by sharp edges, whose normals point mainly along
/// one of the six axis directions.
struct SurfaceCharts {
  struct Chart {
    int axis = 0, sign = 1;     ///< main direction of its normals
    Index group = no_index;     ///< smooth part of the surface (not crossing sharp edges) it belongs to
    double area = 0;            ///< m^2
    double diameter = 0;        ///< diagonal of its bounding box
    Vec3 place = Vec3::Zero();  ///< centre of its area
  };
  std::vector<Chart> charts;
  std::vector<Index> chart;                  ///< #T
  std::vector<std::array<Index, 3>> across;  ///< #T: the triangle over edge i (corners i, i+1), or no_index
  std::vector<std::array<Index, 3>> chain;   ///< #T: the sharp chain that edge i lies on, or no_index
  Index group_count = 0;
};

/// Cuts the target's tessellation into charts. Each triangle takes the direction nearest to its normal;
/// charts smaller than `least_area`, and crumbs of them, join the neighbour with the longest common smooth
/// border, so a chart without one stays, however small.
SurfaceCharts surface_charts(const TargetSurface& target, double least_area);

}  // namespace flowcage
