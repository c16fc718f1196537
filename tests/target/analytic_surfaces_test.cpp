#include "core/target/analytic_surfaces.hpp"

#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "tests/catch.hpp"

using namespace flowcage;

namespace {

constexpr double pi = std::numbers::pi;

std::vector<Vec3> random_points(int count, double reach) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> coordinate(-reach, reach);
  std::vector<Vec3> points;
  for (int i = 0; i < count; ++i) {
    const double x = coordinate(random), y = coordinate(random), z = coordinate(random);
    points.emplace_back(x, y, z);
  }
  return points;
}

std::vector<SurfacePoint> closest(const TargetSurface& surface, const std::vector<Vec3>& queries) {
  std::vector<SurfacePoint> results(queries.size());
  surface.closest_points(queries, {}, results);
  return results;
}

struct Shape {
  std::string name;
  std::unique_ptr<AnalyticSurface> surface;
  Index faces, chains, corners;
  double area;
};

std::vector<Shape> shapes() {
  const Vec3 tilted = Vec3(1, 2, -2) / 3;
  std::vector<Shape> all;
  all.push_back({"sphere", sphere_surface(Vec3(1, 2, 3), 2), 1, 0, 0, 16 * pi});
  all.push_back({"half sphere", half_sphere_surface(Vec3(1, 0, 0), tilted, 1.5), 1, 1, 0, 2 * pi * 2.25});
  all.push_back({"torus", torus_surface({Vec3(0, 1, 0), tilted, 2, 0.5}), 1, 0, 0, 4 * pi * pi});
  all.push_back({"cylinder", cylinder_surface({Vec3(0, 0, -1), tilted, 0.75, 2}), 3, 2, 0,
                 2 * pi * 0.75 * 2 + 2 * pi * 0.75 * 0.75});
  all.push_back({"box", box_surface(Box3(Vec3(-1, 0, 1), Vec3(1, 3, 2))), 6, 12, 8, 2.0 * (6 + 2 + 3)});
  all.push_back({"sheet", sheet_surface(Vec3(1, 1, 1), Vec3(2, 0, 0), Vec3(0, 0, 1)), 1, 4, 4, 2});
  return all;
}

}  // namespace

TEST_CASE("sphere and torus: closest points and normals in closed form") {
  const auto queries = random_points(500, 3);
  const auto on_sphere = closest(*sphere_surface(Vec3(1, 0, 0), 2), queries);
  const auto on_torus = closest(*torus_surface({Vec3::Zero(), Vec3::UnitZ(), 2, 0.5}), queries);
  for (std::size_t i = 0; i < queries.size(); ++i) {
    const Vec3 n = (queries[i] - Vec3(1, 0, 0)).normalized();
    CHECK((on_sphere[i].position - Vec3(1, 0, 0) - 2 * n).norm() < 1e-14);
    CHECK((on_sphere[i].normal - n).norm() < 1e-14);
    CHECK(on_sphere[i].status == FootStatus::interior);
    const Vec3 ring = 2 * Vec3(queries[i].x(), queries[i].y(), 0).normalized();
    const Vec3 tube = (queries[i] - ring).normalized();
    CHECK((on_torus[i].position - ring - 0.5 * tube).norm() < 1e-13);
    CHECK((on_torus[i].normal - tube).norm() < 1e-13);
    CHECK(std::abs(on_torus[i].distance - std::abs((queries[i] - ring).norm() - 0.5)) < 1e-13);
  }
}

