#include "core/mesh/mirror.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <map>

#include "core/limit/evaluate.hpp"
#include "core/limit/limit_stencils.hpp"
#include "core/subdivide/refine.hpp"
#include "tests/catch.hpp"
#include "tests/limit/half_cages.hpp"
#include "tests/subdivide/cage_zoo.hpp"

using namespace flowcage;

namespace {

constexpr double tolerance = 1e-13;

// The whole body's numbers of the half's vertices and edges; faces have the same.
struct Counterparts {
  std::vector<Index> vertices, edges;
};
Counterparts match(const SurfaceLevel& half, const SurfaceLevel& whole) {
  Counterparts of{std::vector<Index>(half.vertex_count(), no_index),
                  std::vector<Index>(half.edge_count(), no_index)};
  for (Index f = 0; f < half.face_count(); ++f) {
    REQUIRE(half.face_vertices.row_size(f) == whole.face_vertices.row_size(f));
    for (Index i = 0; i < half.face_vertices.row_size(f); ++i) {
      of.vertices[half.face_vertices[f][i]] = whole.face_vertices[f][i];
      of.edges[half.face_edges[f][i]] = whole.face_edges[f][i];
    }
  }
  return of;
}

// Closed rings start anywhere: turns those of the whole body to where the half's begin.
void align_rings(const SurfaceLevel& half, SurfaceLevel& whole) {
  const Counterparts of = match(half, whole);
  for (Index v = 0; v < half.vertex_count(); ++v) {
    const Index w = of.vertices[v];
    const auto edges = whole.vertex_edges[w];
    const auto faces = whole.vertex_faces[w];
    if (edges.size() > faces.size()) continue;
    const auto start = std::find(edges.begin(), edges.end(), of.edges[half.vertex_edges[v][0]]);
    const auto turn = start - edges.begin();
    std::rotate(edges.begin(), start, edges.end());
    std::rotate(faces.begin(), faces.begin() + turn, faces.end());
  }
}

struct Pair {
  std::vector<SurfaceLevel> half, whole;  // levels 0 .. depth, rings aligned
  std::vector<Vec3> half_points, whole_points;
};
Pair make_pair(const HalfCage& cage, int depth) {
  const Cage whole = whole_cage(cage);
  Pair pair{{half_level(cage)}, {build_surface_level(whole)}, cage.cage.points, whole.points};
  align_rings(pair.half[0], pair.whole[0]);
  for (int k = 0; k < depth; ++k) {
    pair.half.push_back(build_child_level(pair.half.back()));
    pair.whole.push_back(build_child_level(pair.whole.back()));
    align_rings(pair.half.back(), pair.whole.back());
  }
  return pair;
}

// Largest distance of half[i] from whole[counterpart[i]], relative to max(1, |whole|).
double worst(const std::vector<Vec3>& half, const std::vector<Vec3>& whole,
             const std::vector<Index>& counterpart) {
  REQUIRE(half.size() == counterpart.size());
  double largest = 0;
  for (std::size_t i = 0; i < half.size(); ++i) {
    const Vec3& other = whole[counterpart[i]];
    largest = std::max(largest, (half[i] - other).norm() / std::max(1.0, other.norm()));
  }
  return largest;
}

// By vertex: bit a where it lies in the plane of axis a.
std::vector<unsigned> planes_by_vertex(const SurfaceLevel& level) {
  std::vector<unsigned> planes(static_cast<std::size_t>(level.vertex_count()), 0);
  for (Index e = 0; e < level.edge_count(); ++e) {
    if (level.edge_mirror_axis[e] < 0) continue;
    for (const Index v : level.edge_vertices[e]) planes[v] |= 1U << level.edge_mirror_axis[e];
  }
  return planes;
}

// Counts points of plane vertices that leave their planes by as much as the last bit.
int count_astray(const SurfaceLevel& level, const std::vector<Vec3>& points) {
  const std::vector<unsigned> planes = planes_by_vertex(level);
  int astray = 0;
  for (Index v = 0; v < level.vertex_count(); ++v) {
    for (int axis = 0; axis < 3; ++axis) {
      if ((planes[v] >> axis & 1U) != 0 && points[v][axis] != level.mirrors.value[axis]) ++astray;
    }
  }
  return astray;
}

// A regular half sheet: vertices (i, j) at j 5 + i, x = 0 mirrored.
SurfaceLevel half_sheet() {
  const SurfaceLevel level = build_surface_level(zoo::grid(4, 4));
  return mirrored(level, 0, 0, edges_in(level, zoo::grid(4, 4).points, {0, 0}));
}

}  // namespace

