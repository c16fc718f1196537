#pragma once
#include <span>
#include <string>

#include "core/limit/bicubic_patches.hpp"

namespace flowcage {

struct StepFile {
  std::string file;        ///< where to write
  std::string shown_as;    ///< its name in messages and in the header
  std::string unit = "m";  ///< m, mm, in or ft; the surface is in metres
};

/// Writes patches as STEP (AP214): a boundary representation whose faces share their edges and vertices, so
/// that nothing has to be sewn. Each closed component becomes a solid with its faces outward, each open one a
/// shell whose faces keep the side of the patches; several become a compound. Faces are named
/// patch_names[patch.name] where that is not empty. The same bytes for the same input: the header has no
/// time. Throws Error(output) when the file cannot be written, Error(usage) for another unit, Error(internal)
/// where the kernel finds fault with the shape.
void write_step(const PatchSurface& surface, std::span<const std::string> patch_names, const StepFile& to);

}  // namespace flowcage
