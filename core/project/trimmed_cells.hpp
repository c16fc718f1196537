#pragma once
#include <array>
#include <vector>

#include "core/base/types.hpp"
#include "core/target/bounded_patch.hpp"

namespace flowcage {

/// A piece of a trimming polygon in (u, v).
struct TrimSegment {
  Vec2 a, b;
};

/// A box of a patch's domain, flat enough for a search, with what is needed to prune and to trim.
struct PatchCell {
  Eigen::AlignedBox2d box;
  Vec3 p00, p10, p01, p11;  ///< its corners, (u, v) = low low, high low, low high, high high
  double slack = 0;         ///< the surface is within this of the triangles p00 p10 p11 and p00 p11 p01
  // How much the Hessian of half the squared distance, relative to the first fundamental form, may differ
  // from the cell's middle: a part in proportion to the distance, and a part without (nine samples).
  double bend_change = 0, metric_change = 0;
  Vec3 normal_axis = Vec3::Zero();  ///< cone that holds the unit du x dv
  double normal_cosine = -1;        ///< of its half angle; -1: any direction
  Index patch = 0;
  bool at_open_side = false;  ///< on a side of the patch that no border curve covers
  Offset first_segment = 0;   ///< of the trimming polygon, those that come near the box
  Index segment_count = 0;    ///< 0: wholly inside of the trimming
  Vec2 reference = Vec2::Zero();
  bool reference_inside = true;
};

/// How a point of a patch lies to the trimming polygon.
enum class TrimSide : std::uint8_t { inside, outside, near_border };

struct TrimmedCells {
  std::vector<PatchCell> cells;
  std::vector<TrimSegment> segments;
};

struct CellSettings {
  double flatness = 0.02;            ///< split until the deviation is below this part of the cell's diagonal
  double max_size = 0;               ///< split until the diagonal is below
  double max_trimmed_size = 0;       ///< the same for cells that the trimming crosses
  double min_size = 0;               ///< never split below
  double margin = 0;                 ///< in space: segments this near to a cell belong to it
  std::array<bool, 4> open_sides{};  ///< of the patch, u low, u high, v low, v high: not covered by curves
  int max_depth = 32;
};

/// The trimming of a face: a polygon (parity rule, any number of loops, parts on the window's border left
/// out) and one point of known side.
struct TrimOutline {
  std::vector<TrimSegment> segments;
  Vec2 reference = Vec2::Zero();
  bool reference_inside = true;
};

/// Appends the cells of a patch that are not wholly outside of the trimming.
void append_cells(const BoundedPatch& patch, Index patch_number, const TrimOutline& outline,
                  const CellSettings& settings, TrimmedCells& result);

/// By the parity of crossings between the point and the cell's reference; near_border within `margin`, a
/// length in space, of a segment.
TrimSide trim_side(const TrimmedCells& cells, const PatchCell& cell, const PatchPoint& point, const Vec2& uv,
                   double margin);

}  // namespace flowcage