TEST_CASE("the cages of these tests have one, two and three planes, and every kind of vertex in them") {
  std::array<int, 4> by_planes{};
  std::map<Index, int> by_faces;  // of a vertex in one plane
  int in_two_planes = 0, sharp = 0, at_open_edges = 0, polygons = 0;
  for (const HalfCage& cage : half_cages()) {
    ++by_planes[cage.planes.size()];
    const SurfaceLevel level = half_level(cage);
    const std::vector<unsigned> planes = planes_by_vertex(level);
    for (Index v = 0; v < level.vertex_count(); ++v) {
      if (planes[v] == 0) continue;
      const auto edges = level.vertex_edges[v];
      in_two_planes += std::popcount(planes[v]) == 2;
      ++by_faces[level.vertex_faces.row_size(v)];
      sharp += std::any_of(edges.begin(), edges.end(), [&](Index e) { return level.edge_sharpness[e] > 0; });
      at_open_edges += level.edge_mirror_axis[edges.front()] < 0 || level.edge_mirror_axis[edges.back()] < 0;
      for (const Index f : level.vertex_faces[v]) polygons += level.face_vertices.row_size(f) != 4;
    }
  }
  CHECK(by_planes[1] > 100);
  CHECK(by_planes[2] > 80);
  CHECK(by_planes[3] > 30);
  for (Index faces = 1; faces <= 5; ++faces) CHECK(by_faces[faces] > 0);
  CHECK(in_two_planes > 200);
  CHECK(sharp > 200);
  CHECK(at_open_edges > 100);
  CHECK(polygons > 200);
}

TEST_CASE("a regular vertex in the plane has the folded bicubic mask") {
  const StencilTable limits = limit_stencils(half_sheet());
  const Index vertex = 10;  // (0, 2)
  std::vector<std::pair<Index, double>> even, odd;
  for (Offset k = limits.offsets[vertex]; k < limits.offsets[vertex + 1]; ++k) {
    even.emplace_back(limits.indices[k], 36 * limits.axis_weights(1)[k]);
    odd.emplace_back(limits.indices[k], limits.axis_weights(0)[k]);
  }
  const std::vector<std::pair<Index, double>> known{{5, 4}, {6, 2}, {10, 16}, {11, 8}, {15, 4}, {16, 2}};
  REQUIRE(even.size() == known.size());
  for (std::size_t k = 0; k < known.size(); ++k) {
    CHECK(even[k].first == known[k].first);
    CHECK(even[k].second == Approx(known[k].second).epsilon(1e-14));
    CHECK(odd[k].second == 0);  // the point lies in the plane whatever the others do
  }
  CHECK(limits.axis_weights(2).data() == limits.weights.data());
  CHECK_FALSE(limits.of_vectors);
  CHECK(tangent_stencils(half_sheet()).v.of_vectors);
}

TEST_CASE("the limit of an even quadratic is a quadratic up to the plane, that of an odd cubic a cubic") {
  // Cubic B-splines with the control values i^2 and i^3 are i^2 + 1/3 and i^3 + i at the knots.
  std::vector<Vec3> points = zoo::grid(4, 4).points;
  for (Vec3& p : points) p = {p.x() * p.x() * p.x(), p.y(), p.x() * p.x()};
  const std::vector<Vec3> limits = apply_stencils(limit_stencils(half_sheet()), points);
  for (Index i = 0; i < 4; ++i) {
    CHECK(limits[10 + i].z() == Approx(i * i + 1.0 / 3).epsilon(1e-14));
    CHECK(limits[10 + i].x() == Approx(i * i * i + i).margin(1e-14));
  }
}

