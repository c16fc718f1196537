#pragma once
#include <memory>

#include "occ_bridge/cad_model.hpp"
#include "occ_bridge/internal/prepared_model.hpp"

namespace flowcage::occ {

/// From a prepared model: counts, triangles, feature chains and faces in metres.
std::shared_ptr<CadModel::Data> build_model(PreparedModel prepared, const CadReadSettings& settings,
                                            Progress& progress);

}  // namespace flowcage::occ
