#include <BRepBuilderAPI_MakeVertex.hxx>
#include <BRepExtrema_DistShapeShape.hxx>
#include <BRep_Builder.hxx>
#include <Geom_BezierSurface.hxx>
#include <IntCurvesFace_ShapeIntersector.hxx>
#include <TopoDS_Compound.hxx>
#include <gp_Lin.hxx>
#include <limits>
#include <random>

#include "core/base/parallel.hpp"
#include "occ_bridge/internal/face_projector.hpp"
#include "tests/catch.hpp"
#include "tests/occ_bridge/projection_shapes.hpp"

using namespace flowcage;

namespace {

TopoDS_Compound loose(const std::vector<TopoDS_Face>& faces) {
  BRep_Builder builder;
  TopoDS_Compound compound;
  builder.MakeCompound(compound);
  for (const TopoDS_Face& face : faces) builder.Add(compound, face);
  return compound;
}

double kernel_distance(const TopoDS_Compound& faces, const Vec3& query) {
  BRepBuilderAPI_MakeVertex vertex(gp_Pnt(query.x(), query.y(), query.z()));
  const BRepExtrema_DistShapeShape extrema(vertex.Vertex(), faces);
  return extrema.IsDone() ? extrema.Value() : std::numeric_limits<double>::infinity();
}

std::vector<Vec3> random_points(int count, double reach, unsigned seed = 5) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> coordinate(-reach, reach);
  std::vector<Vec3> points;
  for (int i = 0; i < count; ++i) {
    const double x = coordinate(random), y = coordinate(random), z = coordinate(random);
    points.emplace_back(x, y, z);
  }
  return points;
}

std::vector<SurfacePoint> closest(const FaceProjector& projector, const std::vector<Vec3>& queries) {
  std::vector<SurfacePoint> results(queries.size());
  projector.closest_points(queries, {}, results);
  return results;
}

/// Far points, and points within 3 % of the faces (found by a first projection).
std::vector<Vec3> far_and_near(const FaceProjector& projector, int count) {
  std::vector<Vec3> queries = random_points(2 * count, 2.5);
  const auto feet = closest(projector, queries);
  const auto offsets = random_points(count, 0.03, 8);
  for (int i = 0; i < count; ++i) queries[i] = feet[i].position + offsets[i];
  return queries;
}

TopoDS_Face bilinear_face(const Vec3& along_u, const Vec3& along_v) {
  TColgp_Array2OfPnt points(0, 1, 0, 1);
  for (int i = 0; i < 2; ++i) {
    for (int j = 0; j < 2; ++j) {
      const Vec3 p = i * along_u + j * along_v;
      points.ChangeValue(i, j) = gp_Pnt(p.x(), p.y(), p.z());
    }
  }
  return BRepBuilderAPI_MakeFace(new Geom_BezierSurface(points), 1e-7);
}

bool same(const SurfacePoint& a, const SurfacePoint& b) {
  return a.position == b.position && a.normal == b.normal && a.uv == b.uv && a.face == b.face &&
         a.distance == b.distance && a.status == b.status;
}

}  // namespace

TEST_CASE("closest points are never farther than the kernel's own search") {
  for (const auto& [name, shape] : test_shapes::all()) {
    INFO(name);
    const auto faces = test_shapes::faces_of(shape);
    const FaceProjector projector(faces);
    CHECK(projector.notes().empty());
    const TopoDS_Compound compound = loose(faces);
    const auto queries = far_and_near(projector, 40);
    const auto results = closest(projector, queries);
    for (std::size_t i = 0; i < queries.size(); ++i) {
      INFO("query " << queries[i].transpose());
      REQUIRE(results[i].status != FootStatus::failed);
      CHECK(results[i].distance <= kernel_distance(compound, queries[i]) + 1e-9);
      CHECK(std::abs((results[i].position - queries[i]).norm() - results[i].distance) < 1e-12);
      CHECK(kernel_distance(compound, results[i].position) < 1e-7);
      CHECK(std::abs(results[i].normal.norm() - 1) < 1e-12);
      if (results[i].status == FootStatus::interior) {
        CHECK((results[i].position - queries[i]).cross(results[i].normal).norm() < 1e-7);
      }
    }
  }
}