TEST_CASE("a mirrored half refines as the whole body does") {
  for (const HalfCage& cage : half_cages()) {
    INFO(cage.name);
    const Pair pair = make_pair(cage, 3);
    const std::vector<Index> counterpart = match(pair.half[3], pair.whole[3]).vertices;
    const std::vector<Vec3> whole = refine_points(pair.whole, pair.whole_points);
    const std::vector<Vec3> half = refine_points(pair.half, pair.half_points);
    CHECK(worst(half, whole, counterpart) < tolerance);
    CHECK(count_astray(pair.half[3], half) == 0);

    std::vector<Vec3> by_stencils = pair.half_points;
    for (int k = 0; k < 3; ++k) by_stencils = apply_stencils(refinement_stencils(pair.half[k]), by_stencils);
    CHECK(worst(by_stencils, whole, counterpart) < tolerance);
    CHECK(count_astray(pair.half[3], by_stencils) == 0);
  }
}

TEST_CASE("a mirrored half has the whole body's limit points and tangents") {
  Index sectors = 0;
  for (const HalfCage& cage : half_cages()) {
    INFO(cage.name);
    Pair pair = make_pair(cage, 2);
    for (const std::size_t k : {0, 2}) {
      const std::vector<SurfaceLevel> down(pair.half.begin(), pair.half.begin() + k + 1);
      const std::vector<Vec3> points = refine_points(down, pair.half_points);
      const std::vector<Vec3> whole_points = refine_points({pair.whole.data(), k + 1}, pair.whole_points);
      const SurfaceLevel &half = pair.half[k], &whole = pair.whole[k];
      const std::vector<Index> counterpart = match(half, whole).vertices;
      const std::vector<Vec3> limits = apply_stencils(limit_stencils(half), points);
      CHECK(worst(limits, apply_stencils(limit_stencils(whole), whole_points), counterpart) < tolerance);
      CHECK(count_astray(half, limits) == 0);

      const SectorTangents of_half = sector_tangent_stencils(half), of_whole = sector_tangent_stencils(whole);
      std::vector<Index> partner(static_cast<std::size_t>(of_half.faces.size()), no_index);
      for (Index v = 0; v < half.vertex_count(); ++v) {
        REQUIRE(of_half.first_sector[v] < of_half.first_sector[v + 1]);
        for (Index s = of_half.first_sector[v]; s < of_half.first_sector[v + 1]; ++s) {
          const auto faces = of_half.faces[s];
          REQUIRE_FALSE(faces.empty());
          for (Index w = of_whole.first_sector[counterpart[v]]; w < of_whole.first_sector[counterpart[v] + 1];
               ++w) {
            const auto all = of_whole.faces[w];
            const auto is_there = [&](Index f) { return std::find(all.begin(), all.end(), f) != all.end(); };
            if (std::all_of(faces.begin(), faces.end(), is_there)) partner[s] = w;
          }
          REQUIRE(partner[s] != no_index);
          ++sectors;
        }
        // The sectors hold each of the vertex's faces once.
        Index held = 0;
        for (Index s = of_half.first_sector[v]; s < of_half.first_sector[v + 1]; ++s) {
          held += of_half.faces.row_size(s);
        }
        CHECK(held == half.vertex_faces.row_size(v));
      }
      for (const auto tangent : {&SectorTangents::u, &SectorTangents::v}) {
        CHECK(worst(apply_stencils(of_half.*tangent, points), apply_stencils(of_whole.*tangent, whole_points),
                    partner) < tolerance);
      }
      // The first sector's are those of tangent_stencils.
      const std::vector<Vec3> first = apply_stencils(tangent_stencils(half).u, points);
      const std::vector<Vec3> all = apply_stencils(of_half.u, points);
      CHECK(worst(first, all, {of_half.first_sector.begin(), of_half.first_sector.end() - 1}) == 0);
    }
  }
  CHECK(sectors > 30000);
}

