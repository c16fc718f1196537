// Wings that the swept-body route is judged by, and the program's way from CAD to a mesh round them.
#pragma once
#include <string>
#include <vector>

#include "core/pipeline.hpp"
#include "occ_bridge/cad_model.hpp"

namespace flowcage::test {

/// Names of the bodies built in code, in the order of the table.
std::vector<std::string> swept_body_names();
/// Precondition: one of the names.
CadModel make_swept_body(const std::string& name);
CadModel read_swept_cad(const std::string& file);

/// Blocks, fit and mesh as the program makes them, to level `levels` of the cage.
VolumeResult mesh_swept_body(const CadModel& cad, const std::string& name, int levels,
                             const LayerSettings& layers, Progress& progress);

}  // namespace flowcage::test
