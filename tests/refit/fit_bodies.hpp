// The bodies that the fit is judged by, built in code, each with a cage as a user would draw it.
#pragma once
#include <array>
#include <string>
#include <vector>

#include "core/mesh/cage.hpp"
#include "occ_bridge/cad_model.hpp"

namespace flowcage::test {

struct FitBody {
  std::string name;
  CadModel cad;
  Cage cage;
  std::array<double, 3> asked;  ///< largest deviation at levels 2, 3, 4, in diagonals
};

/// Names of all bodies, in the order of the table.
std::vector<std::string> fit_body_names();
/// Precondition: one of the names.
FitBody make_fit_body(const std::string& name);

}  // namespace flowcage::test
