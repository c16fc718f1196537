#pragma once
#include <array>

#include "core/blocks/ambient_settings.hpp"
#include "core/mesh/hex_view.hpp"
#include "core/target/target_surface.hpp"

namespace flowcage {

/// The box that an ambient grid fills, and what its six sides are.
struct AmbientFrame {
  struct Side {
    PatchType type = PatchType::farfield;
    bool at_body = false;  ///< cuts the body: a symmetry plane, waterline or ground
  };
  Box3 body;                     ///< bounds of the CAD
  Box3 near;                     ///< where the map works: the body and room round it, cut by symmetry planes
  Box3 far;                      ///< the whole box (internal flow: as `near`)
  std::array<Side, 6> sides;     ///< x low, x high, y low, ...
  std::array<double, 3> size{};  ///< asked edge length along each axis
};

/// The frame of a CAD: its open borders in coordinate planes at its bounds are symmetry planes (external
/// flow). Throws Error(input) where an open border lies in a plane that is no coordinate plane.
AmbientFrame ambient_frame(const TargetSurface& target, const AmbientSettings& settings);

}  // namespace flowcage
