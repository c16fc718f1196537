#include "core/limit/corner_cells.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <numbers>

#include "core/base/parallel.hpp"
#include "core/limit/quad_blocks.hpp"
#include "core/subdivide/masks.hpp"

namespace flowcage {
namespace {

using Net = std::vector<Vec3>;  // 16 points, as CornerCell::bezier
using Cubic = std::array<double, 4>;

Cubic bernstein(double t) {
  const double s = 1 - t;
  return {s * s * s, 3 * s * s * t, 3 * s * t * t, t * t * t};
}
Cubic bernstein_slope(double t) {
  const double s = 1 - t;
  return {-3 * s * s, 3 * s * s - 6 * s * t, 6 * s * t - 3 * t * t, 3 * t * t};
}

Vec3 combine(const Net& net, const Cubic& a, const Cubic& b) {
  Vec3 sum = Vec3::Zero();
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < 4; ++j) sum += a[i] * b[j] * net[4 * i + j];
  }
  return sum;
}

// Bezier points of the cubic through values at 0, 1/3, 2/3, 1.
std::array<Vec3, 4> bezier_through(const Vec3& p0, const Vec3& p1, const Vec3& p2, const Vec3& p3) {
  return {p0, (-5 * p0 + 18 * p1 - 9 * p2 + 2 * p3) / 6, (2 * p0 - 9 * p1 + 18 * p2 - 5 * p3) / 6, p3};
}

double angle_degrees(const Vec3& a, const Vec3& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b)) * 180 / std::numbers::pi;
}

// The cells of one vertex.
class VertexCells {
 public:
  VertexCells(const SurfaceLevel& level, const LimitEvaluator& evaluator, std::span<const Vec3> points,
              const std::vector<char>& irregular, Index vertex)
      : evaluator_(evaluator), points_(points) {
    const auto edges = level.vertex_edges[vertex];
    const auto faces = level.vertex_faces[vertex];
    std::vector<double> sharpness;
    for (const Index e : edges) sharpness.push_back(level.edge_sharpness[e]);
    rule_ = vertex_rule(level.vertex_sharpness[vertex], sharpness);
    for (std::size_t k = 0; k < faces.size(); ++k) {
      const auto row = level.face_vertices[faces[k]];
      const Index corner = static_cast<Index>(std::find(row.begin(), row.end(), vertex) - row.begin());
      const Offset slot = level.face_vertices.offsets[faces[k]] + corner;
      if (!irregular[slot]) continue;
      // Face k lies between edges k (along a) and k + 1 (along b).
      cells_.push_back(
          {slot, {faces[k], corner}, sharpness[k] > 0, sharpness[(k + 1) % edges.size()] > 0, {}});
      // The face that shares this one's b edge follows; the last of a closed ring meets the first.
      const std::size_t next = (k + 1) % faces.size();
      const bool closed_or_inside = k + 1 < faces.size() || faces.size() == edges.size();
      if (!cells_.back().sharp_b && closed_or_inside) neighbours_.push_back({faces[k], faces[next]});
    }
  }

  struct Misfit {
    double angle = 0, deviation = 0;
  };
  Misfit fit(int depth) {
    Misfit misfit;
    for (Entry& entry : cells_) {
      entry.cell.depth = depth;
      entry.cell.bezier = net_of(entry, entry.cell.size());
      for (const double a : {0.0, 0.25, 0.5, 0.75}) {
        for (const double b : {0.0, 0.25, 0.5, 0.75}) {
          const Vec2 ab = entry.cell.size() * Vec2(a, b);
          misfit.deviation = std::max(misfit.deviation, distance_to_limit(evaluator_, points_, entry.at, ab,
                                                                          entry.cell.position(ab)));
        }
      }
    }
    for (const auto& [face, next] : neighbours_) {
      const Net& left = net_at(face);
      const Net& right = net_at(next);
      constexpr int steps = 16;
      for (int k = 0; k <= steps; ++k) {
        const double t = static_cast<double>(k) / steps;
        // The curve is the first one's b = t and the second one's a = t.
        const Cubic start = bernstein(0), slope = bernstein_slope(0), at = bernstein(t),
                    by = bernstein_slope(t);
        const Vec3 normal = combine(left, slope, at).cross(combine(left, start, by));
        const Vec3 other = combine(right, by, start).cross(combine(right, at, slope));
        misfit.angle = std::max(misfit.angle, angle_degrees(normal, other));
      }
    }
    return misfit;
  }

  void store(std::vector<CornerCell>& cells) const {
    for (const Entry& entry : cells_) cells[entry.slot] = entry.cell;
  }

