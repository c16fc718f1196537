// Half, quarter and eighth models and the whole bodies they stand for.
#pragma once
#include <string>
#include <vector>

#include "core/mesh/surface_level.hpp"

namespace flowcage {

struct HalfCage {
  struct Plane {
    int axis;
    double value;
  };
  std::string name;
  Cage cage;  ///< boundary edges with both ends in a plane are mirrored there
  std::vector<Plane> planes;
};

/// Boundary edges of the cage's level in the plane.
std::vector<Index> edges_in(const SurfaceLevel& level, const std::vector<Vec3>& points,
                            const HalfCage::Plane& plane);

/// The mirrored level; sharpness that the cage gives to edges and vertices in the planes is kept.
SurfaceLevel half_level(const HalfCage& half);

/// The whole body as a cage of its own: the half's faces with the half's corners first, then images.
Cage whole_cage(const HalfCage& half);

/// Cages of every kind: polygons, valences 2 to 12 in the plane, creases, corners and darts of any sharpness
/// in, into and beside the plane, open ends at the plane, one to three planes, at values other than 0.
std::vector<HalfCage> half_cages();

}  // namespace flowcage
