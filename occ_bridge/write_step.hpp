#pragma once
#include <span>
#include <string>

#include "core/limit/bicubic_patches.hpp"
#include "occ_bridge/shapes.hpp"

namespace flowcage {

/// Patches as a boundary representation: neighbours share their edges and vertices, so nothing has to be
/// sewn. Each closed component becomes a solid whose faces point outward, each open one a shell whose faces
/// keep the side of the patches; several become a compound. Throws Error(internal) where the kernel finds
/// fault with it.
Shape shape_of_patches(const PatchSurface& surface);

/// STEP (AP214), lengths in `unit` (m, mm, in or ft; the surface is in metres). Faces are named
/// patch_names[patch.name] where that is not empty. The same bytes for the same input: the header has no
/// time. Throws Error(output) when the file cannot be written, Error(usage) for another unit.
struct StepFile {
  std::string file;      ///< where to write
  std::string shown_as;  ///< its name in messages and in the header
  std::string unit = "m";
};
void write_step(const PatchSurface& surface, std::span<const std::string> patch_names, const StepFile& to);

}  // namespace flowcage
