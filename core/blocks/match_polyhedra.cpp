#include "core/blocks/match_polyhedra.hpp"

#include <algorithm>

namespace flowcage {
namespace {

/// Where corner 0 of a face of `a` lies in `b`.
struct Flag {
  Index face = no_index;
  Index corner = 0;
};

Index place_in(std::span<const Index> row, Index value) {
  return static_cast<Index>(std::find(row.begin(), row.end(), value) - row.begin());
}

Index face_across(const SurfaceLevel& s, Index edge, Index face) {
  return s.edge_faces[edge][0] == face ? s.edge_faces[edge][1] : s.edge_faces[edge][0];
}

bool same_vertex_kind(const SurfaceLevel& a, Index v, const SurfaceLevel& b, Index w) {
  return a.vertex_edges.row_size(v) == b.vertex_edges.row_size(w) &&
         a.vertex_faces.row_size(v) == b.vertex_faces.row_size(w);
}

/// Spreads the image of face 0 of `a` over all faces; empty on a disagreement.
std::vector<Index> spread(const SurfaceLevel& a, const SurfaceLevel& b, Flag start) {
  std::vector<Flag> image(a.face_count());
  std::vector<Index> vertex(a.vertex_count(), no_index);
  std::vector<char> taken(b.vertex_count(), 0);
  std::vector<Index> queue{0};
  image[0] = start;
  for (std::size_t done = 0; done < queue.size(); ++done) {
    const Index f = queue[done];
    const Flag to = image[f];
    const Index n = a.face_vertices.row_size(f);
    if (b.face_vertices.row_size(to.face) != n) return {};
    for (Index i = 0; i < n; ++i) {
      const Index j = (i + to.corner) % n;
      const Index v = a.face_vertices[f][i];
      const Index w = b.face_vertices[to.face][j];
      if (vertex[v] == no_index) {
        if (taken[w] != 0 || !same_vertex_kind(a, v, b, w)) return {};
        vertex[v] = w;
        taken[w] = 1;
      } else if (vertex[v] != w) {
        return {};
      }
      const Index e = a.face_edges[f][i];
      const Index g = b.face_edges[to.face][j];
      const Index next = face_across(a, e, f);
      const Index next_image = face_across(b, g, to.face);
      if ((next == no_index) != (next_image == no_index)) return {};
      if (next == no_index) continue;
      const Index m = a.face_vertices.row_size(next);
      if (b.face_vertices.row_size(next_image) != m) return {};
      const Index corner = (place_in(b.face_edges[next_image], g) - place_in(a.face_edges[next], e) + m) % m;
      if (image[next].face == no_index) {
        image[next] = {next_image, corner};
        queue.push_back(next);
      } else if (image[next].face != next_image || image[next].corner != corner) {
        return {};
      }
    }
  }
  return vertex;
}

std::vector<Vec3> normalised(std::span<const Vec3> points) {
  Vec3 centre = Vec3::Zero();
  for (const Vec3& p : points) centre += p / static_cast<double>(points.size());
  double square = 0;
  for (const Vec3& p : points) square += (p - centre).squaredNorm();
  const double radius = std::sqrt(square / static_cast<double>(points.size()));
  std::vector<Vec3> result;
  result.reserve(points.size());
  for (const Vec3& p : points) result.push_back((p - centre) / (radius > 0 ? radius : 1));
  return result;
}

}  // namespace

std::vector<Index> match_vertices(const Polyhedron& a, const Polyhedron& b) {
  if (a.level.vertex_count() != b.level.vertex_count() || a.level.edge_count() != b.level.edge_count() ||
      a.level.face_count() != b.level.face_count()) {
    return {};
  }
  const std::vector<Vec3> from = normalised(a.points);
  const std::vector<Vec3> to = normalised(b.points);
  std::vector<Index> best;
  double best_distance = 0;
  const auto images_before = [&](const std::vector<Index>& one, const std::vector<Index>& other) {
    for (std::size_t v = 0; v < one.size(); ++v) {
      const Vec3& p = b.points[one[v]];
      const Vec3& q = b.points[other[v]];
      for (int axis = 0; axis < 3; ++axis) {
        if (p[axis] != q[axis]) return p[axis] < q[axis];
      }
    }
    return false;
  };
  const Index n = a.level.face_vertices.row_size(0);
  for (Index g = 0; g < b.level.face_count(); ++g) {
    if (b.level.face_vertices.row_size(g) != n) continue;
    for (Index corner = 0; corner < n; ++corner) {
      std::vector<Index> candidate = spread(a.level, b.level, {g, corner});
      if (candidate.empty()) continue;
      double distance = 0;
      for (std::size_t v = 0; v < candidate.size(); ++v)
        distance += (from[v] - to[candidate[v]]).squaredNorm();
      const double close = 1e-9 * static_cast<double>(candidate.size());
      if (best.empty() || distance < best_distance - close ||
          (distance < best_distance + close && images_before(candidate, best))) {
        best_distance = best.empty() ? distance : std::min(distance, best_distance);
        best = std::move(candidate);
      }
    }
  }
  return best;
}

}  // namespace flowcage
