#pragma once
#include <string_view>
#include <vector>

#include "core/target/target_surface.hpp"

namespace flowcage {

/// What an open border of a surface most likely is.
enum class BorderKind : std::uint8_t {
  plane,  ///< cut by a plane that the whole model lies on one side of: symmetry plane, waterline, open end
  gap,    ///< runs along another open border within the gap width, or a hole smaller than that: to be closed
  hole,   ///< another closed loop in a plane: a cap would close it
  sheet,  ///< the rim of an open sheet
};

/// A run of an open border of one kind. Lengths in metres.
struct OpenBorder {
  BorderKind kind = BorderKind::sheet;
  Index loop = 0;               ///< runs that meet end to end belong to one loop; numbered from 0
  bool closed = false;          ///< the loop comes back to its start
  std::vector<Index> chains{};  ///< of the target's features
  double length = 0;
  Vec3 place = Vec3::Zero();  ///< middle of its bounding box
  Box3 bounds{};
  int axis = -1;               ///< plane, hole: 0, 1, 2 where its plane is normal to x, y, z
  Vec3 normal = Vec3::Zero();  ///< plane, hole: of its plane, unit
  double value = 0;            ///< plane, hole: position of the plane along `normal`
  double width = 0;            ///< gap: its widest place
};

/// Relative to the model's diagonal.
struct BorderSettings {
  double planar = 1e-5;     ///< points within this of a plane lie in it
  double join = 1e-4;       ///< ends of chains that are nearer than this meet
  double gap_width = 1e-2;  ///< borders nearer to each other than this may be the sides of a gap
};

/// Tells the boundary chains of a model apart. In this order, a chain is
/// - a plane's where its whole loop lies in one plane that no point of the tessellation is beyond, and the
///   faces beside it leave that plane;
/// - a gap's where its closed loop is smaller than the gap width; or where 8 of 10 of its points have another
///   chain beside them that runs their way, within the gap width and within a twentieth of its length; or
///   where it is shorter than the gap width between two such sides;
/// - where its whole loop is closed and in a plane: a sheet's if the surface fills it, else a hole's;
/// - a plane's where it alone lies in an axis plane at the model's bounds, and the faces beside it leave it;
/// - else a sheet's.
/// Loops with one kind throughout become one border, others one a run of chains of one kind (a half hull:
/// symmetry plane along keel and stems, waterline along the deck).
std::vector<OpenBorder> find_open_borders(const TargetSurface& surface, const BorderSettings& settings = {});

/// "plane", "gap", "hole", "sheet".
std::string_view name_of(BorderKind kind);

}  // namespace flowcage
