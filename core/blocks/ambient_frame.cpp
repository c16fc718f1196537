#include "core/blocks/ambient_frame.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/base/error.hpp"
#include "core/target/open_borders.hpp"

namespace flowcage {
namespace {

constexpr double cells_along_diagonal = 9;    // of a body's bounding box, where no size is asked
constexpr double cells_along_shortest = 1.5;  // at least so many across the box's shortest side

}  // namespace

AmbientFrame ambient_frame(const TargetSurface& target, const AmbientSettings& settings) {
  AmbientFrame frame;
  frame.body = target.bounds();
  const Vec3 extent = frame.body.sizes();
  const double length = extent.maxCoeff();
  const double diagonal = target.diagonal();
  for (int axis = 0; axis < 3; ++axis) {
    const double size = settings.cage_size > 0 ? settings.cage_size : diagonal / cells_along_diagonal;
    frame.size[axis] = std::min(size, std::max(extent[axis] / cells_along_shortest, 1e-3 * diagonal));
  }
  if (settings.internal) {
    const double margin = 0.02 * diagonal;
    frame.near = Box3(frame.body.min() - Vec3::Constant(margin), frame.body.max() + Vec3::Constant(margin));
    frame.far = frame.near;
    return frame;
  }
  const double reach = settings.farfield_size * length;
  const Vec3 centre = frame.body.center();
  frame.far = Box3(centre - Vec3::Constant(reach), centre + Vec3::Constant(reach));
  const Vec3 room = 0.5 * extent.cwiseMin(0.5 * length).array() + 0.25 * length;
  frame.near = Box3(frame.body.min() - room, frame.body.max() + room);
  for (const OpenBorder& border : find_open_borders(target)) {
    if (border.kind != BorderKind::plane) continue;
    if (border.axis < 0) {
      throw Error(ErrorKind::input,
                  fmt::format("the CAD's open border at {} lies in a plane that is no coordinate plane",
                              place(border.place)),
                  "turn the model so that its symmetry plane is normal to x, y or z");
    }
    const double value = border.value * (border.normal[border.axis] < 0 ? -1 : 1);
    const bool low = value - frame.body.min()[border.axis] < frame.body.max()[border.axis] - value;
    frame.sides[2 * border.axis + (low ? 0 : 1)] = {PatchType::symmetry, true};
    for (Box3* box : {&frame.near, &frame.far}) (low ? box->min() : box->max())[border.axis] = value;
  }
  return frame;
}

}  // namespace flowcage
