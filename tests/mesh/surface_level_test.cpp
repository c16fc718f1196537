#include "core/mesh/surface_level.hpp"

#include <algorithm>
#include <set>

#include "core/base/error.hpp"
#include "core/subdivide/refine.hpp"
#include "tests/catch.hpp"
#include "tests/subdivide/cage_zoo.hpp"

using namespace flowcage;

namespace {

// Everything that surface_level.hpp says of a level.
void check_consistency(const SurfaceLevel& level) {
  Index sides = 0;
  for (Index f = 0; f < level.face_count(); ++f) {
    const auto vertices = level.face_vertices[f];
    const auto edges = level.face_edges[f];
    REQUIRE(vertices.size() == edges.size());
    for (std::size_t i = 0; i < vertices.size(); ++i) {
      const std::set<Index> ends{vertices[i], vertices[(i + 1) % vertices.size()]};
      const auto& edge = level.edge_vertices[edges[i]];
      REQUIRE(ends == std::set<Index>{edge[0], edge[1]});
      const auto& faces = level.edge_faces[edges[i]];
      REQUIRE((faces[0] == f || faces[1] == f));
      ++sides;
    }
  }
  Index inner = 0;
  for (Index e = 0; e < level.edge_count(); ++e) {
    REQUIRE(level.edge_faces[e][0] != no_index);
    inner += !level.is_boundary_edge(e);
    if (level.is_boundary_edge(e)) REQUIRE(level.edge_sharpness[e] >= infinitely_sharp);
  }
  REQUIRE(sides == level.edge_count() + inner);
  for (Index v = 0; v < level.vertex_count(); ++v) {
    const auto edges = level.vertex_edges[v];
    const auto faces = level.vertex_faces[v];
    const bool boundary = edges.size() == faces.size() + 1;
    REQUIRE((boundary || edges.size() == faces.size()));
    REQUIRE(boundary == level.is_boundary_edge(edges[0]));
    for (std::size_t i = 0; i < faces.size(); ++i) {
      // Counter-clockwise: the face leaves v along edge i and comes back along edge i + 1.
      const auto row = level.face_vertices[faces[i]];
      const auto side = static_cast<std::size_t>(std::find(row.begin(), row.end(), v) - row.begin());
      REQUIRE(side < row.size());
      REQUIRE(level.face_edges[faces[i]][side] == edges[i]);
      REQUIRE(level.face_edges[faces[i]][(side + row.size() - 1) % row.size()] ==
              edges[(i + 1) % edges.size()]);
    }
  }
}

}  // namespace

TEST_CASE("levels keep every rule of their layout, at the cage and below") {
  for (const auto& [name, cage] : zoo::all()) {
    INFO(name);
    for (const SurfaceLevel& level : build_levels(cage, 2)) check_consistency(level);
  }
}

TEST_CASE("edges of the cage have the smaller vertex first and are numbered by their vertices") {
  const SurfaceLevel level = build_surface_level(zoo::torus(5, 4));
  CHECK(std::is_sorted(level.edge_vertices.begin(), level.edge_vertices.end()));
  for (const auto& [a, b] : level.edge_vertices) CHECK(a < b);
}

TEST_CASE("topology of known shapes, kept by refinement") {
  struct Known {
    Cage cage;
    Index euler, components, loops, genus;
  };
  Cage two = zoo::cube();
  const Cage second = zoo::torus(4, 3);
  for (Index f = 0; f < second.faces.size(); ++f) {
    std::vector<Index> row(second.faces[f].begin(), second.faces[f].end());
    for (Index& v : row) v += static_cast<Index>(two.points.size());
    two.faces.push_row(row);
  }
  for (const Vec3& p : second.points) two.points.push_back(p + Vec3(20, 0, 0));
  two.face_patch.clear();
  std::set<std::array<int, 3>> eight;
  for (int i = 0; i < 5; ++i) {
    for (int j = 0; j < 3; ++j) {
      if (!(j == 1 && i % 2 == 1)) eight.insert({i, j, 0});
    }
  }
  const Known shapes[] = {{zoo::cube(), 2, 1, 0, 0},
                          {zoo::torus(5, 4), 0, 1, 0, 1},
                          {zoo::grid(3, 2), 1, 1, 1, 0},
                          {zoo::voxels(eight), -2, 1, 0, 2},
                          {two, 2, 2, 0, 1}};
  for (const Known& shape : shapes) {
    for (const SurfaceLevel& level : build_levels(shape.cage, 2)) {
      const Topology topology = topology_of(level);
      CHECK(topology.euler == shape.euler);
      CHECK(topology.components == shape.components);
      CHECK(topology.boundary_loops == shape.loops);
      CHECK(topology.genus == shape.genus);
    }
  }
}

TEST_CASE("sharpness: the larger of two tags, at most infinite, boundaries and lone corners sharp") {
  Cage cage = zoo::grid(2, 1);
  cage.creases = {{1, 4, 2.5}, {4, 1, 1.5}, {0, 1, 0.5}};
  cage.corners = {{1, 40}};
  const SurfaceLevel level = build_surface_level(cage);
  for (Index e = 0; e < level.edge_count(); ++e) {
    const bool middle = level.edge_vertices[e] == std::array<Index, 2>{1, 4};
    CHECK(level.edge_sharpness[e] == (middle ? 2.5 : infinitely_sharp));
  }
  CHECK(level.vertex_sharpness == std::vector<double>{10, 10, 10, 10, 0, 10});
}

TEST_CASE("a cage that is no manifold is refused with its place") {
  Cage bow =
      zoo::make_cage({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {-1, 0, 0}, {-1, -1, 0}}, {{0, 1, 2}, {0, 3, 4}});
  CHECK_THROWS_AS(build_surface_level(bow), Error);
  Cage third = zoo::grid(1, 1);
  third.points.emplace_back(0, 0, 1);
  third.points.emplace_back(0, 0, 2);
  third.faces.push_row(std::array<Index, 3>{0, 1, 4});
  third.faces.push_row(std::array<Index, 3>{0, 1, 5});
  third.face_patch.clear();
  CHECK_THROWS_AS(build_surface_level(third), Error);
  Cage crease = zoo::cube();
  crease.creases = {{0, 6, 1}};
  CHECK_THROWS_AS(build_surface_level(crease), Error);
  crease.creases = {{0, 999, 1}};
  CHECK_THROWS_AS(build_surface_level(crease), Error);
}
