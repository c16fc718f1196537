#include "core/limit/corner_cells.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/base/parallel.hpp"
#include "core/limit/quad_blocks.hpp"
#include "core/mesh/mirror.hpp"
#include "core/subdivide/masks.hpp"

namespace flowcage {
namespace {

// A cell's splines along a and b: cubics on `segments` equal parts of [0,1], C1 where they meet. Their
// control points are c_0; the two inner Bezier points of each part; c_last. Where two parts meet the Bezier
// point is the mean of its neighbours.
constexpr int segments = CornerCell::segments, count = CornerCell::count, last = count - 1;
using Net = std::vector<Vec3>;          // count x count, as CornerCell::net
using Row = std::array<double, count>;  // weights of control points

void add_bezier(const std::array<double, 4>& bezier, int segment, Row& row) {
  row[2 * segment + 1] += bezier[1];
  row[2 * segment + 2] += bezier[2];
  const double start = segment == 0 ? 1 : 0.5, end = segment == segments - 1 ? 1 : 0.5;
  row[2 * segment] += start * bezier[0];
  if (segment > 0) row[2 * segment + 1] += start * bezier[0];
  row[2 * segment + 3] += end * bezier[3];
  if (segment < segments - 1) row[2 * segment + 2] += end * bezier[3];
}
struct Part {
  int segment;
  double t;
};
Part part_of(double x) {
  const int segment = std::clamp(static_cast<int>(x * segments), 0, segments - 1);
  return {segment, x * segments - segment};
}
Row value_row(double x) {
  const auto [segment, t] = part_of(x);
  const double s = 1 - t;
  Row row{};
  add_bezier({s * s * s, 3 * s * s * t, 3 * s * t * t, t * t * t}, segment, row);
  return row;
}
Row slope_row(double x) {
  const auto [segment, t] = part_of(x);
  const double s = 1 - t;
  Row row{};
  add_bezier({-3 * s * s, 3 * s * s - 6 * s * t, 6 * s * t - 3 * t * t, 3 * t * t}, segment, row);
  for (double& weight : row) weight *= segments;
  return row;
}

Vec3 combine(const Net& net, const Row& a, const Row& b) {
  Vec3 sum = Vec3::Zero();
  for (int i = 0; i < count; ++i) {
    if (a[i] == 0) continue;
    for (int j = 0; j < count; ++j) {
      if (b[j] != 0) sum += a[i] * b[j] * net[count * i + j];
    }
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
  VertexCells(const SurfaceLevel& level, const MirrorExtension& extension, const LimitEvaluator& evaluator,
              std::span<const Vec3> points, const std::vector<char>& irregular, Index vertex)
      : evaluator_(evaluator), points_(points) {
    const auto edges = extension.level().vertex_edges[vertex];
    const auto faces = extension.level().vertex_faces[vertex];
    std::vector<double> sharpness;
    for (const Index e : edges) sharpness.push_back(extension.level().edge_sharpness[e]);
    rule_ = vertex_rule(level.vertex_sharpness[vertex], sharpness);
    for (std::size_t k = 0; k < faces.size(); ++k) {
      if (!extension.is_own_face(faces[k])) continue;
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
      if (!cells_.back().sharp_b && closed_or_inside && extension.is_own_face(faces[next]))
        neighbours_.push_back({faces[k], faces[next]});
    }
  }

  bool pointed() const { return rule_ == VertexRule::corner; }

  struct Misfit {
    double angle = 0, deviation = 0;
  };
  // With or without conditions on the tangent planes along shared curves.
  Misfit fit(int depth, bool tangent_planes) {
    tangency_ = tangent_planes ? 1e4 : 0;
    Misfit misfit;
    for (Entry& entry : cells_) {
      entry.cell.depth = depth;
      entry.cell.pointed = pointed();
      entry.cell.net = net_of(entry, entry.cell.size());
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
      constexpr int steps = 12 * segments;
      for (int k = 0; k <= steps; ++k) {
        const double t = static_cast<double>(k) / steps;
        // The curve is the first one's b = t and the second one's a = t.
        const Row start = value_row(0), slope = slope_row(0), at = value_row(t), by = slope_row(t);
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
        ->cell.net;
  }
  LimitPoint limit(const Entry& entry, double a, double b) const {
    return evaluate_at_corner(evaluator_, points_, entry.at, Vec2(a, b));
  }

  // The Bezier points, [4 i + j], of the bicubic tile of the limit surface at `from`.
  std::array<Vec3, 16> tile(const Entry& entry, const Vec2& from, const Vec2& size) const {
    std::array<Vec3, 16> net;
    for (int i = 0; i < 4; ++i) {
      std::array<Vec3, 4> p;
      for (int j = 0; j < 4; ++j) {
        p[j] = limit(entry, from.x() + size.x() * i / 3, from.y() + size.y() * j / 3).position;
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
    Net net(static_cast<std::size_t>(count * count), Vec3::Zero());
    const double part = size / segments;
    // The outer two rows each way continue the tiles beyond, C1: first the rows at a = size, then at b =
    // size.
    for (const bool beyond_a : {true, false}) {
      for (int k = 0; k < segments; ++k) {
        const auto bezier = beyond_a ? tile(entry, {size, k * part}, {size, part})
                                     : tile(entry, {k * part, size}, {part, size});
        const auto set = [&](int along, int m) {
          const Vec3& at = bezier[beyond_a ? m : 4 * m];
          const Vec3& next = bezier[beyond_a ? 4 + m : 4 * m + 1];
          net[beyond_a ? count * last + along : count * along + last] = at;
          net[beyond_a ? count * (last - 1) + along : count * along + last - 1] = at - (next - at) / segments;
        };
        if (k == 0) set(0, 0);
        set(2 * k + 1, 1);
        set(2 * k + 2, 2);
        if (k == segments - 1) set(last, 3);
      }
    }
    const LimitPoint vertex = limit(entry, 0, 0);
    net[0] = vertex.position;
    for (const bool along_a : {true, false}) set_curve(entry, size, along_a, vertex, net);
    set_inner_points(entry, size, vertex, net);
    return net;
  }

  // The free points of the curve along a or b.
  void set_curve(const Entry& entry, double size, bool along_a, const LimitPoint& vertex, Net& net) const {
    const auto point = [&](int k) -> Vec3& { return net[along_a ? count * k : k]; };
    const auto on_curve = [&](double t) {
      return along_a ? limit(entry, size * t, 0).position : limit(entry, 0, size * t).position;
    };
    const bool sharp = along_a ? entry.sharp_a : entry.sharp_b;
    if (sharp && rule_ != VertexRule::dart) {  // a cubic
      for (int k = 0; k < segments; ++k) {
        const auto at = [&](int third) { return on_curve((k + third / 3.0) / segments); };
        const std::array<Vec3, 4> bezier = bezier_through(at(0), at(1), at(2), at(3));
        if (2 * k + 1 < last - 1) point(2 * k + 1) = bezier[1];
        if (2 * k + 2 < last - 1) point(2 * k + 2) = bezier[2];
      }
      return;
    }
    // Least squares for points first .. last - 2, the others given.
    const auto solve = [&](int first) {
      const int free = last - 1 - first;
      if (free <= 0) return;
      Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(free, free);
      Eigen::MatrixXd right = Eigen::MatrixXd::Zero(free, 3);
      constexpr int samples = 4 * segments;
      for (int k = 1; k < samples; ++k) {
        const double t = static_cast<double>(k) / samples;
        const Row row = value_row(t);
        Vec3 rest = on_curve(t);
        for (int i = 0; i < count; ++i) {
          if (i < first || i > last - 2) rest -= row[i] * point(i);
        }
        for (int i = 0; i < free; ++i) {
          for (int j = 0; j < free; ++j) matrix(i, j) += row[first + i] * row[first + j];
          right.row(i) += row[first + i] * rest.transpose();
        }
      }
      const Eigen::MatrixXd solution = matrix.ldlt().solve(right);
      for (int i = 0; i < free; ++i) point(first + i) = solution.row(i).transpose();
    };
    solve(1);
    if (const Vec3 n = plane_normal(vertex); n != Vec3::Zero()) {
      point(1) -= n * n.dot(point(1) - vertex.position);
      solve(2);
    }
  }

  // Unit; zero where no tangent plane exists.
  Vec3 plane_normal(const LimitPoint& vertex) const {
    const Vec3 normal = vertex.du.normalized().cross(vertex.dv.normalized());
    return pointed() || !(normal.norm() > 1e-10) ? Vec3(Vec3::Zero()) : Vec3(normal.normalized());
  }

  // The normals that a cell shall have along the curve, by t in [0,1]: those of the vertex and of the end
  // where the cell meets exact tiles, and between them a parabola with the right slope at that end. The limit
  // surface's own normals turn too fast near vertices of high valence.
  std::array<Vec3, 3> wanted_normals(const Entry& entry, double size, bool along_a,
                                     const LimitPoint& vertex) const {
    const auto normal = [&](double t) {
      const LimitPoint p = along_a ? limit(entry, size * t, 0) : limit(entry, 0, size * t);
      return Vec3(p.du.cross(p.dv).normalized());
    };
    const Vec3 end = normal(1), slope = -3 * end + 4 * normal(1.5) - normal(2);
    const Vec3 start = plane_normal(vertex);
    return {start == Vec3::Zero() ? end : start, end - 0.5 * slope, end};
  }

  void set_inner_points(const Entry& entry, double size, const LimitPoint& vertex, Net& net) const {
    constexpr int free = last - 2, unknowns = 3 * free * free;  // points 1 .. last - 2 each way
    Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(unknowns, unknowns);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(unknowns);
    const auto place = [](int i, int j) { return 3 * (free * (i - 1) + j - 1); };
    Net known = net;
    for (int i = 1; i <= free; ++i) {
      for (int j = 1; j <= free; ++j) known[count * i + j] = Vec3::Zero();
    }
    constexpr int samples = 4 * segments;
    for (int ka = 1; ka < samples; ++ka) {
      for (int kb = 1; kb < samples; ++kb) {
        const double a = static_cast<double>(ka) / samples, b = static_cast<double>(kb) / samples;
        const Row wa = value_row(a), wb = value_row(b);
        const Vec3 rest = limit(entry, size * a, size * b).position - combine(known, wa, wb);
        for_each_free(wa, wb, [&](int i, int j, double w) {
          right.segment<3>(place(i, j)) += w * rest;
          for_each_free(wa, wb, [&](int k, int l, double x) {
            matrix.block<3, 3>(place(i, j), place(k, l)).diagonal().array() += w * x;
          });
        });
      }
    }
    // Cross derivatives in the wanted tangent planes: n . (weights x points + the rest) = 0.
    const Row start = value_row(0), cross = slope_row(0);
    for (const bool along_a : {true, false}) {
      if (tangency_ == 0 || (along_a ? entry.sharp_a : entry.sharp_b)) continue;
      const std::array<Vec3, 3> wanted = wanted_normals(entry, size, along_a, vertex);
      constexpr int steps = 6 * segments;
      for (int k = 1; k < steps; ++k) {
        const double t = static_cast<double>(k) / steps;
        const Row at = value_row(t), by = slope_row(t);
        const Row& wa = along_a ? at : cross;
        const Row& wb = along_a ? cross : at;
        const Vec3 along = along_a ? combine(known, by, start) : combine(known, start, by);
        const Vec3 rest = combine(known, wa, wb);
        Vec3 n = (1 - t) * (1 - t) * wanted[0] + 2 * t * (1 - t) * wanted[1] + t * t * wanted[2];
        n = (n - along * (n.dot(along) / along.squaredNorm())).normalized();  // shared by both sides
        const Eigen::Matrix3d nn = tangency_ * n * n.transpose();
        for_each_free(wa, wb, [&](int i, int j, double w) {
          right.segment<3>(place(i, j)) -= w * (nn * rest);
          for_each_free(wa, wb, [&](int m, int l, double x) {
            matrix.block<3, 3>(place(i, j), place(m, l)) += w * x * nn;
          });
        });
      }
    }
    const Eigen::VectorXd solution = matrix.ldlt().solve(right);
    for (int i = 1; i <= free; ++i) {
      for (int j = 1; j <= free; ++j) net[count * i + j] = solution.segment<3>(place(i, j));
    }
  }
  template <typename Visit>
  static void for_each_free(const Row& a, const Row& b, const Visit& visit) {
    for (int i = 1; i < last - 1; ++i) {
      for (int j = 1; j < last - 1; ++j) {
        if (a[i] * b[j] != 0) visit(i, j, a[i] * b[j]);
      }
    }
  }

  const LimitEvaluator& evaluator_;
  std::span<const Vec3> points_;
  VertexRule rule_ = VertexRule::smooth;
  double tangency_ = 0;  // weight, squared, of tangent planes against positions
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
  return combine(net, value_row(ab.x() / size()), value_row(ab.y() / size()));
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
  const MirrorExtension extension(level);
  std::vector<Index> vertices;
  for (std::size_t slot = 0; slot < irregular.size(); ++slot) {
    if (irregular[slot]) vertices.push_back(level.face_vertices.values[slot]);
  }
  std::sort(vertices.begin(), vertices.end());
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());

  std::vector<CornerCell> cells(irregular.size());
  parallel_for(static_cast<Offset>(vertices.size()), 1, [&](Offset begin, Offset end) {
    for (Offset i = begin; i < end; ++i) {
      VertexCells vertex(level, extension, evaluator, points, irregular, vertices[i]);
      int best_depth = settings.max_depth;
      bool best_planes = false;
      double best = std::numeric_limits<double>::max();
      // Where the surface itself is rough (see limit_masks.hpp on creases) wanted tangent planes can do harm.
      for (const bool tangent_planes : {true, false}) {
        for (int depth = 2; !vertex.pointed() && depth <= settings.max_depth && best > 1; ++depth) {
          const VertexCells::Misfit misfit = vertex.fit(depth, tangent_planes);
          const double ratio =
              std::max(misfit.angle / settings.max_angle_degrees, misfit.deviation / settings.max_deviation);
          if (ratio < best) {
            best = ratio;
            best_depth = depth;
            best_planes = tangent_planes;
          }
        }
      }
      vertex.fit(best_depth, best_planes);
      vertex.store(cells);
    }
  });
  return cells;
}

}  // namespace flowcage
