#include "core/subdivide/refine.hpp"

#include <cassert>
#include <limits>

#include "core/base/error.hpp"
#include "core/base/parallel.hpp"
#include "core/mesh/mirror.hpp"
#include "core/mesh/stencil_builder.hpp"
#include "core/subdivide/masks.hpp"

// Notation: V, E, F, C count the parent's vertices, edges, faces and corners of faces. Child vertices: parent
// vertices, V + e, V + E + f. Child edges: 2 e + s is the half of e at its end s, 2 E + c goes from the edge
// point of the side that starts at corner c to the face point. Child face c is the one at corner c.

namespace flowcage {
namespace {

constexpr Offset loop_grain = 8192;

struct Counts {
  Index V, E, F;
  Offset C;
};
Counts counts_of(const SurfaceLevel& level) {
  return {level.vertex_count(), level.edge_count(), level.face_count(), level.face_vertices.offsets.back()};
}

// Which end of edge e is v.
Index end_at(const SurfaceLevel& level, Index e, Index v) {
  return level.edge_vertices[e][0] == v ? 0 : 1;
}

// The place of `value` in a row. Precondition: it is there.
template <typename Row>
Index place_in(const Row& row, Index value) {
  Index i = 0;
  while (row[i] != value) ++i;
  return i;
}

Index next_in(Index i, Index n) {
  return i + 1 == n ? 0 : i + 1;
}
Index previous_in(Index i, Index n) {
  return (i == 0 ? n : i) - 1;
}

void make_child_faces(const SurfaceLevel& parent, SurfaceLevel& child) {
  const Counts n = counts_of(parent);
  child.face_vertices.offsets.resize(static_cast<std::size_t>(n.C + 1));
  child.face_vertices.values.resize(static_cast<std::size_t>(4 * n.C));
  child.face_edges.values.resize(child.face_vertices.values.size());
  child.face_patch.resize(static_cast<std::size_t>(n.C));
  parallel_for(n.F, loop_grain, [&](Offset begin, Offset end) {
    for (Index f = static_cast<Index>(begin); f < end; ++f) {
      const auto vertices = parent.face_vertices[f];
      const auto edges = parent.face_edges[f];
      const auto size = static_cast<Index>(vertices.size());
      const Index first = static_cast<Index>(parent.face_vertices.offsets[f]);
      for (Index i = 0; i < size; ++i) {
        const Index h = previous_in(i, size);
        const Index c = first + i;
        Index* const v = child.face_vertices.values.data() + 4 * static_cast<Offset>(c);
        v[0] = vertices[i];
        v[1] = n.V + edges[i];
        v[2] = n.V + n.E + f;
        v[3] = n.V + edges[h];
        Index* const e = child.face_edges.values.data() + 4 * static_cast<Offset>(c);
        e[0] = 2 * edges[i] + end_at(parent, edges[i], vertices[i]);
        e[1] = 2 * n.E + c;
        e[2] = 2 * n.E + first + h;
        e[3] = 2 * edges[h] + end_at(parent, edges[h], vertices[i]);
        child.face_vertices.offsets[c + 1] = 4 * (static_cast<Offset>(c) + 1);
        child.face_patch[c] = parent.face_patch[f];
      }
    }
  });
  child.face_edges.offsets = child.face_vertices.offsets;
}

void make_child_edges(const SurfaceLevel& parent, SurfaceLevel& child) {
  const Counts n = counts_of(parent);
  const auto count = static_cast<std::size_t>(2 * static_cast<Offset>(n.E) + n.C);
  child.edge_vertices.resize(count);
  child.edge_faces.resize(count);
  child.edge_sharpness.assign(count, 0);
  child.mirrors = parent.mirrors;
  if (parent.mirrors.any()) child.edge_mirror_axis.assign(count, -1);
  parallel_for(n.E, loop_grain, [&](Offset begin, Offset end) {
    for (Index e = static_cast<Index>(begin); e < end; ++e) {
      const double sharpness = decayed_sharpness(parent.edge_sharpness[e]);
      for (Index s = 0; s < 2; ++s) {
        child.edge_vertices[2 * e + s] = {parent.edge_vertices[e][s], n.V + e};
        child.edge_sharpness[2 * e + s] = sharpness;
        if (parent.mirrors.any()) child.edge_mirror_axis[2 * e + s] = parent.edge_mirror_axis[e];
      }
      child.edge_faces[2 * e] = child.edge_faces[2 * e + 1] = {no_index, no_index};
      for (Index side = 0; side < 2; ++side) {
        const Index f = parent.edge_faces[e][side];
        if (f == no_index) continue;
        const auto edges = parent.face_edges[f];
        const auto size = static_cast<Index>(edges.size());
        const Index i = place_in(edges, e);
        const Index first = static_cast<Index>(parent.face_vertices.offsets[f]);
        const Index s = end_at(parent, e, parent.face_vertices[f][i]);
        child.edge_faces[2 * e + s][side] = first + i;
        child.edge_faces[2 * e + 1 - s][side] = first + next_in(i, size);
      }
    }
  });
  parallel_for(n.F, loop_grain, [&](Offset begin, Offset end) {
    for (Index f = static_cast<Index>(begin); f < end; ++f) {
      const auto edges = parent.face_edges[f];
      const auto size = static_cast<Index>(edges.size());
      const Index first = static_cast<Index>(parent.face_vertices.offsets[f]);
      for (Index i = 0; i < size; ++i) {
        child.edge_vertices[2 * n.E + first + i] = {n.V + edges[i], n.V + n.E + f};
        child.edge_faces[2 * n.E + first + i] = {first + i, first + next_in(i, size)};
      }
    }
  });
}

void make_child_ring_offsets(const SurfaceLevel& parent, SurfaceLevel& child) {
  const Counts n = counts_of(parent);
  auto& edge_offsets = child.vertex_edges.offsets;
  auto& face_offsets = child.vertex_faces.offsets;
  edge_offsets = parent.vertex_edges.offsets;
  face_offsets = parent.vertex_faces.offsets;
  const auto count = static_cast<std::size_t>(n.V) + n.E + n.F + 1;
  edge_offsets.resize(count);
  face_offsets.resize(count);
  for (Index e = 0; e < n.E; ++e) {
    const bool boundary = parent.is_boundary_edge(e);
    edge_offsets[n.V + e + 1] = edge_offsets[n.V + e] + (boundary ? 3 : 4);
    face_offsets[n.V + e + 1] = face_offsets[n.V + e] + (boundary ? 2 : 4);
  }
  for (Index f = 0; f < n.F; ++f) {
    const Index v = n.V + n.E + f;
    edge_offsets[v + 1] = edge_offsets[v] + parent.face_vertices.row_size(f);
    face_offsets[v + 1] = face_offsets[v] + parent.face_vertices.row_size(f);
  }
  child.vertex_edges.values.resize(static_cast<std::size_t>(edge_offsets.back()));
  child.vertex_faces.values.resize(static_cast<std::size_t>(face_offsets.back()));
}

void make_child_rings(const SurfaceLevel& parent, SurfaceLevel& child) {
  const Counts n = counts_of(parent);
  make_child_ring_offsets(parent, child);
  parallel_for(n.V, loop_grain, [&](Offset begin, Offset end) {
    for (Index v = static_cast<Index>(begin); v < end; ++v) {
      Index* edge = child.vertex_edges[v].data();
      for (const Index e : parent.vertex_edges[v]) *edge++ = 2 * e + end_at(parent, e, v);
      Index* face = child.vertex_faces[v].data();
      for (const Index f : parent.vertex_faces[v]) {
        *face++ = static_cast<Index>(parent.face_vertices.offsets[f]) + place_in(parent.face_vertices[f], v);
      }
    }
  });
  // Round an edge point, counter-clockwise: along the edge as its first face runs through it, to the first
  // face's point, back along the edge, to the second face's point.
  parallel_for(n.E, loop_grain, [&](Offset begin, Offset end) {
    for (Index e = static_cast<Index>(begin); e < end; ++e) {
      Index* const edges = child.vertex_edges[n.V + e].data();
      Index* const faces = child.vertex_faces[n.V + e].data();
      for (Index side = 0; side < 2; ++side) {
        const Index f = parent.edge_faces[e][side];
        if (f == no_index) continue;
        const auto row = parent.face_edges[f];
        const auto size = static_cast<Index>(row.size());
        const Index i = place_in(row, e);
        const Index first = static_cast<Index>(parent.face_vertices.offsets[f]);
        const Index tail = end_at(parent, e, parent.face_vertices[f][i]);
        edges[2 * side] = 2 * e + 1 - tail;
        edges[2 * side + 1] = 2 * n.E + first + i;
        if (side == 0) edges[2] = 2 * e + tail;
        faces[2 * side] = first + next_in(i, size);
        faces[2 * side + 1] = first + i;
      }
    }
  });
  parallel_for(n.F, loop_grain, [&](Offset begin, Offset end) {
    for (Index f = static_cast<Index>(begin); f < end; ++f) {
      const Index size = parent.face_vertices.row_size(f);
      const Index first = static_cast<Index>(parent.face_vertices.offsets[f]);
      Index* const edges = child.vertex_edges[n.V + n.E + f].data();
      Index* const faces = child.vertex_faces[n.V + n.E + f].data();
      for (Index i = 0; i < size; ++i) {
        edges[i] = 2 * n.E + first + i;
        faces[i] = first + next_in(i, size);
      }
    }
  });
}

// Masks of a level's vertices; nearly all of them are smooth.
class VertexMasks {
 public:
  explicit VertexMasks(const SurfaceLevel& level) : level_(level) {}
  VertexMask of(Index v) {
    const auto edges = level_.vertex_edges[v];
    bool sharp = level_.vertex_sharpness[v] > 0;
    for (const Index e : edges) sharp = sharp || level_.edge_sharpness[e] > 0;
    if (!sharp) return smooth_vertex_mask(static_cast<int>(edges.size()));
    sharpness_.clear();
    for (const Index e : edges) sharpness_.push_back(level_.edge_sharpness[e]);
    return vertex_mask(level_.vertex_sharpness[v], sharpness_);
  }

