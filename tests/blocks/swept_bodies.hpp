// Wings that the swept-body route is judged by, and the way from CAD to a shaped volume mesh on it.
#pragma once
#include <string>
#include <vector>

#include "core/blocks/swept_blocks.hpp"
#include "core/mesh/block_mesh.hpp"
#include "core/optimise/hex_validity.hpp"
#include "core/refit/fit_surface.hpp"
#include "occ_bridge/cad_model.hpp"

namespace flowcage::test {

/// Names of the bodies built in code, in the order of the table.
std::vector<std::string> swept_body_names();
/// Precondition: one of the names.
CadModel make_swept_body(const std::string& name);
CadModel read_swept_cad(const std::string& file);

struct SweptMesh {
  SweptBlocks swept;
  SurfaceFit fit;
  BlockMesh mesh;
  HexValidity start;     ///< of the blocks before any smoothing
  HexValidity validity;  ///< of the mesh
};

/// Blocks, fit, refinement that follows the fit, smoothing: to level `levels` of the cage, without layers.
SweptMesh mesh_swept_body(const CadModel& cad, const std::string& name, int levels, Progress& progress);

}  // namespace flowcage::test
