#include "core/refit/coverage.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/base/parallel.hpp"

namespace flowcage {
namespace {

using Triangle = std::array<Vec3, 3>;

struct NearPoint {
  double squared_distance = std::numeric_limits<double>::infinity();
  Index face = no_index;
  Vec2 uv = Vec2::Zero();
};

/// Barycentric coordinates of the nearest point of a triangle (Ericson, Real-Time Collision
/// Detection, 5.1.5).
std::array<double, 3> nearest_on_triangle(const Vec3& p, const Triangle& t) {
  const Vec3 ab = t[1] - t[0];
  const Vec3 ac = t[2] - t[0];
  const double d1 = ab.dot(p - t[0]);
  const double d2 = ac.dot(p - t[0]);
  if (d1 <= 0 && d2 <= 0) return {1, 0, 0};
  const double d3 = ab.dot(p - t[1]);
  const double d4 = ac.dot(p - t[1]);
  if (d3 >= 0 && d4 <= d3) return {0, 1, 0};
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) {
    const double v = d1 - d3 > 0 ? d1 / (d1 - d3) : 0;
    return {1 - v, v, 0};
  }
  const double d5 = ab.dot(p - t[2]);
  const double d6 = ac.dot(p - t[2]);
  if (d6 >= 0 && d5 <= d6) return {0, 0, 1};
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) {
    const double w = d2 - d6 > 0 ? d2 / (d2 - d6) : 0;
    return {1 - w, 0, w};
  }
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
    const double w = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    return {0, 1 - w, w};
  }
  const double sum = va + vb + vc;
  return {va / sum, vb / sum, vc / sum};
}

/// The limit mesh: eight triangles a face, the fan round its midpoint of the nine samples of its 3 x 3 grid.
class FaceFans {
 public:
  explicit FaceFans(const MeasuredSurface& surface) : level_(surface.level), samples_(surface.samples) {}

  // The grid's rim from corner 0: corner, edge, corner, edge, ...
  static constexpr int rim_size = 8;
  static Vec2 rim_uv(int i) {
    constexpr std::array u{0., .5, 1., 1., 1., .5, 0., 0.}, v{0., 0., 0., .5, 1., 1., 1., .5};
    return {u[i], v[i]};
  }
  const Vec3& rim(Index f, int i) const {
    return samples_[i % 2 == 0 ? level_.face_vertices[f][i / 2]
                               : level_.vertex_count() + level_.face_edges[f][i / 2]];
  }
  const Vec3& middle(Index f) const { return samples_[level_.vertex_count() + level_.edge_count() + f]; }
  Index size() const { return level_.face_count(); }

 private:
  const SurfaceLevel& level_;
  const std::vector<Vec3>& samples_;
};

/// A box tree over the faces' fans; the nearest points on several different faces.
class FanTree {
 public:
  explicit FanTree(const FaceFans& fans) : fans_(fans) {
    order_.resize(static_cast<std::size_t>(fans.size()));
    std::iota(order_.begin(), order_.end(), 0);
    nodes_.reserve(2 * order_.size());
    build(0, fans.size());
  }

  static constexpr std::size_t kept = 3;

  /// The nearest points of up to three faces, nearest first.
  std::array<NearPoint, kept> nearest(const Vec3& query) const {
    std::array<NearPoint, kept> best;
    std::vector<std::pair<double, Index>> stack{{nodes_[0].box.squaredExteriorDistance(query), 0}};
    while (!stack.empty()) {
      const auto [distance, number] = stack.back();
      stack.pop_back();
      if (distance >= best.back().squared_distance) continue;
      const Node& node = nodes_[number];
      if (node.right == no_index) {
        for (Index i = node.begin; i < node.end; ++i) visit(query, order_[i], best);
        continue;
      }
      const Index left = number + 1;
      const double to_left = nodes_[left].box.squaredExteriorDistance(query);
      const double to_right = nodes_[node.right].box.squaredExteriorDistance(query);
      if (to_left < to_right) {
        stack.emplace_back(to_right, node.right);
        stack.emplace_back(to_left, left);
      } else {
        stack.emplace_back(to_left, left);
        stack.emplace_back(to_right, node.right);
      }
    }
    return best;
  }

 private:
  struct Node {
    Box3 box;
    Index begin = 0, end = 0;
    Index right = no_index;  ///< the left child follows its parent
  };

