#pragma once
#include <string>

#include "core/auto_blocks.hpp"
#include "core/limit/bicubic_patches.hpp"
#include "core/options.hpp"
#include "core/pipeline.hpp"

namespace flowcage {

/// What an engineer looks at first, as tables for a person: deviations a level, and of a volume its quality
/// and, per patch, deviation and wall spacing (in the output's unit). `diagonal` is the CAD's, in metres.
std::string surface_summary(const SurfaceFit& fit, double diagonal);
/// One line on the B-spline patches of a STEP file.
std::string patches_summary(const PatchSurface& patches, double diagonal);
/// The blocks' numbers, and every check that failed.
std::string blocks_summary(const PlacedBlocks& placed);
std::string volume_summary(const VolumeResult& result, double diagonal, const Options& options);

}  // namespace flowcage
