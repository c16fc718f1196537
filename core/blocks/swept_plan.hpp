#pragma once
#include <array>
#include <map>
#include <vector>

#include "core/base/types.hpp"
#include "core/blocks/swept_section.hpp"

namespace flowcage {

/// The blocks of a plane across the span, as topology: C blocks round the airfoil, wake blocks behind it, a
/// plug inside of it, drawn once and swept along the span (METHOD of C-H grids).
///
///      B2 ------ B1 ------ B0 ---------- back upper    The ring 0, 1, .. runs from the upper trailing edge
///      |     2  /  1        |                  |       over the leading edge (3) to the lower one. C block i
///      |  ,- 2 ---- 1 ---.  |                  |       stands on ring edge i (i + 1). A sharp or round
///      B3 3   plug        > 0 ---------------- wake    trailing edge is vertex 0, where four blocks meet; a
///      |  `- 4 ---- 5 ---'  |                  |       blunt one has 0 above, 6 below, 7 in the middle of
///      |     4  \  5        |                  |       its base and two wake blocks behind it.
///      B4 ------ B5 ------ B6 ---------- back lower
///
/// The cage's faces are the coarse edges of the ring; its level 1 is the level of the blocks, because the
/// plug has triangles: plan edges of ring and plug have a middle, plug faces a centre.
struct SweptPlan {
  TrailingEdge trailing = TrailingEdge::sharp;
  Index ring = 6;                                ///< vertices of the ring, 0 .. ring - 1
  Index front = 6, rear = 7;                     ///< camber points of the plug
  std::vector<std::vector<Index>> plug;          ///< coarse polygons of ring, front and rear
  std::vector<std::vector<Index>> fine_plug;     ///< quads of all vertices
  std::vector<std::array<Index, 4>> outside;     ///< quads round the airfoil
  std::vector<std::array<Index, 2>> wall;        ///< edges of the fine ring
  std::vector<std::array<Index, 2>> outer;       ///< edges on the far field's sides
  Index coarse = 8, count = 0;                   ///< vertices of the coarse ring and plug come first; all
  std::map<std::array<Index, 2>, Index> middle;  ///< of a coarse edge, smaller vertex first
  std::vector<Index> centre;                     ///< #plug
  std::vector<Index> side;                       ///< outer vertices over the fine ring, from upper to lower
  std::vector<Index> wake;  ///< behind the fine ring's trailing edge, from upper to lower
  Index back_upper = no_index, back_lower = no_index;

  Index middle_of(Index a, Index b) const { return middle.at({std::min(a, b), std::max(a, b)}); }
};

/// All faces are counter-clockwise where the chord runs to the right and the normal up.
SweptPlan make_swept_plan(TrailingEdge trailing);

}  // namespace flowcage
