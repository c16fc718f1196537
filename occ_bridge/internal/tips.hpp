#pragma once
#include <TopoDS_Face.hxx>
#include <span>
#include <vector>

#include "core/target/target_surface.hpp"

namespace flowcage::occ {

/// Apexes of cones: places where a side of a face collapses to a point (a degenerate edge) round which the
/// face's normals differ by more than `crease_angle` radians, and where no feature chain ends. The pole of a
/// sphere or a smooth nose is none. faces: in metres; tips closer than `apart` are one.
std::vector<Vec3> find_tips(std::span<const TopoDS_Face> faces, const FeatureGraph& features,
                            double crease_angle, double apart);

}  // namespace flowcage::occ
