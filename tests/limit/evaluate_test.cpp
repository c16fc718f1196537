#include "core/limit/evaluate.hpp"

#include <algorithm>

#include "core/limit/limit_stencils.hpp"
#include "core/limit/spectral_powers.hpp"
#include "core/subdivide/refine.hpp"
#include "tests/catch.hpp"
#include "tests/subdivide/cage_zoo.hpp"

using namespace flowcage;

namespace {

// The corner of `face` at parameters (0 or 1), n-gons by their child quads.
LimitLocation corner_location(const SurfaceLevel& level, Index face, Index corner) {
  if (level.face_vertices.row_size(face) != 4) return {face, 0, 0, corner};
  return {face, corner == 1 || corner == 2 ? 1.0 : 0.0, corner >= 2 ? 1.0 : 0.0};
}

// Vertex (i,j) / 2^depth of a quad face's parameters, found by walking down the child faces.
Index grid_vertex(const std::vector<SurfaceLevel>& levels, Index face, double u, double v) {
  for (std::size_t k = 0; k + 1 < levels.size(); ++k) {
    const auto first = static_cast<Index>(levels[k].face_vertices.offsets[face]);
    const double x = 2 * u, y = 2 * v;
    if (x <= 1 && y <= 1) {
      face = first, u = x, v = y;
    } else if (y <= 1) {
      face = first + 1, u = y, v = 2 - x;
    } else if (x <= 1) {
      face = first + 3, u = 2 - y, v = x;
    } else {
      face = first + 2, u = 2 - x, v = 2 - y;
    }
  }
  const int corner = v == 0 ? (u == 0 ? 0 : 1) : (u == 0 ? 3 : 2);
  return levels.back().face_vertices[face][corner];
}

}  // namespace

TEST_CASE("powers through the eigenbasis are repeated products, Jordan blocks included") {
  Eigen::MatrixXd jordan(5, 5);
  jordan << 1, 0, 0, 0, 0, 0.2, 0.25, 1, 0, 0, 0.1, 0, 0.25, 1, 0, 0.3, 0, 0, 0.25, 0, 0.1, 0.4, 0, 0.3, 0.5;
  const SpectralPowers powers(jordan);
  const Eigen::MatrixXd rows = Eigen::MatrixXd::Random(3, 5);
  Eigen::MatrixXd expected = rows;
  for (int k = 0; k < 30; ++k) {
    CHECK((powers.multiply(rows, {k, 1, false}) - expected).norm() < 1e-12);
    expected = expected * jordan;
  }
}

TEST_CASE("evaluation at vertices gives the limit stencils' positions and normals") {
  for (const auto& [name, cage] : zoo::all()) {
    const SurfaceLevel level = build_surface_level(cage);
    const LimitEvaluator evaluator(level);
    const std::vector<Vec3> limits = apply_stencils(limit_stencils(level), cage.points);
    for (Index f = 0; f < level.face_count(); ++f) {
      for (Index i = 0; i < level.face_vertices.row_size(f); ++i) {
        const Index v = level.face_vertices[f][i];
        const LimitPoint at = evaluator.evaluate(cage.points, corner_location(level, f, i));
        INFO(name << ", face " << f << ", corner " << i);
        CHECK((at.position - limits[v]).norm() < 1e-12);
      }
    }
  }
}

TEST_CASE("evaluation agrees with limits of deep refinement anywhere") {
  constexpr int depth = 4;
  double worst = 0;
  int compared = 0;
  for (const auto& [name, cage] : zoo::all()) {
    const std::vector<SurfaceLevel> levels = build_levels(cage, depth);
    const std::vector<Vec3> limits =
        apply_stencils(limit_stencils(levels.back()), refine_points(levels, cage.points));
    const LimitEvaluator evaluator(levels.front());
    const std::vector<SurfaceLevel> below(levels.begin() + 1, levels.end());
    for (Index f = 0; f < levels[0].face_count(); ++f) {
      const bool quad = levels[0].face_vertices.row_size(f) == 4;
      const int steps = 1 << (quad ? depth : depth - 1);
      for (Index corner = 0; corner < (quad ? 1 : levels[0].face_vertices.row_size(f)); ++corner) {
        for (int i = 0; i <= steps; ++i) {
          const int j = (7 * i + 3 * f) % (steps + 1);
          const double u = static_cast<double>(i) / steps, v = static_cast<double>(j) / steps;
          const Index vertex =
              quad
                  ? grid_vertex(levels, f, u, v)
                  : grid_vertex(below, static_cast<Index>(levels[0].face_vertices.offsets[f]) + corner, u, v);
          const double distance =
              (evaluator.evaluate(cage.points, {f, u, v, corner}).position - limits[vertex]).norm();
          INFO(name << ", face " << f << " corner " << corner << ", at " << u << ' ' << v);
          CHECK(distance < 1e-11);
          worst = std::max(worst, distance);
          ++compared;
        }
      }
    }
  }
  CHECK(compared > 10000);
  std::printf("evaluation against refinement: worst %.1e at %d places\n", worst, compared);
}