TEST_CASE("closest points beat every point of the tessellation, on the parametrised face") {
  const auto queries = random_points(60, 4);
  for (const Shape& shape : shapes()) {
    INFO(shape.name);
    const Tessellation& mesh = shape.surface->tessellation();
    const auto results = closest(*shape.surface, queries);
    for (std::size_t i = 0; i < queries.size(); ++i) {
      const SurfacePoint& hit = results[i];
      double nearest = std::numeric_limits<double>::infinity();
      for (const Vec3& p : mesh.points) nearest = std::min(nearest, (p - queries[i]).norm());
      CHECK(hit.distance <= nearest + 1e-13);
      CHECK(hit.distance > nearest - 0.2);
      const PatchPoint p = shape.surface->patch(hit.face).first(hit.uv);
      CHECK((p.position - hit.position).norm() < 1e-13);
      if (p.du.cross(p.dv).norm() > 1e-9) {
        CHECK((p.du.cross(p.dv).normalized() - hit.normal).norm() < 1e-9);
      }
      if (hit.status == FootStatus::interior) {
        CHECK((queries[i] - hit.position).cross(hit.normal).norm() < 1e-12);
      }
    }
  }
}

TEST_CASE("second derivatives are the differences of the first") {
  const double h = 1e-5;
  for (const Shape& shape : shapes()) {
    for (Index face = 0; face < shape.surface->face_count(); ++face) {
      INFO(shape.name << " face " << face);
      const ParametricPatch& patch = shape.surface->patch(face);
      const Vec2 uv = patch.domain().min() + 0.3 * patch.domain().sizes();
      const PatchCurvature c = patch.second(uv);
      const auto u1 = patch.first(uv + Vec2(h, 0)), u0 = patch.first(uv - Vec2(h, 0));
      const auto v1 = patch.first(uv + Vec2(0, h)), v0 = patch.first(uv - Vec2(0, h));
      CHECK((c.du - (u1.position - u0.position) / (2 * h)).norm() < 1e-8);
      CHECK((c.dv - (v1.position - v0.position) / (2 * h)).norm() < 1e-8);
      CHECK((c.duu - (u1.du - u0.du) / (2 * h)).norm() < 1e-8);
      CHECK((c.duv - (v1.du - v0.du) / (2 * h)).norm() < 1e-8);
      CHECK((c.dvv - (v1.dv - v0.dv) / (2 * h)).norm() < 1e-8);
    }
  }
}

TEST_CASE("tessellations: area, orientation and bounds") {
  for (const Shape& shape : shapes()) {
    INFO(shape.name);
    const Tessellation& mesh = shape.surface->tessellation();
    REQUIRE(shape.surface->face_count() == shape.faces);
    REQUIRE(mesh.triangles.size() == mesh.triangle_face.size());
    double area = 0;
    std::vector<Vec3> middles;
    for (const auto& t : mesh.triangles) {
      const Vec3 cross = (mesh.points[t[1]] - mesh.points[t[0]]).cross(mesh.points[t[2]] - mesh.points[t[0]]);
      area += 0.5 * cross.norm();
      middles.emplace_back((mesh.points[t[0]] + mesh.points[t[1]] + mesh.points[t[2]]) / 3);
    }
    CHECK(area == Approx(shape.area).epsilon(0.005));
    const auto feet = closest(*shape.surface, middles);
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      const auto& v = mesh.triangles[t];
      const Vec3 cross = (mesh.points[v[1]] - mesh.points[v[0]]).cross(mesh.points[v[2]] - mesh.points[v[0]]);
      CHECK(cross.normalized().dot(feet[t].normal) > 0.98);
      CHECK(feet[t].face == mesh.triangle_face[t]);
    }
    Box3 box;
    for (const Vec3& p : mesh.points) box.extend(p);
    CHECK((box.min() - shape.surface->bounds().min()).cwiseAbs().maxCoeff() < 0.02);
    CHECK((box.max() - shape.surface->bounds().max()).cwiseAbs().maxCoeff() < 0.02);
    for (const Vec3& p : mesh.points) CHECK(shape.surface->bounds().squaredExteriorDistance(p) < 1e-26);
  }
}

