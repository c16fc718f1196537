#pragma once
#include <TopoDS_Shape.hxx>
#include <string>
#include <vector>

#include "occ_bridge/internal/read_files.hpp"

namespace flowcage::occ {

/// Splits the faces whose surface has a kink along a knot line (B-splines that are only C0 there are common),
/// so that every face is smooth inside and each kink is an edge whose angle can be measured. A kink: the
/// normals on both sides of the knot line differ by more than `angle` radians somewhere inside the face.
/// Names pass on; warnings say how many were split, and which could not be.
TopoDS_Shape split_kinks(const TopoDS_Shape& shape, double angle, FaceLabels& labels,
                         std::vector<std::string>& warnings);

}  // namespace flowcage::occ
