// The bodies that the volume is judged by: those of the fit, and more, with what lies around them.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "core/mesh/cage.hpp"
#include "occ_bridge/cad_model.hpp"

namespace flowcage::test {

struct VolumeBody {
  std::string name;
  CadModel cad;
  Cage cage;
  std::optional<Cage> outer;  ///< none: a far field grows from the body
  double length = 1;          ///< largest extent of the CAD, metres
};

/// Names of all bodies, in the order of the table.
std::vector<std::string> volume_body_names();
/// Precondition: one of the names.
VolumeBody make_volume_body(const std::string& name);

}  // namespace flowcage::test
