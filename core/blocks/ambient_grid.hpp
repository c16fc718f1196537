#pragma once
#include <string>
#include <vector>

#include "core/base/progress.hpp"
#include "core/blocks/ambient_settings.hpp"
#include "core/blocks/finding.hpp"
#include "core/mesh/cage.hpp"
#include "core/mesh/hex_complex.hpp"
#include "core/target/target_surface.hpp"

namespace flowcage {

struct AmbientReport {
  std::array<std::vector<double>, 3> lines;  ///< of the grid, in the mapped box
  std::array<double, 3> size{};              ///< asked edge length along each axis, metres
  Index charts = 0;                          ///< parts of the surface that the map made flat
  Index turned_voxels = 0;                   ///< by the repair
  Index chains = 0, chains_matched = 0;      ///< sharp chains of the CAD; those that creases follow
  std::vector<AmbientFinding> findings;      ///< empty: every check holds
};

/// Coarse blocks and the cage that is their wall. Plain data, in metres.
struct AmbientBlocks {
  HexComplex complex;                ///< boundary: the cage's patches, "farfield", "symmetry", "inlet" ...
  Cage cage;                         ///< the wall's quads, counter-clockwise seen from the CAD's normal side
  std::vector<Index> vertex_corner;  ///< #V of the cage: its corner of the complex
  std::vector<Index> face_quad;      ///< #F of the cage: its quad of the complex
  std::vector<Index> face_region;    ///< #F: the CAD face it belongs to
  std::vector<Index> face_chart;     ///< #F: the chart of the CAD's surface it was given
  AmbientReport report;
};

/// The automatic blocks of the general kind: a grid of the far-field box minus the voxels of the body
/// (external flow), or the body's own voxels (internal flow).
/// Throws Error(gate) where no usable blocks were found, naming what failed and where.
AmbientBlocks make_ambient_blocks(const TargetSurface& target, const AmbientSettings& settings,
                                  Progress& progress);

}  // namespace flowcage
