#include "core/limit/limit_stencils.hpp"

#include "core/limit/limit_masks.hpp"
#include "tests/catch.hpp"
#include "tests/limit/local_limit.hpp"
#include "tests/subdivide/cage_zoo.hpp"

using namespace flowcage;

namespace {

double worst_distance(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  REQUIRE(a.size() == b.size());
  double worst = 0;
  for (std::size_t i = 0; i < a.size(); ++i) worst = std::max(worst, (a[i] - b[i]).norm());
  return worst;
}

std::vector<double> row_sums(const StencilTable& table) {
  std::vector<double> sums(static_cast<std::size_t>(table.size()), 0);
  for (Index r = 0; r < table.size(); ++r) {
    for (Offset k = table.offsets[r]; k < table.offsets[r + 1]; ++k) sums[r] += table.weights[k];
  }
  return sums;
}

}  // namespace

TEST_CASE("a dart's limit mask of valence 3 is the known one") {
  const int sharp[] = {1};
  RingWeights mask;
  limit_position_mask({VertexRule::dart, 3, 3, sharp}, mask);
  CHECK(mask.vertex == Approx(0.405).epsilon(1e-12));
  CHECK(mask.edges[1] == Approx(0.2).epsilon(1e-12));
  CHECK(mask.edges[0] == Approx(0.15).epsilon(1e-12));
  CHECK(mask.edges[2] == Approx(0.15).epsilon(1e-12));
  CHECK(mask.faces[0] == Approx(0.0275).epsilon(1e-12));
  CHECK(mask.faces[1] == Approx(0.0275).epsilon(1e-12));
  CHECK(mask.faces[2] == Approx(0.04).epsilon(1e-12));
}

TEST_CASE("limits are those of 120 refinements, whatever the vertex") {
  for (const auto& [name, cage] : zoo::all()) {
    INFO(name);
    const SurfaceLevel level = build_surface_level(cage);
    const std::vector<Vec3> limits = apply_stencils(limit_stencils(level), cage.points);
    for (Index v = 0; v < level.vertex_count(); v += 2) {
      INFO("vertex " << v << ", edges " << level.vertex_edges.row_size(v));
      CHECK((refined_ring(level, cage.points, {v, 120}).points[0] - limits[v]).norm() < 1e-13);
    }
  }
}

TEST_CASE("limit rows sum to 1, tangent rows to 0") {
  for (const auto& [name, cage] : zoo::all()) {
    INFO(name);
    const SurfaceLevel level = build_surface_level(cage);
    for (const double sum : row_sums(limit_stencils(level))) CHECK(sum == Approx(1).epsilon(1e-14));
    const TangentStencils tangents = tangent_stencils(level);
    for (const double sum : row_sums(tangents.u)) CHECK(std::abs(sum) < 1e-13);
    for (const double sum : row_sums(tangents.v)) CHECK(std::abs(sum) < 1e-13);
  }
}

TEST_CASE("limit rows are invariant under refinement") {
  for (const auto& [name, cage] : zoo::all()) {
    INFO(name);
    const std::vector<SurfaceLevel> levels = build_levels(cage, 3);
    const std::vector<Vec3> limits = apply_stencils(limit_stencils(levels[0]), cage.points);
    const std::vector<Vec3> finer =
        apply_stencils(limit_stencils(levels[3]), refine_points(levels, cage.points));
    CHECK(worst_distance(limits, {finer.begin(), finer.begin() + levels[0].vertex_count()}) < 1e-14 * 8);
  }
}

TEST_CASE("the limit normal is that of a deep ring") {
  int compared = 0;
  for (const auto& [name, cage] : zoo::all()) {
    const SurfaceLevel level = build_surface_level(cage);
    const SectorTangents tangents = sector_tangent_stencils(level);
    const std::vector<Vec3> u = apply_stencils(tangents.u, cage.points),
                            v = apply_stencils(tangents.v, cage.points);
    for (Index i = 0; i < level.vertex_count(); ++i) {
      const LocalRing ring = refined_ring(level, cage.points, {i, 100, true});
      const auto ring_faces = ring.level.vertex_faces[0];
      for (Index s = tangents.first_sector[i]; s < tangents.first_sector[i + 1]; ++s) {
        const auto faces = tangents.faces[s];
        const auto sharp_edges =
            std::count_if(ring.level.vertex_edges[0].begin(), ring.level.vertex_edges[0].end(),
                          [&](Index e) { return ring.level.edge_sharpness[e] > 0; });
        const bool corner = ring.level.vertex_sharpness[0] > 0 || sharp_edges > 2;
        const bool crease = faces.size() < ring_faces.size() ||
                            level.vertex_edges.row_size(i) > level.vertex_faces.row_size(i);
        // Sectors without a tangent plane: corners of several faces; creases of one face or more than three.
        if (corner ? faces.size() > 1 : crease && (faces.size() == 1 || faces.size() > 3)) continue;
        if (level.vertex_faces.row_size(i) == 2) continue;  // valence 2
        INFO(name << ", vertex " << i << ", sector of " << faces.size() << " faces of " << ring_faces.size());
        const Vec3 normal = u[s].cross(v[s]).normalized();
        for (std::size_t k = 0; k < ring_faces.size(); ++k) {
          // The deep ring keeps the order of the faces.
          const Index parent_face = level.vertex_faces[i][static_cast<Index>(k)];
          if (std::find(faces.begin(), faces.end(), parent_face) == faces.end()) continue;
          const auto other_end = [&](std::size_t edge) {
            const auto& edges = ring.level.vertex_edges[0];
            const auto [a, b] = ring.level.edge_vertices[edges[edge % edges.size()]];
            return Vec3(ring.points[a + b] - ring.points[0]);
          };
          const Vec3 face_normal = other_end(k).cross(other_end(k + 1)).normalized();
          CHECK((face_normal - normal).norm() < 1e-3);
          ++compared;
        }
      }
    }
  }
  CHECK(compared > 2000);
}
