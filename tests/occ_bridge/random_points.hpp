#pragma once
#include <random>
#include <vector>

#include "core/base/types.hpp"

namespace flowcage::test_shapes {

/// Points evenly spread over a box, the same for the same seed.
inline std::vector<Vec3> random_in(const Box3& box, std::size_t count, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < count; ++i) {
    const double x = unit(random), y = unit(random), z = unit(random);
    points.push_back(box.min() + Vec3(x, y, z).cwiseProduct(box.sizes()));
  }
  return points;
}

}  // namespace flowcage::test_shapes
