#pragma once
#include <string>
#include <vector>

#include "core/mesh/cage.hpp"
#include "core/mesh/surface_level.hpp"

namespace flowcage {

/// A level of a subdivided cage as a cage of its own: subdividing it goes on where the level stands.
/// Sharpness above zero becomes creases and corners, without those that a boundary has by itself.
/// Preconditions: points.size() == level.vertex_count(); face_patch refers to patch_names.
Cage cage_of_level(const SurfaceLevel& level, std::vector<Vec3> points, std::vector<std::string> patch_names);

}  // namespace flowcage
