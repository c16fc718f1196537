// The bodies that the automatic blocks are judged by, built in code.
#pragma once
#include <string>
#include <vector>

#include "occ_bridge/cad_model.hpp"

namespace flowcage::test {

struct AmbientTestBody {
  CadModel cad;
  bool internal = false;  ///< the fluid is inside
  Index genus = 0;        ///< of the whole surface
  Index parts = 1;        ///< connected parts of the surface
};

std::vector<std::string> ambient_body_names();
/// Precondition: one of the names.
AmbientTestBody make_ambient_body(const std::string& name);

}  // namespace flowcage::test
