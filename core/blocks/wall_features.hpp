#pragma once
#include <span>
#include <vector>

#include "core/blocks/ambient_body.hpp"
#include "core/blocks/chart_borders.hpp"
#include "core/blocks/finding.hpp"
#include "core/mesh/cage.hpp"
#include "core/target/target_surface.hpp"

namespace flowcage {

/// What a labelled wall follows: creases, corners, and places on the CAD.
struct WallFeatures {
  std::vector<Cage::Crease> creases;
  std::vector<Index> crease_chain;  ///< #creases: the sharp chain of the CAD
  std::vector<Cage::Corner> corners;
  std::vector<Index> face_region;  ///< #F: the CAD face
  std::vector<Vec3> places;        ///< #V: on the CAD, by the chart or the border that the vertex belongs to
  Index chains = 0, chains_followed = 0;  ///< sharp chains of the CAD; those with a crease
  std::vector<Index> lost_groups;         ///< parts of the surface between sharp edges that have no quad
  std::vector<AmbientFinding> findings;
};

/// A border between two charts is a crease where their common curve is sharp. Vertices inside of a chart get
/// the point of its triangles that is mapped nearest to them, on a border the nearest point of the common
/// curve, where three meet their common corner. A vertex where creases of two chains meet, or one ends, is a
/// corner. Findings: a part of the surface between sharp edges without
/// a quad ("region"), a border of charts that do not meet ("border"), a
/// sharp chain without a crease ("chain").
///
/// wall: mapped points; label: #F; points: the body's in the CAD, mapped: the same in the mapped box.
struct LabelledWall {
  const Cage& wall;
  std::span<const Index> label;
  const AmbientBody& body;
  std::span<const Vec3> mapped;
  std::span<const Index> triangle_chart;  ///< #triangles of the body
  std::span<const Vec3> pulled_back;      ///< #V of the wall: its points by the map's inverse
};
WallFeatures wall_features(const LabelledWall& labelled, const TargetSurface& target,
                           const SurfaceCharts& charts, const ChartBorders& borders);

}  // namespace flowcage
