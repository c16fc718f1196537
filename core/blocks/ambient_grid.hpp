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
  Index genus = 0;                           ///< of the cage
  bool topology_checked = false;             ///< against the CAD's, where its surface is closed
  std::string steps;                         ///< of the ladder that led here
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
  AmbientReport report;
};

/// The automatic blocks of the general kind: a grid of the far-field box minus the voxels of the body
/// (external flow), or the body's own voxels (internal flow). The grid is laid in a mapped box where the CAD
/// is nearly axis-aligned, and pulled back; quads of the wall are labelled with the CAD's charts, label
/// borders on sharp curves are creases (docs/automatic.md).
///
/// Where a check fails a ladder is climbed: lines at the ends of lost regions, smaller cells, no map. The
/// first blocks without a finding are returned, or those with the fewest, with their findings in the report:
/// never is a lost feature kept quiet. Throws Error(gate) where there are no usable blocks at all,
/// Error(input) as ambient_frame does.
///
/// complex.points of the wall are still voxels pulled back; cage.points lie on the CAD. place_blocks
/// (core/auto_blocks) brings both together.
AmbientBlocks make_ambient_blocks(const TargetSurface& target, const AmbientSettings& settings,
                                  Progress& progress);

}  // namespace flowcage