TEST_CASE("chains: arc length, tangents, corners, nearest points, and both sides' faces") {
  for (const Shape& shape : shapes()) {
    INFO(shape.name);
    const FeatureGraph& graph = shape.surface->features();
    REQUIRE(static_cast<Index>(graph.chains.size()) == shape.chains);
    REQUIRE(static_cast<Index>(graph.corners.size()) == shape.corners);
    for (Index c = 0; c < shape.chains; ++c) {
      const FeatureChain& chain = graph.chains[c];
      const double h = 1e-6 * chain.length;
      for (const double fraction : {0.125, 0.4, 0.77}) {
        const double s = fraction * chain.length;
        const CurvePoint p = shape.surface->chain_point(c, s);
        const Vec3 step = shape.surface->chain_point(c, s + h).position - p.position;
        CHECK(step.norm() == Approx(h).epsilon(1e-6));
        CHECK((step.normalized() - p.tangent).norm() < 1e-5);
        const CurvePoint foot = shape.surface->closest_on_chain(c, p.position);
        CHECK(foot.s == Approx(s).epsilon(1e-12));
        CHECK(foot.distance < 1e-14);
        CHECK(closest(*shape.surface, {p.position})[0].distance < 1e-14);
      }
      CHECK((chain.polyline.front() - shape.surface->chain_point(c, 0).position).norm() == 0);
      if (chain.start != no_index) {
        CHECK((graph.corners[chain.start] - chain.polyline.front()).norm() < 1e-14);
        CHECK((graph.corners[chain.end] - chain.polyline.back()).norm() < 1e-14);
        CHECK(shape.surface->chain_point(c, 2 * chain.length).s == chain.length);
      } else {
        CHECK(chain.polyline.front() == chain.polyline.back());
        CHECK(shape.surface->chain_point(c, 1.25 * chain.length).s == Approx(0.25 * chain.length));
      }
      CHECK(chain.faces.size() == (chain.kind == ChainKind::sharp ? 2 : 1));
    }
  }
}

TEST_CASE("box: the six faces look outward; compatible normals choose the side") {
  const auto box = box_surface(Box3(Vec3(0, 0, 0), Vec3(1, 1, 1)));
  const std::vector<Vec3> queries(6, Vec3(0.5, 0.5, 0.45));
  const std::vector<Vec3> normals{-Vec3::UnitX(), Vec3::UnitX(),  -Vec3::UnitY(),
                                  Vec3::UnitY(),  -Vec3::UnitZ(), Vec3::UnitZ()};
  std::vector<SurfacePoint> results(6);
  box->closest_compatible(queries, normals, 0.5, 1, results);
  for (Index i = 0; i < 6; ++i) {
    CHECK(results[i].face == i);
    CHECK((results[i].normal - normals[i]).norm() == 0);
  }
  box->closest_compatible(queries, normals, 0.5, 0.52, results);
  CHECK(results[5].status == FootStatus::failed);
  CHECK(results[4].status == FootStatus::interior);
  const auto outside = closest(*box, {Vec3(2, 0.5, 2), Vec3(0.5, 0.25, 3)});
  CHECK(outside[0].status == FootStatus::boundary);
  CHECK(outside[0].distance == Approx(std::sqrt(2.0)));
  CHECK(outside[1].status == FootStatus::interior);
  CHECK(box->face_name(outside[1].face) == "z+");
}

