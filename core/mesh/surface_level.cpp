#include "core/mesh/surface_level.hpp"

#include <algorithm>
#include <cassert>
#include <numeric>

#include "core/mesh/manifold_check.hpp"

namespace flowcage {
namespace {

// A directed side of a face: from the smaller to the larger vertex (forward) or back.
struct Side {
  Index small, large;
  Offset corner;  // position in face_vertices.values
  Index face;
  bool forward;
};

// Sides grouped by smaller vertex (counting sort), then by larger vertex, in face order.
std::vector<Side> sorted_sides(const Cage& cage) {
  const auto vertex_count = cage.points.size();
  std::vector<Offset> start(vertex_count + 1, 0);
  const auto for_each_side = [&](const auto& visit) {
    for (Index f = 0; f < cage.faces.size(); ++f) {
      const auto row = cage.faces[f];
      for (std::size_t i = 0; i < row.size(); ++i) {
        const Index a = row[i], b = row[i + 1 == row.size() ? 0 : i + 1];
        visit(Side{std::min(a, b), std::max(a, b), cage.faces.offsets[f] + static_cast<Offset>(i), f, a < b});
      }
    }
  };
  for_each_side([&](const Side& side) { ++start[side.small + 1]; });
  std::partial_sum(start.begin(), start.end(), start.begin());
  std::vector<Offset> next(start.begin(), start.end() - 1);
  std::vector<Side> sides(static_cast<std::size_t>(start.back()));
  for_each_side([&](const Side& side) { sides[next[side.small]++] = side; });
  for (std::size_t v = 0; v < vertex_count; ++v) {
    std::sort(sides.begin() + start[v], sides.begin() + start[v + 1], [](const Side& a, const Side& b) {
      return a.large != b.large ? a.large < b.large : a.corner < b.corner;
    });
  }
  return sides;
}

void number_edges(const Cage& cage, SurfaceLevel& level) {
  const std::vector<Side> sides = sorted_sides(cage);
  level.face_edges.offsets = level.face_vertices.offsets;
  level.face_edges.values.resize(level.face_vertices.values.size());
  for (std::size_t k = 0; k < sides.size();) {
    const Side& first = sides[k];
    std::size_t end = k + 1;
    while (end < sides.size() && sides[end].small == first.small && sides[end].large == first.large) ++end;
    assert(end - k <= 2);
    for (std::size_t side = k; side < end; ++side) {
      level.face_edges.values[sides[side].corner] = level.edge_count();
    }
    level.edge_vertices.push_back({first.small, first.large});
    level.edge_faces.push_back({first.face, end - k == 2 ? sides[k + 1].face : no_index});
    k = end;
  }
}

// The place of edge e in face f. Precondition: it is there.
Index side_in_face(const SurfaceLevel& level, Index f, Index e) {
  const auto row = level.face_edges[f];
  return static_cast<Index>(std::find(row.begin(), row.end(), e) - row.begin());
}

// Walks counter-clockwise round each vertex: from a face's outgoing edge to its incoming one, and on to the
// face behind that.
void order_rings(std::size_t vertex_count, SurfaceLevel& level) {
  struct Corner {
    Index face, side;
  };
  std::vector<Offset> start(vertex_count + 1, 0);
  for (const Index v : level.face_vertices.values) ++start[v + 1];
  std::partial_sum(start.begin(), start.end(), start.begin());
  std::vector<Offset> next(start.begin(), start.end() - 1);
  std::vector<Corner> corners(static_cast<std::size_t>(start.back()));
  for (Index f = 0; f < level.face_count(); ++f) {
    for (Index i = 0; i < level.face_vertices.row_size(f); ++i) {
      corners[next[level.face_vertices[f][i]]++] = {f, i};
    }
  }

  for (std::size_t v = 0; v < vertex_count; ++v) {
    // Boundary fans start where the outgoing edge has one face, closed ones at the first face.
    Corner at = corners[start[v]];
    for (Offset k = start[v]; k < start[v + 1]; ++k) {
      if (level.is_boundary_edge(level.face_edges[corners[k].face][corners[k].side])) {
        at = corners[k];
        break;
      }
    }
    const Index first_face = at.face;
    [[maybe_unused]] Offset visited = 0;
    while (true) {
      const auto sides = level.face_edges[at.face];
      const Index incoming = sides[(at.side == 0 ? sides.size() : at.side) - 1];
      level.vertex_edges.values.push_back(sides[at.side]);
      level.vertex_faces.values.push_back(at.face);
      ++visited;
      const auto& faces = level.edge_faces[incoming];
      const Index behind = faces[faces[0] == at.face ? 1 : 0];
      if (behind == no_index) level.vertex_edges.values.push_back(incoming);
      if (behind == no_index || behind == first_face) break;
      at = {behind, side_in_face(level, behind, incoming)};
    }
    assert(visited == start[v + 1] - start[v]);
    level.vertex_edges.offsets.push_back(static_cast<Offset>(level.vertex_edges.values.size()));
    level.vertex_faces.offsets.push_back(static_cast<Offset>(level.vertex_faces.values.size()));
  }
}

// Precondition: it is there.
Index find_edge(const SurfaceLevel& level, Index a, Index b) {
  for (const Index e : level.vertex_edges[a]) {
    const auto& ends = level.edge_vertices[e];
    if (ends[0] + ends[1] - a == b) return e;
  }
  assert(false);
  return no_index;
}

void set_sharpness(const Cage& cage, SurfaceLevel& level) {
  const auto vertex_count = level.vertex_count();
  level.edge_sharpness.assign(level.edge_vertices.size(), 0);
  level.vertex_sharpness.assign(static_cast<std::size_t>(vertex_count), 0);
  const auto sharpen = [](double& sharpness, double by) {
    sharpness = std::max(sharpness, std::min(by, infinitely_sharp));
  };
  for (const Cage::Crease& crease : cage.creases) {
    sharpen(level.edge_sharpness[find_edge(level, crease.a, crease.b)], crease.sharpness);
  }
  for (const Cage::Corner& corner : cage.corners) {
    sharpen(level.vertex_sharpness[corner.vertex], corner.sharpness);
  }
  for (Index e = 0; e < level.edge_count(); ++e) {
    if (level.is_boundary_edge(e)) level.edge_sharpness[e] = infinitely_sharp;
  }
  for (Index v = 0; v < vertex_count; ++v) {
    const bool boundary = level.vertex_edges.row_size(v) > level.vertex_faces.row_size(v);
    if (boundary && level.vertex_faces.row_size(v) == 1) level.vertex_sharpness[v] = infinitely_sharp;
  }
}

// Union-find over edges: the smallest member names a set.
Index root_of(std::vector<Index>& parent, Index v) {
  while (parent[v] != v) v = parent[v] = parent[parent[v]];
  return v;
}
void unite(std::vector<Index>& parent, Index a, Index b) {
  a = root_of(parent, a);
  b = root_of(parent, b);
  parent[std::max(a, b)] = std::min(a, b);
}

}  // namespace

SurfaceLevel build_surface_level(const Cage& cage) {
  require_manifold(cage);
  SurfaceLevel level;
  level.face_vertices = cage.faces;
  level.face_patch = cage.face_patch;
  level.face_patch.resize(static_cast<std::size_t>(cage.faces.size()), 0);
  number_edges(cage, level);
  order_rings(cage.points.size(), level);
  set_sharpness(cage, level);
  return level;
}

Topology topology_of(const SurfaceLevel& level) {
  std::vector<Index> component(static_cast<std::size_t>(level.vertex_count()));
  std::iota(component.begin(), component.end(), 0);
  std::vector<Index> loop = component;
  std::vector<char> on_boundary(component.size(), 0);
  for (Index e = 0; e < level.edge_count(); ++e) {
    const auto [a, b] = level.edge_vertices[e];
    unite(component, a, b);
    if (level.is_boundary_edge(e)) {
      unite(loop, a, b);
      on_boundary[a] = on_boundary[b] = 1;
    }
  }
  Topology topology;
  topology.euler = level.vertex_count() - level.edge_count() + level.face_count();
  for (Index v = 0; v < level.vertex_count(); ++v) {
    topology.components += component[v] == v;
    topology.boundary_loops += on_boundary[v] != 0 && loop[v] == v;
  }
  topology.genus = (2 * topology.components - topology.boundary_loops - topology.euler) / 2;
  return topology;
}

}  // namespace flowcage
