#pragma once
#include <string_view>

#include "core/mesh/block_mesh.hpp"

namespace flowcage {

/// What a patch of the CAD is by its name: inlet for "inlet" and "inflow", outlet for "outlet" and "outflow",
/// in any case and with a number behind ("Inlet", "outlet_2", "OUTFLOW 3"), otherwise wall. Other words
/// ("inlet_lip") are names of walls.
PatchType patch_type_of_name(std::string_view name);

/// Gives the walls of a mesh the types that their names say: inlets and outlets are walls while the blocks
/// follow the CAD there, the solver sees what they are.
void name_openings(BlockMesh& mesh);

}  // namespace flowcage