 private:
  const SurfaceLevel& level_;
  std::vector<double> sharpness_;
};

std::vector<Vec3> refine_once(const SurfaceLevel& own_level, std::vector<Vec3> points) {
  const MirrorExtension extension(own_level);
  const SurfaceLevel& level = extension.level();
  const Counts n = counts_of(own_level);
  const Index all_faces = level.face_count();
  if (extension.fold() != nullptr) points = extension.extend(points);
  std::vector<Vec3> result(static_cast<std::size_t>(n.V) + n.E + all_faces);
  const Vec3* const face_points = result.data() + n.V + n.E;
  parallel_for(all_faces, loop_grain, [&](Offset begin, Offset end) {
    for (Index f = static_cast<Index>(begin); f < end; ++f) {
      const auto row = level.face_vertices[f];
      Vec3 sum = points[row[0]];
      for (std::size_t i = 1; i < row.size(); ++i) sum += points[row[i]];
      result[n.V + n.E + f] = sum / static_cast<double>(row.size());
    }
  });
  parallel_for(n.E, loop_grain, [&](Offset begin, Offset end) {
    for (Index e = static_cast<Index>(begin); e < end; ++e) {
      const EdgeMask mask = edge_mask(level.edge_sharpness[e]);
      const auto [a, b] = level.edge_vertices[e];
      Vec3 point = mask.end * (points[a] + points[b]);
      if (mask.face != 0) {
        point += mask.face * (face_points[level.edge_faces[e][0]] + face_points[level.edge_faces[e][1]]);
      }
      put_into_planes(extension.planes_of_edge(e), own_level.mirrors.value, point);
      result[n.V + e] = point;
    }
  });
  parallel_for(n.V, loop_grain, [&](Offset begin, Offset end) {
    VertexMasks masks(level);
    for (Index v = static_cast<Index>(begin); v < end; ++v) {
      const VertexMask mask = masks.of(v);
      const auto edges = level.vertex_edges[v];
      const auto other_end = [&](Index e) -> const Vec3& {
        return points[level.edge_vertices[e][1 - end_at(level, e, v)]];
      };
      Vec3 point = mask.vertex * points[v];
      if (mask.face != 0) {
        Vec3 sum = Vec3::Zero();
        for (const Index e : edges) sum += other_end(e);
        for (const Index f : level.vertex_faces[v]) sum += face_points[f];
        point += mask.face * sum;  // edges and faces weigh the same
      }
      if (mask.crease != 0) {
        point +=
            mask.crease * (other_end(edges[mask.crease_edges[0]]) + other_end(edges[mask.crease_edges[1]]));
      }
      put_into_planes(extension.planes_of(v), own_level.mirrors.value, point);
      result[v] = point;
    }
  });
  result.resize(static_cast<std::size_t>(n.V) + n.E + n.F);
  return result;
}

}  // namespace

SurfaceLevel build_child_level(const SurfaceLevel& parent) {
  const Counts n = counts_of(parent);
  if (std::max<Offset>(2 * Offset{n.E} + n.C, 4 * n.C) > std::numeric_limits<Index>::max()) {
    throw Error(ErrorKind::input,
                "level " + std::to_string(parent.depth + 1) + " would have " + std::to_string(n.C) +
                    " faces, more than numbers of 32 bits can name",
                "ask for fewer levels");
  }
  SurfaceLevel child;
  child.depth = parent.depth + 1;
  make_child_faces(parent, child);
  make_child_edges(parent, child);
  make_child_rings(parent, child);
  child.vertex_sharpness.assign(static_cast<std::size_t>(child.vertex_count()), 0);
  for (Index v = 0; v < n.V; ++v) child.vertex_sharpness[v] = decayed_sharpness(parent.vertex_sharpness[v]);
  return child;
}

StencilTable refinement_stencils(const SurfaceLevel& level) {
  const MirrorExtension extension(level);
  const SurfaceLevel& parent = extension.level();
  const Counts n = counts_of(level);
  const auto add_face = [&](StencilWriter& out, Index f, double weight) {
    const auto row = parent.face_vertices[f];
    for (const Index v : row) out.add(v, weight / static_cast<double>(row.size()));
  };
  const auto add_edge_point = [&](StencilWriter& out, Index e) {
    const EdgeMask mask = edge_mask(parent.edge_sharpness[e]);
    for (const Index v : parent.edge_vertices[e]) out.add(v, mask.end);
    for (const Index f : parent.edge_faces[e]) {
      if (mask.face != 0) add_face(out, f, mask.face);
    }
  };
  const auto add_vertex_point = [&](StencilWriter& out, Index v, const VertexMask& mask) {
    const auto edges = parent.vertex_edges[v];
    const auto add_other_end = [&](Index e, double weight) {
      out.add(parent.edge_vertices[e][1 - end_at(parent, e, v)], weight);
    };
    out.add(v, mask.vertex);
    if (mask.edge != 0) {
      for (const Index e : edges) add_other_end(e, mask.edge);
    }
    if (mask.face != 0) {
      for (const Index f : parent.vertex_faces[v]) add_face(out, f, mask.face);
    }
    if (mask.crease != 0) {
      for (const int i : mask.crease_edges) add_other_end(edges[i], mask.crease);
    }
  };
  return build_stencils(
      Offset{n.V} + n.E + n.F, n.V,
      [&](Index begin, Index end, StencilWriter& out) {
        VertexMasks masks(parent);
        for (Index child = begin; child < end; ++child) {
          if (child < n.V) {
            add_vertex_point(out, child, masks.of(child));
            out.end_row(extension.planes_of(child));
          } else if (child < n.V + n.E) {
            add_edge_point(out, child - n.V);
            out.end_row(extension.planes_of_edge(child - n.V));
          } else {
            add_face(out, child - n.V - n.E, 1);
            out.end_row();
          }
        }
      },
      extension.fold());
}

std::vector<SurfaceLevel> build_levels(const Cage& cage, int depth) {
  std::vector<SurfaceLevel> levels{build_surface_level(cage)};
  for (int k = 0; k < depth; ++k) levels.push_back(build_child_level(levels.back()));
  return levels;
}

std::vector<Vec3> refine_points(std::span<const SurfaceLevel> levels, std::vector<Vec3> points) {
  assert(!levels.empty() && static_cast<Index>(points.size()) == levels.front().vertex_count());
  for (std::size_t k = 0; k + 1 < levels.size(); ++k) points = refine_once(levels[k], std::move(points));
  return points;
}

}  // namespace flowcage