TEST_CASE("derivatives are those of differences, near irregular vertices too") {
  // Central differences of fourth order. The step stays inside of one polynomial piece.
  double worst = 0;
  int compared = 0;
  for (const auto& [name, cage] : zoo::all()) {
    const SurfaceLevel level = build_surface_level(cage);
    const LimitEvaluator evaluator(level);
    for (Index f = 0; f < level.face_count(); f += 3) {
      for (const auto& [u, v] :
           {std::pair{0.3, 0.15}, {0.07, 0.9}, {0.9, 0.6}, {0.011, 0.013}, {0.002, 0.0007}}) {
        const double h = 1e-2 * std::min({u, v, 1 - u, 1 - v});
        const auto position = [&](double du, double dv) {
          return evaluator.evaluate(cage.points, {f, u + du, v + dv, 1}).position;
        };
        const auto difference = [&](double x, double y) -> Vec3 {
          return (8 * (position(x, y) - position(-x, -y)) -
                  (position(2 * x, 2 * y) - position(-2 * x, -2 * y))) /
                 (12 * h);
        };
        const LimitPoint at = evaluator.evaluate(cage.points, {f, u, v, 1});
        INFO(name << ", face " << f << ", at " << u << ' ' << v);
        const double size = std::max({at.du.norm(), at.dv.norm(), 0.1});
        const double error =
            std::max((at.du - difference(h, 0)).norm(), (at.dv - difference(0, h)).norm()) / size;
        CHECK(error < 1e-8);
        worst = std::max(worst, error);
        ++compared;
      }
    }
  }
  CHECK(compared > 2000);
  std::printf("derivatives against differences: worst %.1e at %d places\n", worst, compared);
}

TEST_CASE("evaluation is the same from a level and from finer ones, however near to a vertex") {
  for (const auto& [name, cage] : zoo::all()) {
    const std::vector<SurfaceLevel> levels = build_levels(cage, 3);
    const std::vector<Vec3> points = refine_points(levels, cage.points);
    const LimitEvaluator coarse(levels[0]), fine(levels[3]);
    for (Index f = 0; f < levels[0].face_count(); f += 2) {
      if (levels[0].face_vertices.row_size(f) != 4) continue;
      // Child 0 keeps corner 0 and the parameters' directions.
      Index child = f;
      for (int k = 0; k < 3; ++k) child = static_cast<Index>(levels[k].face_vertices.offsets[child]);
      for (const auto& [u, v] : {std::pair{0.9, 0.3}, {0.01, 0.7}, {0x1p-30, 0x1.8p-29}, {0x1.3p-90, 0.0}}) {
        const LimitPoint a = coarse.evaluate(cage.points, {f, u / 8, v / 8});
        const LimitPoint b = fine.evaluate(points, {child, u, v});
        INFO(name << ", face " << f << ", at " << u << ' ' << v);
        CHECK((a.position - b.position).norm() < 1e-13);
        const double size = std::max(a.du.norm(), a.dv.norm());
        CHECK((a.du - 8 * b.du).norm() < 1e-10 * size);
        CHECK((a.dv - 8 * b.dv).norm() < 1e-10 * size);
      }
    }
  }
}

