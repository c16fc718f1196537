#include "core/grade/wall_units.hpp"

#include <cmath>

namespace flowcage {

double first_height_of_yplus(double yplus, double reynolds) {
  const double friction = 0.026 / std::pow(reynolds, 1.0 / 7.0);
  return yplus / (reynolds * std::sqrt(friction / 2));
}

}  // namespace flowcage
