#pragma once
#include "core/export/write_foam_case.hpp"
#include "core/options.hpp"
#include "core/pipeline.hpp"

namespace flowcage {

/// Refuses --case without an OpenFOAM output or in another unit than metres, and what belongs to --case
/// without it. Throws Error(usage).
void check_flow_case(const Options& options);

/// --direction, of unit length.
Vec3 flow_direction(const Options& options);

/// The flow of --case. Viscosity: --viscosity, else by --reynolds and --length. y+: --yplus, else that of the
/// mean first height of the walls, where --length or an external flow's body gives a length.
FoamFlow flow_of(const Options& options, const VolumeResult& result, double diagonal);

}  // namespace flowcage