TEST_CASE("sphere, torus, cylinder: known feet and outward normals, poles and seams included") {
  const FaceProjector sphere(test_shapes::faces_of(BRepPrimAPI_MakeSphere(1).Shape()));
  std::vector<Vec3> queries = random_points(200, 2);
  for (const double z : {-1.5, -0.5, 0.5, 1.5}) queries.emplace_back(0, 0, z);  // over the poles
  for (const double x : {0.5, 1.0, 2.0}) queries.emplace_back(x, 0, 0.3);       // over the seam
  auto results = closest(sphere, queries);
  for (std::size_t i = 0; i < queries.size(); ++i) {
    INFO("query " << queries[i].transpose());
    CHECK((results[i].position - queries[i].normalized()).norm() < 1e-10);
    CHECK((results[i].normal - queries[i].normalized()).norm() < 1e-6);
    CHECK(results[i].status == FootStatus::interior);
  }
  const FaceProjector torus(test_shapes::faces_of(BRepPrimAPI_MakeTorus(1, 0.3).Shape()));
  results = closest(torus, queries);
  for (std::size_t i = 0; i < queries.size(); ++i) {
    const Vec3 flat(queries[i].x(), queries[i].y(), 0);
    if (flat.norm() == 0) continue;
    const Vec3 n = (queries[i] - flat.normalized()).normalized();
    CHECK((results[i].position - flat.normalized() - 0.3 * n).norm() < 1e-10);
    CHECK((results[i].normal - n).norm() < 1e-10);
  }
  const FaceProjector cylinder(test_shapes::faces_of(BRepPrimAPI_MakeCylinder(1, 2).Shape()));
  results = closest(cylinder, {Vec3(3, 0, 1), Vec3(0, 0, 5), Vec3(3, 0, 5), Vec3(0.1, 0.2, -1)});
  CHECK((results[0].normal - Vec3::UnitX()).norm() < 1e-12);
  CHECK((results[1].normal - Vec3::UnitZ()).norm() < 1e-12);
  CHECK((results[2].position - Vec3(1, 0, 2)).norm() < 1e-10);
  CHECK(results[2].status == FootStatus::boundary);
  CHECK((results[3].normal + Vec3::UnitZ()).norm() < 1e-12);
}

TEST_CASE("the same bits with one and four threads; hints change nothing beyond rounding") {
  for (const auto& [name, shape] : test_shapes::all()) {
    INFO(name);
    const FaceProjector projector(test_shapes::faces_of(shape));
    const auto queries = random_points(1500, 2);
    set_thread_count(1);
    const auto one = closest(projector, queries);
    set_thread_count(4);
    const auto four = closest(projector, queries);
    set_thread_count(0);
    std::vector<SurfacePoint> hinted(queries.size()), misled(queries.size());
    projector.closest_points(queries, one, hinted);
    std::vector<SurfacePoint> wrong = one;
    std::rotate(wrong.begin(), wrong.begin() + 700, wrong.end());
    for (std::size_t i = 0; i < wrong.size(); i += 3) wrong[i].position = queries[i];  // promises too much
    projector.closest_points(queries, wrong, misled);
    int differ = 0;
    for (std::size_t i = 0; i < queries.size(); ++i) {
      if (!same(one[i], four[i])) ++differ;
      if (std::abs(one[i].distance - hinted[i].distance) > 1e-12) ++differ;
      if (std::abs(one[i].distance - misled[i].distance) > 1e-12) ++differ;
    }
    CHECK(differ == 0);
  }
}

