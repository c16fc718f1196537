#pragma once
#include <string>

namespace flowcage {

/// Version of the OpenCASCADE that this program was built with, for example "7.6.3".
std::string occ_version();

}  // namespace flowcage
