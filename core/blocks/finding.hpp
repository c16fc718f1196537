#pragma once
#include <string>

#include "core/base/types.hpp"

namespace flowcage {

/// A check that failed while blocks were made, with what a person needs to find it.
struct AmbientFinding {
  std::string check;  ///< "manifold", "cavity", "region", "border", "chain", ...
  std::string what;   ///< one line: the CAD's face or edge, and coordinates
  Vec3 place = Vec3::Zero();
};

}  // namespace flowcage
