#pragma once
#include <memory>
#include <vector>

#include "occ_bridge/cad_model.hpp"
#include "occ_bridge/internal/read_files.hpp"

namespace flowcage::occ {

/// From the files' shapes to the model: one unit, split at kinks, sew, orient, tessellate, features, metres.
/// Precondition: each content has at least one face.
std::shared_ptr<const CadModel::Data> build_model(const std::vector<FileContent>& contents, FaceNames& names,
                                                  const CadReadSettings& settings, Progress& progress);

}  // namespace flowcage::occ