TEST_CASE("neighbouring patches meet with one position, and one normal where no crease runs") {
  int smooth = 0;
  for (const auto& [name, cage] : zoo::all()) {
    const SurfaceLevel level = build_surface_level(cage);
    const LimitEvaluator evaluator(level);
    const auto at_edge = [&](Index f, Index e, double x) {
      const auto row = level.face_edges[f];
      const auto i = static_cast<Index>(std::find(row.begin(), row.end(), e) - row.begin());
      if (level.face_vertices[f][i] != level.edge_vertices[e][0]) x = 1 - x;
      if (row.size() != 4) {  // the halves belong to the child quads of both corners
        const auto n = static_cast<Index>(row.size());
        return x <= 0.5 ? LimitLocation{f, 2 * x, 0, i} : LimitLocation{f, 0, 2 - 2 * x, (i + 1) % n};
      }
      const std::array<std::array<double, 2>, 4> uv{{{x, 0}, {1, x}, {1 - x, 1}, {0, 1 - x}}};
      return LimitLocation{f, uv[i][0], uv[i][1]};
    };
    for (Index e = 0; e < level.edge_count(); ++e) {
      if (level.is_boundary_edge(e)) continue;
      for (const double x : {0.01, 0.3, 0.5, 0.8}) {
        const LimitPoint a = evaluator.evaluate(cage.points, at_edge(level.edge_faces[e][0], e, x));
        const LimitPoint b = evaluator.evaluate(cage.points, at_edge(level.edge_faces[e][1], e, x));
        INFO(name << ", edge " << e << ", at " << x);
        CHECK((a.position - b.position).norm() < 1e-13);
        if (level.edge_sharpness[e] >= infinitely_sharp) continue;
        const Vec3 normal_a = a.du.cross(a.dv), normal_b = b.du.cross(b.dv);
        if (normal_a.norm() < 1e-3) continue;  // a random cage may fold
        CHECK((normal_a.normalized() - normal_b.normalized()).norm() < 1e-9);
        ++smooth;
      }
    }
  }
  CHECK(smooth > 3000);
}

TEST_CASE("evaluation stencils are convex combinations and equal the evaluator") {
  for (const auto& [name, cage] : zoo::all()) {
    INFO(name);
    const SurfaceLevel level = build_surface_level(cage);
    const LimitEvaluator evaluator(level);
    zoo::Random random(7);
    std::vector<LimitLocation> locations;
    for (Index f = 0; f < level.face_count(); ++f) {
      locations.push_back({f, random.uniform(0, 1), random.uniform(0, 1), random.below(3)});
    }
    const EvaluationStencils rows = evaluation_stencils(evaluator, locations);
    const std::vector<Vec3> position = apply_stencils(rows.position, cage.points);
    const std::vector<Vec3> du = apply_stencils(rows.du, cage.points);
    for (Index r = 0; r < rows.position.size(); ++r) {
      const LimitPoint at = evaluator.evaluate(cage.points, locations[r]);
      CHECK((at.position - position[r]).norm() < 1e-13);
      CHECK((at.du - du[r]).norm() < 1e-11 * std::max(1.0, at.du.norm()));
      double sum = 0, smallest = 0, derivative_sum = 0;
      for (Offset k = rows.position.offsets[r]; k < rows.position.offsets[r + 1]; ++k) {
        sum += rows.position.weights[k];
        smallest = std::min(smallest, rows.position.weights[k]);
      }
      for (Offset k = rows.dv.offsets[r]; k < rows.dv.offsets[r + 1]; ++k)
        derivative_sum += rows.dv.weights[k];
      CHECK(std::abs(sum - 1) < 1e-13);
      CHECK(smallest > -1e-15);
      CHECK(std::abs(derivative_sum) < 1e-11);
    }
  }
}

TEST_CASE(
    "oversampled rows are the limits at vertices, edges' midpoints and faces' midpoints, with normals") {
  for (const auto& [name, cage] : zoo::all()) {
    INFO(name);
    const SurfaceLevel level = build_surface_level(cage);
    const LimitEvaluator evaluator(level);
    const LimitSamples samples = oversampled_limit_stencils(level);
    const Index V = level.vertex_count(), E = level.edge_count(), F = level.face_count();
    REQUIRE(samples.position.size() == V + E + F);
    const std::vector<Vec3> position = apply_stencils(samples.position, cage.points);
    const std::vector<Vec3> direct = oversampled_limit_points(level, cage.points);
    REQUIRE(direct.size() == position.size());
    for (std::size_t i = 0; i < direct.size(); ++i) CHECK((direct[i] - position[i]).norm() < 1e-13);
    const std::vector<Vec3> normals = sample_normals(samples, cage.points);
    const auto check = [&](Index sample, const LimitLocation& at, bool smooth) {
      const LimitPoint point = evaluator.evaluate(cage.points, at);
      CHECK((position[sample] - point.position).norm() < 1e-13);
      const Vec3 normal = point.du.cross(point.dv);
      if (!smooth || normal.norm() < 1e-3) return;
      CHECK((normals[sample].normalized() - normal.normalized()).norm() < 1e-9);
    };
    for (Index f = 0; f < F; ++f) {
      const bool quad = level.face_vertices.row_size(f) == 4;
      check(V + E + f, quad ? LimitLocation{f, 0.5, 0.5} : LimitLocation{f, 1, 1, 0}, true);
      for (Index i = 0; i < level.face_vertices.row_size(f); ++i) {
        const std::array<std::array<double, 2>, 4> middle{{{0.5, 0}, {1, 0.5}, {0.5, 1}, {0, 0.5}}};
        const Index e = level.face_edges[f][i];
        check(level.face_vertices[f][i], corner_location(level, f, i), false);
        check(V + e, quad ? LimitLocation{f, middle[i][0], middle[i][1]} : LimitLocation{f, 1, 0, i},
              level.edge_sharpness[e] < infinitely_sharp);
      }
    }
  }
}

