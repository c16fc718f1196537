#pragma once
#include <span>
#include <vector>

#include "core/blocks/ambient_body.hpp"
#include "core/blocks/chart_borders.hpp"
#include "core/mesh/cage.hpp"

namespace flowcage {

struct LabelSettings {
  double size = 1;          ///< length that distances are relative to
  double normal = 1;        ///< cost of a quad that faces across its chart, against a distance of one size
  double border = 0.1;      ///< of a border per edge on the charts' common curve,
  double off_border = 0.5;  ///< and of one farther from it, per size
  double strange = 2;       ///< of a border between charts that do not meet
};

/// The chart that each quad of a voxel surface belongs to. Everything is in the mapped box, where quads and
/// charts are nearly axis-aligned: quads cost their distance from a chart and the angle between directions,
/// borders the distance from the curve where the two charts meet. Minimised by label_expansion.
///
/// points, triangles: the mapped body's; triangle_chart: #triangles, no_index where it is no chart's.
/// wall: quads with mapped points, outward of the body or inward, as `sign` (1 or -1) says.
std::vector<Index> label_quads(const Cage& wall, double sign, std::span<const Vec3> points,
                               std::span<const std::array<Index, 3>> triangles,
                               std::span<const Index> triangle_chart, const SurfaceCharts& charts,
                               const ChartBorders& borders, const LabelSettings& settings);

}  // namespace flowcage
