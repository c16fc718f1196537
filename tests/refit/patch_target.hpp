// A target of untrimmed parametric patches with chains given by functions: wings in closed form, without a
// CAD kernel. Slow and plain: a grid of starts a patch and Newton's method from the nearest three.
#pragma once
#include <functional>
#include <memory>

#include "core/target/target_surface.hpp"
#include "tests/refit/hand_drawn_cages.hpp"

namespace flowcage::test {

using PatchFunction = std::function<Vec3(double u, double v)>;  // on [0, 1]^2; S_u x S_v toward the fluid
using CurveFunction = std::function<Vec3(double t)>;            // on [0, 1]

struct ChainOfTarget {
  ChainKind kind = ChainKind::sharp;
  Index start = no_index, end = no_index;
  CurveFunction curve;
};

class PatchTarget final : public TargetSurface {
 public:
  PatchTarget(std::vector<PatchFunction> patches, std::vector<Vec3> corners,
              std::vector<ChainOfTarget> chains);
  ~PatchTarget() override;

  void closest_points(std::span<const Vec3> queries, std::span<const SurfacePoint> hints,
                      std::span<SurfacePoint> results) const override;
  void closest_compatible(std::span<const Vec3> queries, std::span<const Vec3> normals, double min_cosine,
                          double max_distance, std::span<SurfacePoint> results) const override;
  void intersect_lines(std::span<const Vec3> queries, std::span<const Vec3> directions, double min_cosine,
                       double max_distance, std::span<SurfacePoint> results) const override;
  const FeatureGraph& features() const override { return graph_; }
  CurvePoint chain_point(Index chain, double s) const override;
  CurvePoint closest_on_chain(Index chain, const Vec3& query) const override;
  const Tessellation& tessellation() const override { return tessellation_; }
  Index face_count() const override { return static_cast<Index>(patches_.size()); }
  std::string face_name(Index) const override { return ""; }
  Box3 bounds() const override { return bounds_; }

 private:
  struct Patch;
  struct Starts {
    std::vector<Vec2> uv;
    std::vector<Vec3> points;
  };
  std::vector<SurfacePoint> local_minima(const Vec3& query) const;
  SurfacePoint point_on(Index patch, const Vec2& uv, const Vec3& query) const;

  std::vector<std::unique_ptr<Patch>> patches_;
  std::vector<Starts> starts_;
  FeatureGraph graph_;
  std::vector<ChainOfTarget> curves_;
  Tessellation tessellation_;
  Box3 bounds_;
};

enum class TipShape { flat, rounded };

/// The half wing that wing_cage draws: NACA 00xx sections, ruled, root open in y = 0. A rounded tip is half a
/// body of revolution of the tip section about its chord line (sharp trailing edge only).
std::unique_ptr<PatchTarget> wing_target(const WingCageShape& wing, TipShape tip);

}  // namespace flowcage::test