 private:
  struct Entry {
    Offset slot;
    FaceCorner at;
    bool sharp_a, sharp_b;  // the edges that bound it
    CornerCell cell;
  };

  const Net& net_at(Index face) const {
    return std::find_if(cells_.begin(), cells_.end(), [&](const Entry& e) { return e.at.face == face; })
        ->cell.bezier;
  }
  LimitPoint limit(const Entry& entry, double a, double b) const {
    return evaluate_at_corner(evaluator_, points_, entry.at, Vec2(a, b));
  }

  // The bicubic tile of the limit surface at (a,b), of the cell's size.
  Net tile(const Entry& entry, const Vec2& from, double size) const {
    Net net(16);
    for (int i = 0; i < 4; ++i) {
      std::array<Vec3, 4> p;
      for (int j = 0; j < 4; ++j) {
        p[j] = limit(entry, from.x() + size * i / 3, from.y() + size * j / 3).position;
      }
      const std::array<Vec3, 4> row = bezier_through(p[0], p[1], p[2], p[3]);
      std::copy(row.begin(), row.end(), net.begin() + 4 * i);
    }
    for (int j = 0; j < 4; ++j) {
      const std::array<Vec3, 4> column = bezier_through(net[j], net[4 + j], net[8 + j], net[12 + j]);
      for (int i = 0; i < 4; ++i) net[4 * i + j] = column[i];
    }
    return net;
  }

  Net net_of(const Entry& entry, double size) const {
    Net net(16);
    const Net right = tile(entry, {size, 0}, size), top = tile(entry, {0, size}, size);
    for (int k = 0; k < 4; ++k) {
      net[12 + k] = right[k];
      net[8 + k] = 2 * right[k] - right[4 + k];
    }
    for (int k = 0; k < 2; ++k) {
      net[4 * k + 3] = top[4 * k];
      net[4 * k + 2] = 2 * top[4 * k] - top[4 * k + 1];
    }
    const LimitPoint vertex = limit(entry, 0, 0);
    net[0] = vertex.position;
    net[4] = curve_point(entry, size, true, vertex, net[8], net[12]);
    net[1] = curve_point(entry, size, false, vertex, net[2], net[3]);
    net[5] = inner_point(entry, size, net);
    return net;
  }

  // The second Bezier point of the curve along a or b.
  Vec3 curve_point(const Entry& entry, double size, bool along_a, const LimitPoint& vertex, const Vec3& third,
                   const Vec3& last) const {
    const auto on_curve = [&](double t) {
      return along_a ? limit(entry, size * t, 0).position : limit(entry, 0, size * t).position;
    };
    const bool sharp = along_a ? entry.sharp_a : entry.sharp_b;
    if (sharp && rule_ != VertexRule::dart) {  // a cubic
      return bezier_through(vertex.position, on_curve(1.0 / 3), on_curve(2.0 / 3), last)[1];
    }
    Vec3 sum = Vec3::Zero();
    double weight = 0;
    for (const double t : {0.25, 0.5, 0.75}) {
      const Cubic b = bernstein(t);
      sum += b[1] * (on_curve(t) - b[0] * vertex.position - b[2] * third - b[3] * last);
      weight += b[1] * b[1];
    }
    Vec3 point = sum / weight;
    const Vec3 normal = vertex.du.normalized().cross(vertex.dv.normalized());
    if (rule_ != VertexRule::corner && normal.norm() > 1e-10) {
      const Vec3 n = normal.normalized();
      point -= n * n.dot(point - vertex.position);
    }
    return point;
  }

  Vec3 inner_point(const Entry& entry, double size, const Net& net) const {
    Net known = net;
    known[5] = Vec3::Zero();
    Eigen::Matrix3d normal_matrix = Eigen::Matrix3d::Zero();
    Vec3 right_side = Vec3::Zero();
    for (const double a : {0.25, 0.5, 0.75}) {
      for (const double b : {0.25, 0.5, 0.75}) {
        const Cubic wa = bernstein(a), wb = bernstein(b);
        const double weight = wa[1] * wb[1];
        normal_matrix += weight * weight * Eigen::Matrix3d::Identity();
        right_side += weight * (limit(entry, size * a, size * b).position - combine(known, wa, wb));
      }
    }
    // Cross derivatives in the limit's tangent planes: n . (x weight + the rest) = 0.
    constexpr double tangency = 100;  // squared, against positions
    const Cubic start = bernstein(0), slope = bernstein_slope(0);
    for (const bool along_a : {true, false}) {
      if (along_a ? entry.sharp_a : entry.sharp_b) continue;
      for (const double t : {0.2, 0.4, 0.6, 0.8}) {
        const LimitPoint p = along_a ? limit(entry, size * t, 0) : limit(entry, 0, size * t);
        const Cubic at = bernstein(t), by = bernstein_slope(t);
        const Vec3 along = along_a ? combine(known, by, start) : combine(known, start, by);
        const Vec3 rest = along_a ? combine(known, at, slope) : combine(known, slope, at);
        Vec3 n = p.du.cross(p.dv).normalized();
        n = (n - along * (n.dot(along) / along.squaredNorm())).normalized();  // shared by both sides
        const double weight = at[1] * slope[1];
        normal_matrix += tangency * weight * weight * n * n.transpose();
        right_side -= tangency * weight * n.dot(rest) * n;
      }
    }
    return normal_matrix.inverse() * right_side;
  }

