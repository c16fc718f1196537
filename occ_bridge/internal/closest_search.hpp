#pragma once
#include <array>
#include <limits>

#include "core/project/closest_point.hpp"
#include "occ_bridge/internal/face_projector.hpp"
#include "occ_bridge/internal/search_candidate.hpp"

namespace flowcage {

/// Searches for the nearest (compatible) points: see TargetSurface. One a thread.
class ClosestSearch {
 public:
  explicit ClosestSearch(const ProjectionParts& parts) : parts_(parts) {}

  struct Filter {
    const Vec3* normal = nullptr;  ///< null: every point will do
    double min_cosine = -1;
  };

  /// The nearest point within `reach`; failed if there is none.
  SurfacePoint run(const Vec3& query, double reach, const Filter& filter);

  /// Of all searches so far.
  const ProjectionWork& work() const { return work_; }

 private:
  double give_up_distance() const { return std::min(reach_, best_.key); }
  void visit_cell(Index number);
  bool cone_allows(const PatchCell& cell, Index face) const;
  void search_everywhere(Index number, const Vec2& start, double eigenvalue_change);
  bool offer_general_foot(Index number, const Vec2& start, const ClosestPointSettings& settings);
  void offer_foot(Index number, const Vec2& uv, const PatchPoint& at, double distance);
  bool compatible(const Vec3& normal) const;
  bool exactly_inside(const Candidate& candidate) const;
  void visit_piece(Index number);
  void set_side(const CurveSide& side, double t, SurfacePoint& point) const;
  void finish_border();
  void offer(const Candidate& candidate);

  const ProjectionParts& parts_;
  Vec3 query_ = Vec3::Zero();
  double reach_ = 0;
  Filter filter_;
  Candidate best_;
  bool border_pending_ = false;
  ProjectionWork work_;
  std::array<Candidate, 8> pending_;
  int pending_count_ = 0;
};

}  // namespace flowcage
