#include "occ_bridge/occ_version.hpp"

#include <Standard_Version.hxx>

namespace flowcage {

std::string occ_version() {
  return OCC_VERSION_COMPLETE;
}

}  // namespace flowcage
