#pragma once
#include "occ_bridge/cad_model.hpp"
#include "occ_bridge/internal/prepared_model.hpp"

namespace flowcage::occ {

/// The model with its bodies that pass through or touch each other replaced by their outer skin: the pieces
/// of their faces that are not inside of another body, joined along the curves in which the bodies meet.
/// Cavities that they enclose together stay. A group of closed bodies becomes one solid; names pass on;
/// model.bodies says which body each face comes from. A group that cannot be united stays as it is, with a
/// warning; summary.overlaps tells of each. Works in a process of its own, and returns the model unchanged
/// where nothing touches.
///
/// A group is accepted if its free edges are not longer than before (none on closed bodies) and no piece is
/// partly hidden (pieces of less than a twentieth of the area where a body is open, with a warning).
PreparedModel united(PreparedModel model, const CadReadSettings& settings, Progress& progress);

}  // namespace flowcage::occ
