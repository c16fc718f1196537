#include "core/refit/unfold.hpp"

#include <algorithm>
#include <array>
#include <utility>

namespace flowcage {
namespace {

constexpr int most_sweeps = 200;
constexpr double least_sine = 0.05;
/// No vertex moves further for one corner than this share of the corner's shorter side.
constexpr double most_way = 0.25;

using Quad = std::array<Index, 4>;  // samples

/// The faces, and those that share a vertex with one: what moves there may fold here.
std::vector<Index> with_neighbours(const SurfaceLevel& t, const std::vector<Index>& faces) {
  std::vector<Index> all;
  for (const Index face : faces) {
    for (const Index corner : t.face_vertices[face]) {
      for (const Index f : t.vertex_faces[corner]) all.push_back(f);
    }
  }
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  return all;
}

class Unfolding {
 public:
  Unfolding(const LevelSystem& level, const FitPass& pass)
      : level_(level), pass_(pass), points_(pass.control_points) {}

  std::vector<Vec3> run() {
    std::vector<std::pair<Quad, Vec3>> watched;  // with the target's normal
    for (const Index f : with_neighbours(level_.topology, pass_.folded)) {
      const Index middle = level_.face_sample(f);
      const bool known = pass_.feet[middle].status != FootStatus::failed;
      const Vec3 wanted = known ? pass_.feet[middle].normal : pass_.limit.normals[middle];
      for (std::size_t i = 0; i < level_.topology.face_vertices[f].size(); ++i) {
        watched.emplace_back(level_.sample_quad(f, i), wanted);
      }
    }
    for (int sweep = 0; sweep < most_sweeps; ++sweep) {
      bool moved = false;
      for (const auto& [quad, wanted] : watched) {
        for (int k = 0; k < 4; ++k) moved = open_corner(quad, k, wanted) || moved;
      }
      if (!moved) break;
    }
    return std::move(points_);
  }

 private:
  Vec3 limit_point(Index sample) const {
    const StencilTable& rows = level_.samples.position;
    Vec3 sum = Vec3::Zero();
    for (Offset k = rows.offsets[sample]; k < rows.offsets[sample + 1]; ++k) {
      sum += rows.term_weights(k).cwiseProduct(points_[rows.indices[k]]);
    }
    return sum;
  }

  /// One projection; false where the corner is open, or nothing that may move bears on it.
  bool open_corner(const Quad& quad, int k, const Vec3& wanted) {
    std::array<Vec3, 4> q;
    for (int i = 0; i < 4; ++i) q[i] = limit_point(quad[i]);
    const Vec3 across = (q[2] - q[0]).cross(q[3] - q[1]);
    const Vec3 n = across.dot(wanted) > 0 ? across.normalized() : wanted;
    const Vec3 next = q[(k + 1) % 4] - q[k], last = q[(k + 3) % 4] - q[k];
    const double area = next.norm() * last.norm();
    const double missing = least_sine * area - next.cross(last).dot(n);
    if (!(missing > 1e-3 * least_sine * area)) return false;

    const Vec3 by_next = last.cross(n), by_last = n.cross(next);
    gradient_.clear();
    add_row(quad[(k + 1) % 4], by_next);
    add_row(quad[(k + 3) % 4], by_last);
    add_row(quad[k], -by_next - by_last);
    double squared = 0, longest = 0;
    for (const auto& [v, g] : gradient_) {
      squared += g.squaredNorm();
      longest = std::max(longest, g.norm());
    }
    if (!(squared > 0)) return false;
    const double shorter = std::min(next.norm(), last.norm());
    const double step = std::min(missing / squared, most_way * shorter / longest);
    for (const auto& [v, g] : gradient_) points_[v] += step * g;
    return true;
  }

  void add_row(Index sample, const Vec3& by_point) {
    const StencilTable& rows = level_.samples.position;
    for (Offset k = rows.offsets[sample]; k < rows.offsets[sample + 1]; ++k) {
      const Index v = rows.indices[k];
      if (level_.vertex_stage[v] != SolveStage::interior) continue;
      const Vec3 g = rows.term_weights(k).cwiseProduct(by_point);
      const auto found = std::find_if(gradient_.begin(), gradient_.end(),
                                      [&](const auto& entry) { return entry.first == v; });
      if (found == gradient_.end()) {
        gradient_.emplace_back(v, g);
      } else {
        found->second += g;
      }
    }
  }

  const LevelSystem& level_;
  const FitPass& pass_;
  std::vector<Vec3> points_;
  std::vector<std::pair<Index, Vec3>> gradient_;  // of the corner at hand
};

}  // namespace

std::vector<Vec3> unfolded_points(const LevelSystem& level, const FitPass& pass) {
  return Unfolding(level, pass).run();
}

}  // namespace flowcage
