#include "core/mesh/opening_names.hpp"

#include "tests/catch.hpp"

using namespace flowcage;

TEST_CASE("inlets and outlets are known by their names") {
  for (const char* name : {"inlet", "Inlet", "INFLOW", "inlet_2", "inlet-12", "inflow 3", "inlet7"}) {
    CAPTURE(name);
    CHECK(patch_type_of_name(name) == PatchType::inlet);
  }
  for (const char* name : {"outlet", "Outflow_1"}) CHECK(patch_type_of_name(name) == PatchType::outlet);
  for (const char* name : {"", "wall", "inlet_lip", "my inlet", "inlet_", "12", "outlets"}) {
    CAPTURE(name);
    CHECK(patch_type_of_name(name) == PatchType::wall);
  }
}
