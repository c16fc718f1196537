#pragma once
#include <string>
#include <vector>

#include "cli/report/raster.hpp"
#include "cli/report/scene.hpp"
#include "core/base/atomic_file.hpp"

namespace flowcage {

/// Every name that write_pictures gives: an AtomicFolder replaces those of an earlier run.
std::vector<std::string> picture_names();

/// The pictures of a report as PNG files, without a display: deviation.png, quality.png, patch.png, block.png
/// (the body from the front, left and above, in parallel perspective), cut_x.png, cut_y.png, cut_z.png (what
/// a plane through the middle of the body cuts of the cells, seen along the axis), missed_GATE.png (the place
/// where a gate is missed, seen about along the surface's normal), as far as the scene has what they show.
/// Each with its scale. Throws Error(output).
void write_pictures(AtomicFolder& folder, const Scene& scene, const std::vector<Gate>& gates);

}  // namespace flowcage
