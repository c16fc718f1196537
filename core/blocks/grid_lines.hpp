#pragma once
#include <array>
#include <vector>

#include "core/blocks/ambient_frame.hpp"

namespace flowcage {

/// Values that a grid line along one axis must have.
struct LineAnchor {
  double value = 0;
  double weight = 1;  ///< area or length behind it: where anchors are merged, the heaviest keeps its place
  int side = 0;       ///< -1, +1: a chart that faces down or up the axis; 0: a line
};

/// Grid lines of a frame: one at every anchor (those nearer together than `merge` of the size become one, but
/// never charts that face each other), filled evenly to the frame's size inside of the body, growing by
/// `growth` from there to the far field.
std::array<std::vector<double>, 3> grid_lines(const AmbientFrame& frame,
                                              const std::array<std::vector<LineAnchor>, 3>& anchors,
                                              double growth, double merge = 0.3);

}  // namespace flowcage
