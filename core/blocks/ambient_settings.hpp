#pragma once
#include "core/base/types.hpp"

namespace flowcage {

/// How the automatic blocks are made. Lengths in metres.
struct AmbientSettings {
  bool internal = false;      ///< the fluid is inside of the CAD
  double cage_size = 0;       ///< edge length of cage quads; 0: from the body's size
  double farfield_size = 20;  ///< distance of the box from the body's centre, in body lengths
  bool map = true;            ///< make the CAD nearly axis-aligned first
  bool wall_layer = true;     ///< an O-grid of one layer round the body (pillow)
  double growth = 3;          ///< of the blocks from the body toward the far field
  Index max_blocks = 40000;
};

}  // namespace flowcage
