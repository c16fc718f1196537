// A torus with radii 1 m and 0.35 m, written as STEP in millimetres: make_cad FILE.step
#include <cstdio>

#include "core/base/error.hpp"
#include "occ_bridge/shapes.hpp"

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: %s FILE.step\n", argv[0]);
    return 2;
  }
  try {
    flowcage::write_cad(flowcage::make_torus(1.0, 0.35), argv[1], "mm");
  } catch (const flowcage::Error& error) {
    std::fprintf(stderr, "%s\n%s\n", error.what(), error.remedy().c_str());
    return static_cast<int>(error.kind());
  }
  return 0;
}
