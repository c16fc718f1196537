#pragma once
#include <array>
#include <vector>

#include "core/base/progress.hpp"
#include "core/blocks/ambient_body.hpp"
#include "core/blocks/ambient_frame.hpp"
#include "core/blocks/surface_charts.hpp"

namespace flowcage {

/// A map of space that makes a CAD nearly axis-aligned: trilinear on a Cartesian grid over the frame's near
/// box, the identity beyond it. Its displacement is 0 on the box's sides (on sides that cut the body only
/// across them).
struct AmbientMap {
  std::array<std::vector<double>, 3> lines;  ///< of the grid; empty: the identity
  std::vector<Vec3> displacement;            ///< #nodes, first axis fastest
  std::vector<double> chart_value;           ///< per chart: its coordinate along its axis, in the mapped box
  std::vector<std::array<double, 3>>
      line_value;  ///< per knife line: its coordinate along each axis (NaN: free)

  Vec3 operator()(const Vec3& x) const;
  /// The point that is mapped to y, by damped Newton steps from `start`; y itself where the map is the
  /// identity. Where the map folds there may be none: the nearest that was found.
  Vec3 inverse(const Vec3& y, const Vec3& start) const;
};

struct MapSettings {
  int nodes = 40;              ///< along the longest axis
  double chart_weight = 30;    ///< of a chart's flatness against the map's smoothness
  double surface_weight = 10;  ///< stiffness of the surface along axes that a triangle is not labelled with
  double body_weight = 10;     ///< stiffness of the body's inside
};

/// Spacing of the map's grid.
double map_spacing(const AmbientFrame& frame, const MapSettings& settings);

/// A curve that should have a constant coordinate along `axes` (bit a): a knife edge.
struct KnifeLine {
  std::vector<Vec3> points;  ///< evenly along it
  double length = 0;
  int axes = 0;
  int across = 0;  ///< the axis along which its two sides face
};

/// Three least-squares problems, one an axis: displacement v along it minimises
///   int k |grad v|^2  +  sum over charts of that axis  w / h int (x + v - c)^2  +  the same along knife
///   lines
///   +  sum over the other charts  h s int |grad v|^2
/// with k = body_weight inside of the body and 1 outside, c an unknown of each chart and line, h the grid's
/// spacing; by conjugate gradients. The body's triangles are not longer than about the grid's
/// spacing: each is a point of the integrals.
AmbientMap solve_ambient_map(const AmbientBody& body, const SurfaceCharts& charts, const AmbientFrame& frame,
                             const std::vector<KnifeLine>& knives, const MapSettings& settings,
                             Progress& progress);

}  // namespace flowcage