TEST_CASE("oversampled limits and sampled surfaces of a mirrored half are the whole body's") {
  for (const HalfCage& cage : half_cages()) {
    INFO(cage.name);
    const Pair pair = make_pair(cage, 1);
    const std::vector<Index> counterpart = match(pair.half[1], pair.whole[1]).vertices;
    const LimitSamples half = oversampled_limit_stencils(pair.half[0]),
                       whole = oversampled_limit_stencils(pair.whole[0]);
    const std::vector<Vec3> positions = apply_stencils(half.position, pair.half_points);
    CHECK(worst(positions, apply_stencils(whole.position, pair.whole_points), counterpart) < tolerance);
    CHECK(count_astray(pair.half[1], positions) == 0);

    const std::vector<Vec3> normals = sample_normals(half, pair.half_points);
    const SampledSurface surface = sample_limit_surface(pair.half[0], pair.half_points, 1);
    const SampledSurface whole_surface = sample_limit_surface(pair.whole[0], pair.whole_points, 1);
    CHECK(worst(surface.points, whole_surface.points, counterpart) < tolerance);
    const SectorTangents sectors = sector_tangent_stencils(pair.whole[1]);
    for (std::size_t i = 0; i < normals.size(); ++i) {
      const Index w = counterpart[i];
      if (sectors.first_sector[w + 1] - sectors.first_sector[w] > 1) continue;  // which is first may differ
      const Vec3& normal = whole_surface.normals[w];
      CHECK((surface.normals[i] - normal).norm() < 1e-11);
      if (!normal.isZero(0)) CHECK((normals[i].normalized() - normal).norm() < 1e-11);
    }
  }
}

TEST_CASE("a mirrored half is evaluated as the whole body is") {
  zoo::Random random(3);
  for (const HalfCage& cage : half_cages()) {
    INFO(cage.name);
    const Pair pair = make_pair(cage, 0);
    const LimitEvaluator half(pair.half[0]), whole(pair.whole[0]);
    std::vector<LimitLocation> places;
    for (Index f = 0; f < pair.half[0].face_count(); ++f) {
      const Index corners = pair.half[0].face_vertices.row_size(f);
      for (int k = 0; k < 6; ++k) {
        LimitLocation at{f, random.uniform(0, 1), random.uniform(0, 1), random.below(corners)};
        if (k % 3 == 1) at.u = random.below(2);
        if (k % 3 == 2) at.v = random.below(2);
        places.push_back(at);
      }
    }
    const EvaluationStencils rows = evaluation_stencils(half, places);
    const std::vector<Vec3> position = apply_stencils(rows.position, pair.half_points),
                            du = apply_stencils(rows.du, pair.half_points),
                            dv = apply_stencils(rows.dv, pair.half_points);
    const auto close = [](const Vec3& a, const Vec3& b) {
      return (a - b).norm() <= tolerance * std::max(1.0, b.norm());
    };
    for (std::size_t i = 0; i < places.size(); ++i) {
      const LimitPoint one = half.evaluate(pair.half_points, places[i]),
                       other = whole.evaluate(pair.whole_points, places[i]);
      CHECK(close(one.position, other.position));
      CHECK(close(one.du, other.du));
      CHECK(close(one.dv, other.dv));
      CHECK(close(position[i], other.position));
      CHECK(close(du[i], other.du));
      CHECK(close(dv[i], other.dv));
    }
  }
}

TEST_CASE("normals at the plane lie in it") {
  int checked = 0;
  for (const HalfCage& cage : half_cages()) {
    const SurfaceLevel level = half_level(cage);
    const std::vector<unsigned> planes = planes_by_vertex(level);
    const TangentStencils tangents = tangent_stencils(level);
    const std::vector<Vec3> u = apply_stencils(tangents.u, cage.cage.points),
                            v = apply_stencils(tangents.v, cage.cage.points);
    for (Index i = 0; i < level.vertex_count(); ++i) {
      const auto edges = level.vertex_edges[i];
      const bool smooth =
          level.vertex_sharpness[i] == 0 &&
          std::all_of(edges.begin(), edges.end(), [&](Index e) { return level.edge_sharpness[e] == 0; });
      const Vec3 across = u[i].cross(v[i]);
      if (!smooth || level.vertex_faces.row_size(i) < 2 || across.norm() < 1e-3) continue;
      for (int axis = 0; axis < 3; ++axis) {
        if ((planes[i] >> axis & 1U) == 0) continue;
        INFO(cage.name << ", vertex " << i);
        CHECK(std::abs(across.normalized()[axis]) < 1e-14);
        ++checked;
      }
    }
  }
  CHECK(checked > 200);
}