TEST_CASE("lines meet the faces where the kernel's intersector says") {
  for (const auto& [name, shape] : test_shapes::all()) {
    INFO(name);
    const auto faces = test_shapes::faces_of(shape);
    const FaceProjector projector(faces);
    IntCurvesFace_ShapeIntersector intersector;
    intersector.Load(loose(faces), 1e-9);
    const auto queries = random_points(80, 1);
    auto directions = random_points(80, 1, 9);
    for (Vec3& d : directions) d.normalize();
    std::vector<SurfacePoint> results(queries.size());
    projector.intersect_lines(queries, directions, -1, 100, results);
    int found = 0;
    for (std::size_t i = 0; i < queries.size(); ++i) {
      INFO("from " << queries[i].transpose() << " along " << directions[i].transpose());
      const gp_Lin line(gp_Pnt(queries[i].x(), queries[i].y(), queries[i].z()),
                        gp_Dir(directions[i].x(), directions[i].y(), directions[i].z()));
      intersector.Perform(line, -100, 100);
      double nearest = std::numeric_limits<double>::infinity();
      for (int k = 1; k <= intersector.NbPnt(); ++k) {
        nearest = std::min(nearest, std::abs(intersector.WParameter(k)));
      }
      if (results[i].status == FootStatus::failed) {
        CHECK(nearest == std::numeric_limits<double>::infinity());
        continue;
      }
      ++found;
      CHECK(results[i].distance <= nearest + 1e-7);
      CHECK((results[i].position - queries[i]).cross(directions[i]).norm() < 1e-9);
      if (results[i].distance < nearest - 1e-7) {  // one that the kernel missed must still be on the faces
        CHECK(kernel_distance(loose(faces), results[i].position) < 1e-7);
      }
    }
    CHECK(found > 5);
  }
}

TEST_CASE("compatible normals choose the side of a thin body, and fail beyond the distance") {
  const FaceProjector wing(test_shapes::faces_of(test_shapes::wing()));
  std::vector<Vec3> queries, up, down;
  for (const Vec3& p : random_points(200, 1)) {
    queries.emplace_back(0.45 + 0.2 * p.x() + 0.5, 0.9 + 0.5 * p.y(), 0.1 * p.z());
    up.push_back(Vec3::UnitZ());
    down.push_back(-Vec3::UnitZ());
  }
  std::vector<SurfacePoint> above(queries.size()), below(queries.size()), none(queries.size());
  wing.closest_compatible(queries, up, 0.5, 1, above);
  wing.closest_compatible(queries, down, 0.5, 1, below);
  wing.closest_compatible(queries, up, 0.5, 1e-7, none);
  const auto nearest = closest(wing, queries);
  for (std::size_t i = 0; i < queries.size(); ++i) {
    REQUIRE(above[i].status != FootStatus::failed);
    REQUIRE(below[i].status != FootStatus::failed);
    CHECK(above[i].normal.z() >= 0.5);
    CHECK(below[i].normal.z() <= -0.5);
    CHECK(above[i].position.z() > below[i].position.z());
    CHECK(std::min(above[i].distance, below[i].distance) >= nearest[i].distance - 1e-12);
    if (std::abs(nearest[i].normal.z()) > 0.51) {
      CHECK(std::min(above[i].distance, below[i].distance) == Approx(nearest[i].distance).margin(1e-12));
    }
    if (above[i].distance > 1e-6) CHECK(none[i].status == FootStatus::failed);
  }
}

TEST_CASE("a face collapsed to a line is left out with a note; its neighbour answers") {
  const TopoDS_Face line = bilinear_face(Vec3::UnitX(), Vec3::Zero());
  const TopoDS_Face sheet = bilinear_face(Vec3::UnitX(), Vec3::UnitY());
  const FaceProjector projector({line, sheet});
  REQUIRE(projector.notes().size() == 1);
  const auto result = closest(projector, {Vec3(0.3, -1, 0.5)})[0];
  CHECK(result.face == 1);
  CHECK((result.position - Vec3(0.3, 0, 0)).norm() < 1e-12);
  CHECK((result.normal - Vec3::UnitZ()).norm() < 1e-12);
}

TEST_CASE("queries that are no numbers fail and harm nothing") {
  const FaceProjector projector(test_shapes::faces_of(BRepPrimAPI_MakeBox(1, 1, 1).Shape()));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto results = closest(projector, {Vec3(nan, 0, 0), Vec3(0, 0, 1e300), Vec3(0.5, 0.5, 2)});
  CHECK(results[0].status == FootStatus::failed);
  CHECK(results[2].distance == Approx(1));
  CHECK(closest(FaceProjector({}), {Vec3(0, 0, 0)})[0].status == FootStatus::failed);
}
