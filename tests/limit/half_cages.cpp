#include "tests/limit/half_cages.hpp"

#include <cmath>
#include <numbers>
#include <optional>
#include <set>

#include "core/base/error.hpp"
#include "core/mesh/mirror.hpp"
#include "tests/subdivide/cage_zoo.hpp"

namespace flowcage {
namespace {

using Plane = HalfCage::Plane;
using Faces = std::vector<std::vector<Index>>;

std::set<Index> vertices_in(const SurfaceLevel& level, const std::vector<Vec3>& points, const Plane& plane) {
  std::set<Index> vertices;
  for (const Index e : edges_in(level, points, plane)) {
    vertices.insert(level.edge_vertices[e].begin(), level.edge_vertices[e].end());
  }
  return vertices;
}

// Without the faces that lie in a plane, and without the vertices that no face has any more.
Cage without_faces_in(const Cage& closed, const std::vector<Plane>& planes) {
  std::vector<Vec3> points;
  std::vector<Index> number(closed.points.size(), no_index);
  Faces faces;
  for (Index f = 0; f < closed.faces.size(); ++f) {
    bool dropped = false;
    for (const Plane& plane : planes) {
      bool inside = true;
      for (const Index v : closed.faces[f]) inside = inside && closed.points[v][plane.axis] == plane.value;
      dropped = dropped || inside;
    }
    if (dropped) continue;
    faces.emplace_back();
    for (const Index v : closed.faces[f]) {
      if (number[v] == no_index) {
        number[v] = static_cast<Index>(points.size());
        points.push_back(closed.points[v]);
      }
      faces.back().push_back(number[v]);
    }
  }
  return zoo::make_cage(points, faces);
}

Cage half_torus(int around, int across) {
  std::vector<Vec3> points;
  Faces faces;
  for (int i = 0; i <= around; ++i) {
    for (int j = 0; j < across; ++j) {
      const double a = std::numbers::pi * i / around, b = 2 * std::numbers::pi * j / across,
                   r = 3 + std::cos(b);
      points.emplace_back(r * std::cos(a), i % around == 0 ? 0 : r * std::sin(a), std::sin(b));
      const int j1 = (j + 1) % across;
      if (i < around) {
        faces.push_back({i * across + j, (i + 1) * across + j, (i + 1) * across + j1, i * across + j1});
      }
    }
  }
  return zoo::make_cage(points, faces);
}

// n faces round vertex 0 between y = 0 and y = 0 (half a turn) or x = 0.
Cage part_fan(int n, bool half_turn) {
  Cage cage = zoo::fan(n, false);
  for (Index v = 1; v <= 2 * n + 1; ++v) {
    Vec3& p = cage.points[v];
    const double a = (half_turn ? 1 : 0.5) * std::numbers::pi * (v - 1) / (2 * n), r = p.head<2>().norm();
    p = {r * std::cos(a), r * std::sin(a), p.z()};
  }
  cage.points[1].y() = 0;
  cage.points[2 * n + 1][half_turn ? 1 : 0] = 0;
  return cage;
}

// Moves points at random, those of a plane inside of it, and the planes to `values`.
void perturb_within(HalfCage& half, zoo::Random& random, const Vec3& values) {
  const std::vector<Vec3> before = half.cage.points;
  zoo::perturb(half.cage, random, 0.1);
  for (std::size_t v = 0; v < before.size(); ++v) half.cage.points[v] += values;
  for (Plane& plane : half.planes) {
    for (std::size_t v = 0; v < before.size(); ++v) {
      if (before[v][plane.axis] == plane.value) half.cage.points[v][plane.axis] = values[plane.axis];
    }
    plane.value = values[plane.axis];
  }
}

// The whole body is a cage too: no inner edge joins two vertices of a plane, which would be there twice.
bool is_usable(const HalfCage& half) {
  try {
    const SurfaceLevel level = build_surface_level(half.cage);
    for (const Plane& plane : half.planes) {
      const std::set<Index> inside = vertices_in(level, half.cage.points, plane);
      for (Index e = 0; e < level.edge_count(); ++e) {
        const auto [a, b] = level.edge_vertices[e];
        if (!level.is_boundary_edge(e) && inside.contains(a) && inside.contains(b)) return false;
      }
    }
    build_surface_level(whole_cage(half));
  } catch (const Error&) {
    return false;
  }
  return true;
}

}  // namespace

std::vector<Index> edges_in(const SurfaceLevel& level, const std::vector<Vec3>& points, const Plane& plane) {
  std::vector<Index> edges;
  for (Index e = 0; e < level.edge_count(); ++e) {
    const auto [a, b] = level.edge_vertices[e];
    if (level.is_boundary_edge(e) && points[a][plane.axis] == plane.value &&
        points[b][plane.axis] == plane.value) {
      edges.push_back(e);
    }
  }
  return edges;
}

SurfaceLevel half_level(const HalfCage& half) {
  SurfaceLevel level = build_surface_level(half.cage);
  for (const Plane& plane : half.planes) {
    const std::vector<Index> edges = edges_in(level, half.cage.points, plane);
    level = mirrored(std::move(level), plane.axis, plane.value, edges);
  }
  for (const Cage::Crease& crease : half.cage.creases) {
    for (Index e = 0; e < level.edge_count(); ++e) {
      const auto [a, b] = level.edge_vertices[e];
      const bool same = (a == crease.a && b == crease.b) || (a == crease.b && b == crease.a);
      if (same) level.edge_sharpness[e] = std::max(level.edge_sharpness[e], crease.sharpness);
    }
  }
  for (const Cage::Corner& corner : half.cage.corners) {
    double& sharpness = level.vertex_sharpness[corner.vertex];
    sharpness = std::max(sharpness, corner.sharpness);
  }
  return level;
}

Cage whole_cage(const HalfCage& half) {
  Cage cage = half.cage;
  for (const Plane& plane : half.planes) {
    const std::set<Index> inside = vertices_in(build_surface_level(cage), cage.points, plane);
    const std::vector<Vec3> own = cage.points;
    std::vector<Index> image(own.size());
    for (Index v = 0; v < static_cast<Index>(own.size()); ++v) {
      image[v] = v;
      if (inside.contains(v)) continue;
      image[v] = static_cast<Index>(cage.points.size());
      cage.points.push_back(own[v]);
      cage.points.back()[plane.axis] = 2 * plane.value - own[v][plane.axis];
    }
    const Index faces = cage.faces.size();
    for (Index f = 0; f < faces; ++f) {
      const std::vector<Index> row(cage.faces[f].begin(), cage.faces[f].end());
      std::vector<Index> turned{image[row[0]]};
      for (std::size_t i = row.size() - 1; i > 0; --i) turned.push_back(image[row[i]]);
      cage.faces.push_row(turned);
    }
    const std::vector<Cage::Crease> creases = cage.creases;
    for (const Cage::Crease& c : creases) cage.creases.push_back({image[c.a], image[c.b], c.sharpness});
    const std::vector<Cage::Corner> corners = cage.corners;
    for (const Cage::Corner& c : corners) cage.corners.push_back({image[c.vertex], c.sharpness});
    cage.face_patch.assign(static_cast<std::size_t>(cage.faces.size()), 0);
  }
  return cage;
}

std::vector<HalfCage> half_cages() {
  const Plane x{0, 0}, y{1, 0}, z{2, 0};
  std::set<std::array<int, 3>> block, bracket, ring;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      if (i < 2 && j < 2) block.insert({{i, j, 0}, {i, j, 1}});
      if (i == 0 || j == 0) bracket.insert({i, j, 0});
      if (!(i == 1 && j == 1)) ring.insert({i, j, 0});
    }
  }
  std::vector<HalfCage> plain;
  const auto add = [&](std::string name, Cage cage, std::vector<Plane> planes) {
    plain.push_back({std::move(name), std::move(cage), std::move(planes)});
  };
  const std::vector<std::vector<Plane>> choices{{x}, {y}, {z}, {y, x}, {x, z}, {x, y, z}, {z, x, y}};
  for (const auto& planes : choices) {
    const std::string in = std::to_string(planes.size()) + " from axis " + std::to_string(planes[0].axis);
    add("cube, planes " + in, without_faces_in(zoo::cube(), planes), planes);
    add("block, planes " + in, without_faces_in(zoo::voxels(block), planes), planes);
    add("bracket, planes " + in, without_faces_in(zoo::voxels(bracket), planes), planes);
  }
  add("ring", without_faces_in(zoo::voxels(ring), {x}), {x});
  add("quarter ring", without_faces_in(zoo::voxels(ring), {x, z}), {x, z});
  add("half torus 3x4", half_torus(3, 4), {y});
  add("half torus 2x5", half_torus(2, 5), {y});
  add("grid 3x4", zoo::grid(3, 4), {x});
  add("grid 1x3, sides", zoo::grid(1, 3), {y});
  add("quarter grid 3x2", zoo::grid(3, 2), {y, x});
  add("quarter grid 1x1", zoo::grid(1, 1), {x, y});
  for (const int n : {1, 2, 3, 4, 5}) add("half fan " + std::to_string(n), part_fan(n, true), {y});
  for (const int n : {1, 2, 3}) add("quarter fan " + std::to_string(n), part_fan(n, false), {y, x});

  zoo::Random random(20260102);
  std::vector<HalfCage> all;
  using zoo::Tags;
  for (const HalfCage& base : plain) {
    for (const Tags tags : {Tags::none, Tags::infinite, Tags::semi_sharp, Tags::mixed}) {
      for (const bool scrambled : {false, true}) {
        // A scramble may join vertices of the plane: then another is tried, and none on the smallest cages.
        for (int attempt = 0; attempt < 20; ++attempt) {
          HalfCage half = base;
          if (scrambled) zoo::scramble(half.cage, random, 8);
          perturb_within(half, random, Vec3(0.7, -1.3, 2.1) * (attempt % 2));
          zoo::add_tags(half.cage, random, tags, 0.2);
          half.name +=
              (scrambled ? ", scrambled, tags " : ", tags ") + std::to_string(static_cast<int>(tags));
          if (!is_usable(half)) continue;
          all.push_back(std::move(half));
          break;
        }
      }
    }
  }
  return all;
}

}  // namespace flowcage
