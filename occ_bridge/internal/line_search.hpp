#pragma once
#include "occ_bridge/internal/search_candidate.hpp"

namespace flowcage {

/// One search for the nearest intersection of a line: see TargetSurface::intersect_lines.
class LineSearch {
 public:
  explicit LineSearch(const ProjectionParts& parts) : parts_(parts) {}
  SurfacePoint run(const Vec3& origin, const Vec3& direction, double min_cosine, double reach);

 private:
  void visit_cell(Index number);
  /// Newton's method from a fraction of the cell's box.
  void try_start(Index number, Index face, const Vec2& start);

  const ProjectionParts& parts_;
  Vec3 origin_ = Vec3::Zero(), direction_ = Vec3::Zero();
  double min_cosine_ = -1, reach_ = 0;
  Candidate best_;
};

}  // namespace flowcage
