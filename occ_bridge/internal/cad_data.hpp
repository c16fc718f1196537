#pragma once
#include <TopoDS_Face.hxx>
#include <optional>
#include <string>
#include <vector>

#include "occ_bridge/cad_model.hpp"
#include "occ_bridge/internal/chain_curve.hpp"
#include "occ_bridge/internal/face_projector.hpp"

namespace flowcage {

/// What a CadModel holds. Everything in metres; face numbers are those of `faces`.
struct CadModel::Data {
  std::vector<TopoDS_Face> faces;
  std::vector<CadFace> labels;
  Tessellation tessellation;
  Box3 bounds;
  FeatureGraph features;
  std::vector<occ::ChainCurve> curves;
  std::optional<FaceProjector> projector;  ///< over `faces`
  CadSummary summary;
};

}  // namespace flowcage