TEST_CASE("a mirrored half moves with affine maps that keep the plane") {
  for (const HalfCage& cage : half_cages()) {
    if (cage.planes.size() != 1) continue;
    INFO(cage.name);
    const auto [axis, value] = cage.planes[0];
    Eigen::Matrix3d matrix;
    matrix << 1.3, 0.4, -0.2, 0.1, 0.8, 0.5, -0.3, 0.2, 1.1;
    for (int other = 0; other < 3; ++other) {
      if (other != axis) matrix(axis, other) = matrix(other, axis) = 0;
    }
    Vec3 shift(0.3, -0.6, 0.9);
    shift[axis] = value - matrix(axis, axis) * value;
    const auto moved = [&](std::vector<Vec3> points) {
      for (Vec3& p : points) p = matrix * p + shift;
      return points;
    };
    const std::vector<SurfaceLevel> levels{half_level(cage), build_child_level(half_level(cage))};
    std::vector<Index> same(static_cast<std::size_t>(levels[1].vertex_count()));
    for (std::size_t i = 0; i < same.size(); ++i) same[i] = static_cast<Index>(i);
    const auto& points = cage.cage.points;
    CHECK(worst(refine_points(levels, moved(points)), moved(refine_points(levels, points)), same) <
          tolerance);
    const StencilTable limits = oversampled_limit_stencils(levels[0]).position;
    CHECK(worst(apply_stencils(limits, moved(points)), moved(apply_stencils(limits, points)), same) <
          tolerance);
  }
}

TEST_CASE("mirrored tables join with plain ones") {
  const SurfaceLevel level = half_sheet();
  std::vector<Vec3> points = zoo::grid(4, 4).points;
  const StencilTable mirror = limit_stencils(level),
                     plain = limit_stencils(build_surface_level(zoo::grid(4, 4)));
  const auto check = [&](const StencilTable& a, const StencilTable& b) {
    std::vector<Vec3> apart = apply_stencils(a, points);
    const std::vector<Vec3> second = apply_stencils(b, points);
    apart.insert(apart.end(), second.begin(), second.end());
    const std::vector<Vec3> joined = apply_stencils(concatenate(a, b), points);
    REQUIRE(joined.size() == apart.size());
    for (std::size_t i = 0; i < joined.size(); ++i) CHECK((joined[i] - apart[i]).norm() < 1e-14);
  };
  check(mirror, plain);
  check(plain, mirror);
  check(mirror, refinement_stencils(level));
  CHECK(concatenate(tangent_stencils(level).u, tangent_stencils(level).v).of_vectors);
}

TEST_CASE("without mirrored edges every bit is as without mirrors") {
  for (const auto& [name, cage] : zoo::all()) {
    INFO(name);
    const SurfaceLevel level = build_surface_level(cage);
    const SurfaceLevel with = mirrored(level, 1, 0, {});
    const auto same = [](const StencilTable& plain, const StencilTable& folded) {
      CHECK(plain.mirrored_weights[1].empty());
      CHECK(plain.offsets == folded.offsets);
      CHECK(plain.indices == folded.indices);
      CHECK(plain.weights == folded.weights);
      CHECK(plain.weights == folded.mirrored_weights[1]);
    };
    same(limit_stencils(level), limit_stencils(with));
    same(tangent_stencils(level).v, tangent_stencils(with).v);
    same(refinement_stencils(level), refinement_stencils(with));
    same(oversampled_limit_stencils(level).position, oversampled_limit_stencils(with).position);
    const std::vector<SurfaceLevel> plain{level, build_child_level(level)},
        folded{with, build_child_level(with)};
    CHECK(refine_points(plain, cage.points) == refine_points(folded, cage.points));
  }
}