TEST_CASE("normals are on the side from which faces are counter-clockwise") {
  // Flat cages with the faces counter-clockwise seen from +z, all kinds of vertices.
  zoo::Random random(3);
  for (int n = 2; n <= 12; ++n) {
    for (const bool closed : {true, false}) {
      if (closed && n == 2) continue;
      for (const double share : {0.0, 0.2, 0.6}) {
        Cage cage = zoo::fan(n, closed);
        for (Vec3& p : cage.points) p.z() = 0;
        zoo::add_tags(cage, random, zoo::Tags::mixed, share);
        const SurfaceLevel level = build_surface_level(cage);
        INFO("fan " << n << (closed ? " closed" : " open") << ", share of tags " << share);
        const SectorTangents tangents = sector_tangent_stencils(level);
        const std::vector<Vec3> u = apply_stencils(tangents.u, cage.points);
        const std::vector<Vec3> v = apply_stencils(tangents.v, cage.points);
        for (Index i = 0; i < level.vertex_count(); ++i) {
          for (Index s = tangents.first_sector[i]; s < tangents.first_sector[i + 1]; ++s) {
            INFO("vertex " << i << ", sector of " << tangents.faces.row_size(s));
            CHECK(u[s].cross(v[s]).z() > (tangents.faces.row_size(s) > 1 ? 1e-3 : -1e-12));
          }
        }
        const LimitEvaluator evaluator(level);
        for (Index f = 0; f < level.face_count(); ++f) {
          const LimitPoint at = evaluator.evaluate(cage.points, {f, 0.4, 0.3});
          CHECK(at.du.cross(at.dv).z() > 1e-3);
        }
      }
    }
  }
}

TEST_CASE("a sampled surface is watertight, keeps patches and lies on the limit surface") {
  for (const auto& [name, cage] : zoo::all()) {
    INFO(name);
    Cage named = cage;
    named.patch_names = {"even", "odd"};
    for (Index f = 0; f < named.faces.size(); ++f) named.face_patch[f] = f % 2;
    const SurfaceLevel level = build_surface_level(named);
    const SampledSurface sampled = sample_limit_surface(level, named.points, 2);
    const Topology before = topology_of(level), after = topology_of(sampled.topology);
    CHECK(before.euler == after.euler);
    CHECK(before.boundary_loops == after.boundary_loops);
    CHECK(static_cast<Index>(sampled.points.size()) == sampled.topology.vertex_count());
    CHECK(sampled.topology.face_count() == 4 * static_cast<Index>(level.face_vertices.values.size()));
    // The sample at a face's midpoint, through the evaluator.
    const LimitEvaluator evaluator(level);
    const auto patch_faces = [](const SurfaceLevel& of, Index patch) {
      return std::count(of.face_patch.begin(), of.face_patch.end(), patch);
    };
    Index odd_corners = 0;
    for (Index f = 0; f < level.face_count(); ++f) {
      odd_corners += f % 2 * level.face_vertices.row_size(f);
      const bool quad = level.face_vertices.row_size(f) == 4;
      const LimitPoint middle =
          evaluator.evaluate(named.points, quad ? LimitLocation{f, 0.5, 0.5} : LimitLocation{f, 1, 1, 0});
      const Index v = level.vertex_count() + level.edge_count() + f;
      CHECK((sampled.points[v] - middle.position).norm() < 1e-12);
      const Vec3 normal = middle.du.cross(middle.dv);
      if (normal.norm() > 1e-3) CHECK((sampled.normals[v] - normal.normalized()).norm() < 1e-8);
    }
    CHECK(patch_faces(sampled.topology, 1) == 4 * odd_corners);
  }
}
