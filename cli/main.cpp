#include <cstdio>

#include "occ_bridge/occ_version.hpp"

int main() {
  std::printf("flowcage %s, OpenCASCADE %s\n", FLOWCAGE_VERSION, flowcage::occ_version().c_str());
  return 0;
}
