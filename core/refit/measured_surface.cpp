#include "core/refit/measured_surface.hpp"

#include "core/limit/limit_stencils.hpp"

namespace flowcage {

MeasuredSurface::MeasuredSurface(SurfaceLevel its_level, std::vector<Vec3> its_points)
    : level(std::move(its_level)),
      points(std::move(its_points)),
      samples(oversampled_limit_points(level, points)) {}

void MeasuredSurface::prepare_evaluation() {
  if (!evaluator_) evaluator_.emplace(level);
}

}  // namespace flowcage
