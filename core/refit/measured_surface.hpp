#pragma once
#include <optional>
#include <vector>

#include "core/limit/evaluate.hpp"
#include "core/mesh/surface_level.hpp"

namespace flowcage {

/// The limit surface of a level as deviation.hpp and coverage.hpp measure it. Quads only.
class MeasuredSurface {
 public:
  /// points: #V control points.
  MeasuredSurface(SurfaceLevel level, std::vector<Vec3> points);

  SurfaceLevel level;
  std::vector<Vec3> points;
  std::vector<Vec3> samples;  ///< limits at its vertices, then edges' and faces' midpoints

  /// The limit point anywhere. Any thread, once prepare_evaluation was called.
  LimitPoint at(const LimitLocation& place) const { return evaluator_->evaluate(points, place); }
  void prepare_evaluation();

 private:
  std::optional<LimitEvaluator> evaluator_;
};

}  // namespace flowcage
