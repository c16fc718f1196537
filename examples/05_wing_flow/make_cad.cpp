// A swept half wing with NACA 0012 sections, sharp trailing edge, flat tip and open root, written as STEP in
// millimetres: make_cad FILE.step
#include <cstdio>

#include "core/base/error.hpp"
#include "occ_bridge/shapes.hpp"

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: %s FILE.step\n", argv[0]);
    return 2;
  }
  try {
    flowcage::HalfWing
        wing;  // root chord 1 m, tip chord 0.6 m, half span 2 m, leading edge swept by 25 degrees
    wing.airfoil = flowcage::naca_symmetric(0.12, 0);
    flowcage::write_cad(flowcage::make_half_wing(wing), argv[1], "mm");
  } catch (const flowcage::Error& error) {
    std::fprintf(stderr, "%s\n%s\n", error.what(), error.remedy().c_str());
    return static_cast<int>(error.kind());
  }
  return 0;
}
