#pragma once
#include <span>
#include <vector>

#include "core/mesh/chord_sheet.hpp"

namespace flowcage {

/// How layers end where a sheet of blocks goes on beyond the wall.
struct BlendSettings {
  double reach = 1;  ///< metres, > 0: distance from the wall along the sheet at which they have ended
};

/// Share of each line's own spacing (#lines of the sheet): 0 on the wall's lines, 1 from `reach` on, between
/// them x^2 (3 - 2 x), x the distance along the sheet's near side to the nearest of the wall's lines over the
/// reach: shortest paths over the sides and the diagonals of its faces. Lines that no path reaches keep 1.
std::vector<double> own_shares(const BlockMesh& mesh, const ChordSheet& sheet, std::span<const char> on_wall,
                               const BlendSettings& settings);

/// The geometric mean of two spacings (places along a line, ascending from 0 to the same end): sizes of cells
/// pass from one to the other by equal ratios as the share of `own` goes from 0 to 1.
std::vector<double> blended(std::span<const double> layered, std::span<const double> own, double share);

}  // namespace flowcage