  Index build(Index begin, Index end) {
    const Index number = static_cast<Index>(nodes_.size());
    nodes_.emplace_back();
    Box3 box, centres;
    for (Index i = begin; i < end; ++i) {
      for (int k = 0; k < FaceFans::rim_size; ++k) box.extend(fans_.rim(order_[i], k));
      box.extend(fans_.middle(order_[i]));
      centres.extend(fans_.middle(order_[i]));
    }
    nodes_[number].box = box;
    nodes_[number].begin = begin;
    nodes_[number].end = end;
    if (end - begin > 1) {
      int axis = 0;
      centres.sizes().maxCoeff(&axis);
      const Index middle = begin + (end - begin) / 2;
      std::nth_element(order_.begin() + begin, order_.begin() + middle, order_.begin() + end,
                       [&](Index a, Index b) {
                         const double x = fans_.middle(a)[axis];
                         const double y = fans_.middle(b)[axis];
                         return x != y ? x < y : a < b;
                       });
      build(begin, middle);
      const Index right = build(middle, end);
      nodes_[number].right = right;
    }
    return number;
  }

  void visit(const Vec3& query, Index face, std::array<NearPoint, kept>& best) const {
    NearPoint found;
    for (int i = 0; i < FaceFans::rim_size; ++i) {
      const int j = (i + 1) % FaceFans::rim_size;
      const Triangle t{fans_.middle(face), fans_.rim(face, i), fans_.rim(face, j)};
      const auto w = nearest_on_triangle(query, t);
      const double squared = (w[0] * t[0] + w[1] * t[1] + w[2] * t[2] - query).squaredNorm();
      if (!(squared < found.squared_distance)) continue;
      found = {squared, face, w[0] * Vec2(.5, .5) + w[1] * FaceFans::rim_uv(i) + w[2] * FaceFans::rim_uv(j)};
    }
    std::size_t last = kept - 1;
    if (!(found.squared_distance < best[last].squared_distance)) return;
    best[last] = found;
    for (std::size_t i = last; i > 0 && best[i].squared_distance < best[i - 1].squared_distance; --i) {
      std::swap(best[i], best[i - 1]);
    }
  }

  const FaceFans& fans_;
  std::vector<Index> order_;
  std::vector<Node> nodes_;
};

/// Gauss-Newton for the nearest point of the exact limit surface, from a start on the limit mesh. Stays in
/// one face; leaves over an edge into the neighbour at the same place.
class LimitDistance {
 public:
  explicit LimitDistance(const MeasuredSurface& surface) : surface_(surface), level_(surface.level) {}

  double refine(const Vec3& query, Index face, Vec2 uv) const {
    double best = std::numeric_limits<double>::infinity();
    for (int hop = 0; hop < 4; ++hop) {
      const double before = best;
      int side = descend(query, face, uv, best);
      if (side < 0 || !(best < before)) break;
      const Index edge = level_.face_edges[face][side];
      const auto& faces = level_.edge_faces[edge];
      const Index next = faces[0] == face ? faces[1] : faces[0];
      if (next == no_index) break;
      // Along side k the place runs from corner k (t = 0) to corner k + 1; the neighbour has it reversed.
      const double t = side_parameter(side, uv);
      const auto edges = level_.face_edges[next];
      const int other = static_cast<int>(std::find(edges.begin(), edges.end(), edge) - edges.begin());
      uv = side_point(other, 1 - t);
      face = next;
    }
    return best;
  }

 private:
  static double side_parameter(int side, const Vec2& uv) {
    switch (side) {
      case 0:
        return uv.x();
      case 1:
        return uv.y();
      case 2:
        return 1 - uv.x();
      default:
        return 1 - uv.y();
    }
  }
  static Vec2 side_point(int side, double t) {
    switch (side) {
      case 0:
        return {t, 0};
      case 1:
        return {1, t};
      case 2:
        return {1 - t, 1};
      default:
        return {0, 1 - t};
    }
  }