  const LimitEvaluator& evaluator_;
  std::span<const Vec3> points_;
  VertexRule rule_ = VertexRule::smooth;
  std::vector<Entry> cells_;
  std::vector<std::array<Index, 2>> neighbours_;  // faces that share the first one's b edge
};

}  // namespace

LimitPoint evaluate_at_corner(const LimitEvaluator& evaluator, std::span<const Vec3> points,
                              const FaceCorner& at, const Vec2& ab) {
  const double a = ab.x(), b = ab.y();
  switch (at.corner) {
    case 0:
      return evaluator.evaluate(points, {at.face, a, b});
    case 1: {
      const LimitPoint p = evaluator.evaluate(points, {at.face, 1 - b, a});
      return {p.position, p.dv, -p.du};
    }
    case 2: {
      const LimitPoint p = evaluator.evaluate(points, {at.face, 1 - a, 1 - b});
      return {p.position, -p.du, -p.dv};
    }
    default: {
      const LimitPoint p = evaluator.evaluate(points, {at.face, b, 1 - a});
      return {p.position, -p.dv, p.du};
    }
  }
}

double CornerCell::size() const {
  return std::ldexp(1.0, -depth);
}
Vec3 CornerCell::position(const Vec2& ab) const {
  return combine(bezier, bernstein(ab.x() / size()), bernstein(ab.y() / size()));
}

double distance_to_limit(const LimitEvaluator& evaluator, std::span<const Vec3> points, const FaceCorner& at,
                         Vec2 ab, const Vec3& p) {
  double best = std::numeric_limits<double>::max();
  for (int pass = 0; pass < 4; ++pass) {
    const LimitPoint q = evaluate_at_corner(evaluator, points, at, ab);
    const Vec3 off = p - q.position;
    best = std::min(best, off.norm());
    const double uu = q.du.squaredNorm(), uv = q.du.dot(q.dv), vv = q.dv.squaredNorm();
    const double determinant = uu * vv - uv * uv;
    if (!(determinant > 1e-12 * uu * vv)) break;
    const double u = q.du.dot(off), v = q.dv.dot(off);
    ab += Vec2(vv * u - uv * v, uu * v - uv * u) / determinant;
    ab = ab.cwiseMax(0).cwiseMin(1);
  }
  return best;
}

std::vector<CornerCell> fit_corner_cells(const SurfaceLevel& level, const LimitEvaluator& evaluator,
                                         std::span<const Vec3> points, const CornerCellSettings& settings) {
  assert(static_cast<Index>(points.size()) == level.vertex_count());
  const std::vector<char> irregular = irregular_corners(level);
  std::vector<Index> vertices;
  for (std::size_t slot = 0; slot < irregular.size(); ++slot) {
    if (irregular[slot]) vertices.push_back(level.face_vertices.values[slot]);
  }
  std::sort(vertices.begin(), vertices.end());
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());

  std::vector<CornerCell> cells(irregular.size());
  parallel_for(static_cast<Offset>(vertices.size()), 1, [&](Offset begin, Offset end) {
    for (Offset i = begin; i < end; ++i) {
      VertexCells vertex(level, evaluator, points, irregular, vertices[i]);
      int best_depth = 0;
      double best = std::numeric_limits<double>::max();
      for (int depth = 2; depth <= settings.max_depth && best > 1; ++depth) {
        const VertexCells::Misfit misfit = vertex.fit(depth);
        const double ratio =
            std::max(misfit.angle / settings.max_angle_degrees, misfit.deviation / settings.max_deviation);
        if (ratio < best) {
          best = ratio;
          best_depth = depth;
        }
      }
      vertex.fit(best_depth);
      vertex.store(cells);
    }
  });
  return cells;
}

}  // namespace flowcage