TEST_CASE("lines: known intersections") {
  const auto first_hit = [](const TargetSurface& surface, const Vec3& q, const Vec3& d) {
    SurfacePoint hit;
    surface.intersect_lines({&q, 1}, {&d, 1}, -1, 100, {&hit, 1});
    return hit;
  };
  const auto torus = torus_surface({Vec3::Zero(), Vec3::UnitZ(), 2, 0.5});
  for (const double x : {-4.0, -2.1, -1.2, 0.3, 1.9, 3.0}) {
    const SurfacePoint hit = first_hit(*torus, Vec3(x, 0, 0), Vec3::UnitX());
    double nearest = 100;
    for (const double root : {-2.5, -1.5, 1.5, 2.5}) nearest = std::min(nearest, std::abs(root - x));
    CHECK(hit.distance == Approx(nearest).epsilon(1e-12));
  }
  // Vertical lines through the tube, and one that touches the top circle.
  CHECK(first_hit(*torus, Vec3(2.3, 0, 5), Vec3::UnitZ()).distance == Approx(4.6).epsilon(1e-12));
  CHECK((first_hit(*torus, Vec3(2, -3, 0.5), Vec3::UnitY()).position - Vec3(2, 0, 0.5)).norm() < 1e-6);
  CHECK(first_hit(*torus, Vec3(0, 0, 0), Vec3::UnitZ()).status == FootStatus::failed);
  const auto cylinder = cylinder_surface({Vec3::Zero(), Vec3::UnitZ(), 1, 3});
  CHECK(first_hit(*cylinder, Vec3(0.2, 0, 1), Vec3::UnitX()).distance == Approx(0.8));
  CHECK(first_hit(*cylinder, Vec3(0.2, 0, 1), Vec3::UnitX()).face == 1);
  CHECK(first_hit(*cylinder, Vec3(0.2, 0.3, 1), Vec3::UnitZ()).face == 0);
  CHECK(first_hit(*cylinder, Vec3(0.2, 0.3, 2), Vec3::UnitZ()).face == 2);
  CHECK(first_hit(*cylinder, Vec3(5, 1.5, 1), Vec3::UnitX()).status == FootStatus::failed);
  // Wanted direction of the normal, and largest distance.
  const Vec3 q(0.2, 0, 1), d = Vec3::UnitX();
  SurfacePoint hit;
  cylinder->intersect_lines({&q, 1}, {&d, 1}, 0.5, 100, {&hit, 1});
  CHECK((hit.position - Vec3(1, 0, 1)).norm() < 1e-13);
  const Vec3 back = -d;
  cylinder->intersect_lines({&q, 1}, {&back, 1}, 0.5, 100, {&hit, 1});
  CHECK((hit.position - Vec3(-1, 0, 1)).norm() < 1e-13);
  cylinder->intersect_lines({&q, 1}, {&back, 1}, 0.5, 1, {&hit, 1});
  CHECK(hit.status == FootStatus::failed);
}

TEST_CASE("random lines: each shape's points lie on the line and on the face") {
  const auto origins = random_points(200, 3);
  auto directions = random_points(400, 1);
  directions.erase(directions.begin(), directions.begin() + 200);
  for (Vec3& d : directions) d.normalize();
  for (const Shape& shape : shapes()) {
    INFO(shape.name);
    std::vector<SurfacePoint> hits(origins.size());
    shape.surface->intersect_lines(origins, directions, -1, 100, hits);
    int found = 0;
    for (std::size_t i = 0; i < hits.size(); ++i) {
      if (hits[i].status == FootStatus::failed) continue;
      ++found;
      CHECK((hits[i].position - origins[i]).cross(directions[i]).norm() < 1e-11);
      CHECK(closest(*shape.surface, {hits[i].position})[0].distance < 1e-12);
    }
    CHECK(found >= 5);
  }
}

TEST_CASE("queries that are no numbers fail and harm nothing") {
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  for (const Shape& shape : shapes()) {
    const std::vector<Vec3> queries{Vec3(nan, 0, 0), Vec3(0, inf, 0), Vec3(1e300, 0, 0)};
    const auto results = closest(*shape.surface, queries);
    CHECK(results[0].status == FootStatus::failed);
    CHECK(results[1].status == FootStatus::failed);
    std::vector<SurfacePoint> hits(3);
    const std::vector<Vec3> directions(3, Vec3::UnitX());
    shape.surface->intersect_lines(queries, directions, -1, 1, hits);
    CHECK(hits[0].status == FootStatus::failed);
  }
}