  /// Steps within the unit square; returns the side that the last step wanted to leave by, or -1.
  int descend(const Vec3& query, Index face, Vec2& uv, double& best) const {
    int side = -1;
    for (int step = 0; step < 12; ++step) {
      const LimitPoint p = surface_.at({face, uv.x(), uv.y(), 0});
      const Vec3 r = query - p.position;
      best = std::min(best, r.norm());
      const double a = p.du.squaredNorm();
      const double b = p.du.dot(p.dv);
      const double c = p.dv.squaredNorm();
      const Vec2 g(p.du.dot(r), p.dv.dot(r));
      const double det = a * c - b * b;
      Vec2 move = Vec2::Zero();
      if (det > 1e-12 * a * c) {
        move = Vec2(c * g.x() - b * g.y(), a * g.y() - b * g.x()) / det;
      } else if (a + c > 0) {
        move = g / (a + c);
      }
      if (!move.allFinite()) return -1;
      move = move.cwiseMax(-0.5).cwiseMin(0.5);
      Vec2 next = (uv + move).cwiseMax(0.0).cwiseMin(1.0);
      // On a side that holds the step back the other direction is a problem of its own.
      if (next.x() != uv.x() + move.x() && (uv.x() == 0 || uv.x() == 1) && c > 0) {
        next = Vec2(uv.x(), std::clamp(uv.y() + std::clamp(g.y() / c, -0.5, 0.5), 0.0, 1.0));
      } else if (next.y() != uv.y() + move.y() && (uv.y() == 0 || uv.y() == 1) && a > 0) {
        next = Vec2(std::clamp(uv.x() + std::clamp(g.x() / a, -0.5, 0.5), 0.0, 1.0), uv.y());
      }
      side = -1;
      if (uv.y() == 0 && g.y() < 0) side = 0;
      if (uv.x() == 1 && g.x() > 0) side = 1;
      if (uv.y() == 1 && g.y() > 0) side = 2;
      if (uv.x() == 0 && g.x() < 0) side = 3;
      const double moved = (next - uv).norm();
      if (moved < 1e-9) break;
      uv = next;
    }
    return side;
  }

  const MeasuredSurface& surface_;
  const SurfaceLevel& level_;
};

std::vector<Vec3> target_samples(const TargetSurface& target, Index max_samples) {
  const Tessellation& mesh = target.tessellation();
  const Offset total = static_cast<Offset>(mesh.points.size() + mesh.triangles.size());
  const Offset stride = std::max<Offset>(1, (total + max_samples - 1) / std::max<Index>(max_samples, 1));
  std::vector<Vec3> samples;
  for (std::size_t i = 0; i < mesh.points.size(); i += static_cast<std::size_t>(stride)) {
    samples.push_back(mesh.points[i]);
  }
  std::vector<Vec3> middles;
  for (std::size_t i = 0; i < mesh.triangles.size(); i += static_cast<std::size_t>(stride)) {
    const auto& t = mesh.triangles[i];
    middles.push_back((mesh.points[t[0]] + mesh.points[t[1]] + mesh.points[t[2]]) / 3);
  }
  std::vector<SurfacePoint> feet(middles.size());
  target.closest_points(middles, {}, feet);
  for (const SurfacePoint& foot : feet) {
    if (foot.status != FootStatus::failed) samples.push_back(foot.position);
  }
  return samples;
}

}  // namespace

Coverage measure_coverage(MeasuredSurface& surface, const TargetSurface& target, Index max_samples) {
  surface.prepare_evaluation();
  const FaceFans fans(surface);
  const FanTree tree(fans);
  const LimitDistance exact(surface);
  const std::vector<Vec3> samples = target_samples(target, max_samples);
  std::vector<double> distances(samples.size());
  parallel_for(static_cast<Offset>(samples.size()), 64, [&](Offset begin, Offset end) {
    for (Offset i = begin; i < end; ++i) {
      double best = std::numeric_limits<double>::infinity();
      for (const NearPoint& start : tree.nearest(samples[i])) {
        if (start.face == no_index) continue;
        best = std::min(best, exact.refine(samples[i], start.face, start.uv));
      }
      distances[i] = best;
    }
  });
  Coverage coverage;
  coverage.samples = static_cast<Index>(samples.size());
  double sum = 0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    sum += distances[i] * distances[i];
    if (distances[i] > coverage.max_distance) {
      coverage.max_distance = distances[i];
      coverage.worst_place = samples[i];
    }
  }
  if (!samples.empty()) coverage.rms_distance = std::sqrt(sum / static_cast<double>(samples.size()));
  return coverage;
}

}  // namespace flowcage
