#include "core/optimise/slide.hpp"

#include <Eigen/Eigenvalues>

namespace flowcage {
namespace {

void restore_frozen(const PointFreedom& freedom, const Vec3& reference, Vec3& position) {
  for (int a = 0; a < 3; ++a) {
    if ((freedom.frozen_axes >> a & 1) != 0) position[a] = reference[a];
  }
}

/// Moving points (numbers into patch.moving) of each projector.
std::vector<std::vector<Index>> points_by_projector(const SlideContext& context) {
  std::vector<std::vector<Index>> out(context.projectors.size());
  for (std::size_t m = 0; m < context.patch.moving.size(); ++m) {
    const Index projector = context.patch.freedom[context.patch.moving[m]].projector;
    if (projector != no_index) out[projector].push_back(static_cast<Index>(m));
  }
  return out;
}

/// The symmetric matrix with the same eigenvectors and eigenvalues rounded to 0 or 1.
Eigen::Matrix3d nearest_projection(const Eigen::Matrix3d& derivative) {
  const Eigen::Matrix3d symmetric = 0.5 * (derivative + derivative.transpose());
  if (!symmetric.allFinite()) return Eigen::Matrix3d::Zero();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(symmetric);
  Eigen::Matrix3d out = Eigen::Matrix3d::Zero();
  for (int n = 0; n < 3; ++n) {
    if (solver.eigenvalues()[n] <= 0.5) continue;
    out += solver.eigenvectors().col(n) * solver.eigenvectors().col(n).transpose();
  }
  return out;
}

}  // namespace

bool has_projected_points(const HexPatch& patch) {
  return std::any_of(patch.moving.begin(), patch.moving.end(),
                     [&](Index p) { return patch.freedom[p].projector != no_index; });
}

std::vector<Eigen::Matrix3d> tangent_projections(const SlideContext& context, std::span<const Vec3> positions,
                                                 std::span<const double> steps) {
  std::vector<Eigen::Matrix3d> out(context.patch.moving.size(), Eigen::Matrix3d::Identity());
  const std::vector<std::vector<Index>> groups = points_by_projector(context);
  for (std::size_t n = 0; n < groups.size(); ++n) {
    if (groups[n].empty()) continue;
    std::vector<Vec3> queries;
    for (const Index m : groups[n]) {
      for (int s = 0; s < 6; ++s) {
        Vec3 query = positions[context.patch.moving[m]];
        query[s / 2] += s % 2 == 0 ? steps[m] : -steps[m];
        queries.push_back(context.unit * query);
      }
    }
    std::vector<Vec3> feet(queries.size());
    context.projectors[n](queries, feet);
    for (std::size_t g = 0; g < groups[n].size(); ++g) {
      Eigen::Matrix3d derivative;
      for (int a = 0; a < 3; ++a) {
        const std::size_t at = 6 * g + 2 * static_cast<std::size_t>(a);
        derivative.col(a) = (feet[at] - feet[at + 1]) / (queries[at][a] - queries[at + 1][a]);
      }
      out[groups[n][g]] = nearest_projection(derivative);
    }
  }
  for (std::size_t m = 0; m < out.size(); ++m) {
    const PointFreedom& freedom = context.patch.freedom[context.patch.moving[m]];
    Eigen::Matrix3d free_axes = Eigen::Matrix3d::Identity();
    for (int a = 0; a < 3; ++a) {
      if ((freedom.frozen_axes >> a & 1) != 0) free_axes(a, a) = 0;
    }
    if (freedom.frozen_axes == 0) continue;
    out[m] = freedom.projector == no_index ? free_axes : nearest_projection(free_axes * out[m] * free_axes);
    // Rounding in the eigenvectors must not move a frozen coordinate.
    out[m] = free_axes * out[m] * free_axes;
  }
  return out;
}

void project_points(const SlideContext& context, std::span<const Vec3> reference, std::span<Vec3> positions) {
  const std::vector<std::vector<Index>> groups = points_by_projector(context);
  for (std::size_t n = 0; n < groups.size(); ++n) {
    if (groups[n].empty()) continue;
    std::vector<Vec3> queries, feet(groups[n].size());
    // Where a frozen plane meets the surface the two are applied in turn; they settle at their intersection.
    for (int turn = 0; turn < 3; ++turn) {
      queries.clear();
      for (const Index m : groups[n]) queries.push_back(context.unit * positions[context.patch.moving[m]]);
      context.projectors[n](queries, feet);
      bool mixed = false;
      for (std::size_t g = 0; g < feet.size(); ++g) {
        const Index p = context.patch.moving[groups[n][g]];
        mixed = mixed || context.patch.freedom[p].frozen_axes != 0;
        if (!feet[g].allFinite()) feet[g] = queries[g];
        positions[p] = feet[g] / context.unit;
        restore_frozen(context.patch.freedom[p], reference[p], positions[p]);
      }
      if (!mixed) break;
    }
  }
  for (const Index p : context.patch.moving)
    restore_frozen(context.patch.freedom[p], reference[p], positions[p]);
}

}  // namespace flowcage
