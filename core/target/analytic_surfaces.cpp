#include "core/target/analytic_surfaces.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/base/parallel.hpp"
#include "core/target/analytic_faces.hpp"

namespace flowcage {
namespace {

constexpr double pi = std::numbers::pi;
constexpr Offset batch_grain = 1024;
constexpr int chain_segments = 64;

CurvePoint curve_point(const AnalyticCurve& curve, double s) {
  CurvePoint p;
  if (curve.radius > 0) {
    p.s = s - curve.length * std::floor(s / curve.length);
    const double angle = p.s / curve.radius;
    p.position = curve.origin + curve.radius * (std::cos(angle) * curve.x + std::sin(angle) * curve.y);
    p.tangent = -std::sin(angle) * curve.x + std::cos(angle) * curve.y;
  } else {
    p.s = std::clamp(s, 0.0, curve.length);
    p.position = curve.origin + p.s * curve.x;
    p.tangent = curve.x;
  }
  return p;
}

CurvePoint closest_on_curve(const AnalyticCurve& curve, const Vec3& query) {
  const Vec3 offset = query - curve.origin;
  const double along = offset.dot(curve.x), across = offset.dot(curve.y);
  double s = along;
  if (curve.radius > 0) {
    const double angle = along == 0 && across == 0 ? 0.0 : std::atan2(across, along);
    s = curve.radius * (angle < 0 ? angle + 2 * pi : angle);
  }
  CurvePoint p = curve_point(curve, s);
  p.distance = (query - p.position).norm();
  return p;
}

AnalyticCurve circle(const Frame& frame, double z, double radius) {
  return {frame.origin + z * frame.z, frame.x, frame.y, radius, 2 * pi * radius};
}

AnalyticCurve segment(const Vec3& a, const Vec3& b) {
  return {a, (b - a).normalized(), Vec3::Zero(), 0, (b - a).norm()};
}

/// Calls answer(i) for each query; one that gives no finite distance is `failed`.
template <typename Answer>
void for_each_query(std::size_t count, const Answer& answer) {
  parallel_for(static_cast<Offset>(count), batch_grain, [&](Offset begin, Offset end) {
    for (Offset i = begin; i < end; ++i) answer(static_cast<std::size_t>(i));
  });
}

}  // namespace

AnalyticSurface::AnalyticSurface(std::vector<std::unique_ptr<AnalyticFace>> faces, FeatureGraph graph,
                                 std::vector<AnalyticCurve> curves)
    : faces_(std::move(faces)), curves_(std::move(curves)), graph_(std::move(graph)) {
  for (Index face = 0; face < face_count(); ++face) {
    faces_[face]->tessellate(face, tessellation_);
    bounds_.extend(faces_[face]->box());
  }
  for (std::size_t c = 0; c < curves_.size(); ++c) {
    FeatureChain& chain = graph_.chains[c];
    chain.length = curves_[c].length;
    for (int i = 0; i <= chain_segments; ++i) {
      const double s = chain.length * i / chain_segments;
      chain.polyline.push_back(curve_point(curves_[c], s).position);
      chain.polyline_s.push_back(s);
    }
    if (chain.start == no_index) chain.polyline.back() = chain.polyline.front();
  }
}

AnalyticSurface::~AnalyticSurface() = default;

void AnalyticSurface::closest_points(std::span<const Vec3> queries, std::span<const SurfacePoint>,
                                     std::span<SurfacePoint> results) const {
  for_each_query(queries.size(), [&](std::size_t i) {
    SurfacePoint best;
    best.distance = std::numeric_limits<double>::infinity();
    for (Index face = 0; face < face_count() && queries[i].allFinite(); ++face) {
      SurfacePoint hit = faces_[face]->closest(queries[i]);
      hit.face = face;
      if (hit.distance < best.distance) best = hit;
    }
    results[i] = best.face == no_index ? SurfacePoint{} : best;
  });
}

void AnalyticSurface::closest_compatible(std::span<const Vec3> queries, std::span<const Vec3> normals,
                                         double min_cosine, double max_distance,
                                         std::span<SurfacePoint> results) const {
  for_each_query(queries.size(), [&](std::size_t i) {
    SurfacePoint best;
    best.distance = std::numeric_limits<double>::infinity();
    for (Index face = 0; face < face_count() && queries[i].allFinite(); ++face) {
      SurfacePoint hit = faces_[face]->closest(queries[i]);
      hit.face = face;
      const bool fits = hit.distance <= max_distance && hit.normal.dot(normals[i]) >= min_cosine;
      if (fits && hit.distance < best.distance) best = hit;
    }
    results[i] = best.face == no_index ? SurfacePoint{} : best;
  });
}

void AnalyticSurface::intersect_lines(std::span<const Vec3> queries, std::span<const Vec3> directions,
                                      double min_cosine, double max_distance,
                                      std::span<SurfacePoint> results) const {
  for_each_query(queries.size(), [&](std::size_t i) {
    SurfacePoint best;
    best.distance = std::numeric_limits<double>::infinity();
    std::vector<SurfacePoint> hits;
    for (Index face = 0; face < face_count(); ++face) {
      if (!queries[i].allFinite() || !directions[i].allFinite()) break;
      hits.clear();
      faces_[face]->intersect(queries[i], directions[i], hits);
      for (SurfacePoint& hit : hits) {
        hit.face = face;
        const bool fits = hit.distance <= max_distance && hit.normal.dot(directions[i]) >= min_cosine;
        if (fits && hit.distance < best.distance) best = hit;
      }
    }
    results[i] = best.face == no_index ? SurfacePoint{} : best;
  });
}

CurvePoint AnalyticSurface::chain_point(Index chain, double s) const {
  return curve_point(curves_[chain], s);
}

CurvePoint AnalyticSurface::closest_on_chain(Index chain, const Vec3& query) const {
  return closest_on_curve(curves_[chain], query);
}

std::string AnalyticSurface::face_name(Index face) const {
  return faces_[face]->name();
}

const ParametricPatch& AnalyticSurface::patch(Index face) const {
  return *faces_[face];
}

std::unique_ptr<AnalyticSurface> sphere_surface(const Vec3& center, double radius) {
  std::vector<std::unique_ptr<AnalyticFace>> faces;
  faces.push_back(revolution_face("sphere", frame_along(center, Vec3::UnitZ()),
                                  arc_profile(Vec2::Zero(), radius, Vec2(-pi / 2, pi / 2))));
  return std::make_unique<AnalyticSurface>(std::move(faces), FeatureGraph{}, std::vector<AnalyticCurve>{});
}

std::unique_ptr<AnalyticSurface> half_sphere_surface(const Vec3& center, const Vec3& axis, double radius) {
  const Frame frame = frame_along(center, axis);
  std::vector<std::unique_ptr<AnalyticFace>> faces;
  faces.push_back(revolution_face("half sphere", frame, arc_profile(Vec2::Zero(), radius, Vec2(0, pi / 2))));
  FeatureGraph graph;
  graph.chains.resize(1);
  graph.chains[0].kind = ChainKind::boundary;
  graph.chains[0].faces = {0};
  return std::make_unique<AnalyticSurface>(std::move(faces), std::move(graph),
                                           std::vector<AnalyticCurve>{circle(frame, 0, radius)});
}

std::unique_ptr<AnalyticSurface> torus_surface(const TorusShape& shape) {
  std::vector<std::unique_ptr<AnalyticFace>> faces;
  faces.push_back(
      revolution_face("torus", frame_along(shape.center, shape.axis),
                      arc_profile(Vec2(shape.major_radius, 0), shape.minor_radius, Vec2(0, 2 * pi))));
  return std::make_unique<AnalyticSurface>(std::move(faces), FeatureGraph{}, std::vector<AnalyticCurve>{});
}

std::unique_ptr<AnalyticSurface> cylinder_surface(const CylinderShape& shape) {
  const Frame frame = frame_along(shape.base_center, shape.axis);
  const double r = shape.radius, h = shape.height;
  std::vector<std::unique_ptr<AnalyticFace>> faces;
  faces.push_back(revolution_face("base", frame, segment_profile(Vec2(0, 0), Vec2(r, 0))));
  faces.push_back(revolution_face("side", frame, segment_profile(Vec2(r, 0), Vec2(r, h))));
  faces.push_back(revolution_face("top", frame, segment_profile(Vec2(r, h), Vec2(0, h))));
  FeatureGraph graph;
  graph.chains.resize(2);
  graph.chains[0].faces = {0, 1};
  graph.chains[1].faces = {1, 2};
  return std::make_unique<AnalyticSurface>(
      std::move(faces), std::move(graph),
      std::vector<AnalyticCurve>{circle(frame, 0, r), circle(frame, h, r)});
}

std::unique_ptr<AnalyticSurface> box_surface(const Box3& box) {
  std::vector<std::unique_ptr<AnalyticFace>> faces;
  const Vec3 size = box.sizes();
  for (int axis = 0; axis < 3; ++axis) {
    const Vec3 a = Vec3::Unit((axis + 1) % 3) * size[(axis + 1) % 3];
    const Vec3 b = Vec3::Unit((axis + 2) % 3) * size[(axis + 2) % 3];
    const std::string name(1, static_cast<char>('x' + axis));
    faces.push_back(rectangle_face(name + "-", box.min(), b, a));
    faces.push_back(rectangle_face(name + "+", box.min() + Vec3::Unit(axis) * size[axis], a, b));
  }
  FeatureGraph graph;
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 high(corner & 1, (corner >> 1) & 1, (corner >> 2) & 1);
    graph.corners.push_back(box.min() + high.cwiseProduct(size));
  }
  std::vector<AnalyticCurve> curves;
  for (int axis = 0; axis < 3; ++axis) {
    for (int start = 0; start < 8; ++start) {
      if ((start >> axis) & 1) continue;
      FeatureChain chain;
      chain.start = start;
      chain.end = start | (1 << axis);
      for (int other = 0; other < 3; ++other) {
        if (other != axis) chain.faces.push_back(2 * other + ((start >> other) & 1));
      }
      curves.push_back(segment(graph.corners[chain.start], graph.corners[chain.end]));
      graph.chains.push_back(std::move(chain));
    }
  }
  return std::make_unique<AnalyticSurface>(std::move(faces), std::move(graph), std::move(curves));
}

std::unique_ptr<AnalyticSurface> sheet_surface(const Vec3& origin, const Vec3& a, const Vec3& b) {
  std::vector<std::unique_ptr<AnalyticFace>> faces;
  faces.push_back(rectangle_face("sheet", origin, a, b));
  FeatureGraph graph;
  graph.corners = {origin, origin + a, origin + a + b, origin + b};
  std::vector<AnalyticCurve> curves;
  for (Index side = 0; side < 4; ++side) {
    FeatureChain chain;
    chain.kind = ChainKind::boundary;
    chain.start = side;
    chain.end = (side + 1) % 4;
    chain.faces = {0};
    curves.push_back(segment(graph.corners[chain.start], graph.corners[chain.end]));
    graph.chains.push_back(std::move(chain));
  }
  return std::make_unique<AnalyticSurface>(std::move(faces), std::move(graph), std::move(curves));
}

}  // namespace flowcage
