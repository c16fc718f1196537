#include "core/blocks/box_edges.hpp"

#include <algorithm>
#include <cmath>
#include <queue>

namespace flowcage {
namespace {

/// Corners and edges of the box (or of its half beyond the symmetry plane), in the box's own axes: -1, 0, 1.
struct Frame {
  struct Corner {
    Vec3 direction;  ///< entries -1, 0 (in the plane) or 1
    bool on_rim;
  };
  std::vector<Corner> corners;
  std::vector<std::array<int, 2>> edges;
};

Frame box_frame(int plane_axis, double side) {
  Frame frame;
  for (int n = 0; n < 8; ++n) {
    Vec3 d(n & 1 ? 1 : -1, n & 2 ? 1 : -1, n & 4 ? 1 : -1);
    const bool on_rim = plane_axis >= 0 && d[plane_axis] != side;
    if (on_rim) d[plane_axis] = 0;
    frame.corners.push_back({d, on_rim});
  }
  for (int a = 0; a < 8; ++a) {
    for (int bit = 1; bit < 8; bit *= 2) {
      const int b = a | bit;
      if (b == a) continue;
      if (frame.corners[a].on_rim && frame.corners[b].on_rim) continue;  // the rim itself runs there
      frame.edges.push_back({a, b});
    }
  }
  return frame;
}

Index edge_between(const SurfaceLevel& s, Index a, Index b) {
  for (const Index e : s.vertex_edges[a]) {
    if (s.edge_vertices[e][0] == b || s.edge_vertices[e][1] == b) return e;
  }
  return no_index;
}

/// The nearest free vertex for each corner, closest pairs first; empty if one is further than 40 degrees.
std::vector<Index> choose_corners(const Frame& frame, std::span<const Vec3> local,
                                  std::span<const char> on_rim) {
  struct Pair {
    double cosine;
    int corner;
    Index vertex;
  };
  std::vector<Pair> pairs;
  for (int c = 0; c < static_cast<int>(frame.corners.size()); ++c) {
    for (Index v = 0; v < static_cast<Index>(local.size()); ++v) {
      if ((on_rim[v] != 0) != frame.corners[c].on_rim) continue;
      const double cosine = local[v].normalized().dot(frame.corners[c].direction.normalized());
      if (cosine > 0.766) pairs.push_back({cosine, c, v});
    }
  }
  std::stable_sort(pairs.begin(), pairs.end(),
                   [](const Pair& a, const Pair& b) { return a.cosine > b.cosine; });
  std::vector<Index> vertex(frame.corners.size(), no_index);
  for (const Pair& p : pairs) {
    if (vertex[p.corner] == no_index && std::find(vertex.begin(), vertex.end(), p.vertex) == vertex.end()) {
      vertex[p.corner] = p.vertex;
    }
  }
  if (std::find(vertex.begin(), vertex.end(), no_index) != vertex.end()) return {};
  return vertex;
}

/// Shortest path along edges whose inner vertices are free; its cost grows with the distance from the box
/// edge.
std::vector<Index> find_path(const SurfaceLevel& s, std::span<const Vec3> on_box, std::span<const char> taken,
                             std::array<Index, 2> ends, std::array<Vec3, 2> box_edge) {
  const Vec3 along = (box_edge[1] - box_edge[0]).normalized();
  const auto off = [&](Index v) {
    const Vec3 d = on_box[v] - box_edge[0];
    return (d - along * along.dot(d)).norm();
  };
  std::vector<double> cost(s.vertex_count(), std::numeric_limits<double>::infinity());
  std::vector<Index> from(s.vertex_count(), no_index);
  using Entry = std::pair<double, Index>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  cost[ends[0]] = 0;
  queue.push({0, ends[0]});
  while (!queue.empty()) {
    const auto [c, v] = queue.top();
    queue.pop();
    if (c > cost[v]) continue;
    if (v == ends[1]) break;
    for (const Index e : s.vertex_edges[v]) {
      const Index w = s.edge_vertices[e][0] == v ? s.edge_vertices[e][1] : s.edge_vertices[e][0];
      if (s.is_boundary_edge(e) || (taken[w] != 0 && w != ends[1])) continue;
      const double next = c + (on_box[w] - on_box[v]).norm() + 2 * off(w);
      if (next < cost[w]) {
        cost[w] = next;
        from[w] = v;
        queue.push({next, w});
      }
    }
  }
  if (from[ends[1]] == no_index) return {};
  std::vector<Index> path{ends[1]};
  while (path.back() != ends[0]) path.push_back(from[path.back()]);
  std::reverse(path.begin(), path.end());
  return path;
}

/// Faces joined across edges that are no crease.
std::vector<Index> flood_regions(const SurfaceLevel& s, std::span<const double> sharpness, Index& count) {
  std::vector<Index> region(s.face_count(), no_index);
  count = 0;
  for (Index start = 0; start < s.face_count(); ++start) {
    if (region[start] != no_index) continue;
    std::vector<Index> stack{start};
    region[start] = count;
    while (!stack.empty()) {
      const Index f = stack.back();
      stack.pop_back();
      for (const Index e : s.face_edges[f]) {
        if (sharpness[e] > 0) continue;
        for (const Index g : s.edge_faces[e]) {
          if (g != no_index && region[g] == no_index) {
            region[g] = count;
            stack.push_back(g);
          }
        }
      }
    }
    ++count;
  }
  return region;
}

}  // namespace

std::optional<BoxLayout> lay_out_on_box(const SurfaceLevel& s, std::span<const Vec3> directions,
                                        const OuterShape& box, const std::optional<SymmetryPlane>& plane,
                                        std::span<const Vec3> wall_normals) {
  // Everything in the box's axes, half an edge = 1.
  std::vector<Vec3> local;
  for (const Vec3& d : directions) local.push_back(box.axes.transpose() * d);
  for (Vec3& p : local) p /= p.cwiseAbs().maxCoeff();
  int plane_axis = no_index;
  double side = 1;
  if (plane) {
    const Vec3 n = box.axes.transpose() * plane->normal;
    n.cwiseAbs().maxCoeff(&plane_axis);
    side = n[plane_axis] > 0 ? 1 : -1;
  }
  std::vector<char> on_rim(local.size(), 0);
  for (const Index v : boundary_vertices(s)) on_rim[v] = 1;

  const Frame frame = box_frame(plane_axis, side);
  const std::vector<Index> corner = choose_corners(frame, local, on_rim);
  if (corner.empty()) return std::nullopt;
  BoxLayout layout;
  layout.edge_sharpness.assign(s.edge_count(), 0);
  layout.vertex_sharpness.assign(s.vertex_count(), 0);
  std::vector<char> taken = on_rim;  // and fixed points of the layout
  std::vector<char> fixed(local.size(), 0);
  for (std::size_t c = 0; c < corner.size(); ++c) {
    taken[corner[c]] = fixed[corner[c]] = 1;
    layout.vertex_sharpness[corner[c]] = infinitely_sharp;
    local[corner[c]] = frame.corners[c].direction;
  }
  for (const auto& [a, b] : frame.edges) {
    const std::array<Vec3, 2> ends{frame.corners[a].direction, frame.corners[b].direction};
    const std::vector<Index> path = find_path(s, local, taken, {corner[a], corner[b]}, ends);
    if (path.empty()) return std::nullopt;
    for (std::size_t n = 0; n + 1 < path.size(); ++n) {
      layout.edge_sharpness[edge_between(s, path[n], path[n + 1])] = infinitely_sharp;
      if (n == 0) continue;
      taken[path[n]] = fixed[path[n]] = 1;
      const double t = static_cast<double>(n) / static_cast<double>(path.size() - 1);
      local[path[n]] = ends[0] + t * (ends[1] - ends[0]);
    }
  }
  for (Index e = 0; e < s.edge_count(); ++e) {
    if (s.is_boundary_edge(e)) layout.edge_sharpness[e] = infinitely_sharp;
  }
  // The rim runs round the box in the plane: between two of its corners evenly on the box's side. Directions
  // came from a fold-free map, so the order round the rim is right; points only move within their side.
  Index regions = 0;
  const std::vector<Index> region = flood_regions(s, layout.edge_sharpness, regions);
  if (regions != (plane ? 5 : 6)) return std::nullopt;
  // Which side of the box each region is: the one that all its corners share.
  std::vector<std::array<int, 2>> side_of(regions, {no_index, 0});
  for (Index r = 0; r < regions; ++r) {
    Vec3 sum = Vec3::Zero();
    std::vector<Index> mine;
    for (std::size_t c = 0; c < corner.size(); ++c) {
      for (const Index f : s.vertex_faces[corner[c]]) {
        if (region[f] == r) {
          mine.push_back(static_cast<Index>(c));
          sum += frame.corners[c].direction;
          break;
        }
      }
    }
    if (mine.size() != 4) return std::nullopt;
    for (int axis = 0; axis < 3; ++axis) {
      if (std::abs(sum[axis]) == 4) side_of[r] = {axis, sum[axis] > 0 ? 1 : -1};
    }
    if (side_of[r][0] == no_index) return std::nullopt;
  }
  // Rim vertices keep their direction's place, on the side their region is.
  for (Index f = 0; f < s.face_count(); ++f) {
    const auto [axis, sign] = side_of[region[f]];
    for (const Index v : s.face_vertices[f]) {
      if (fixed[v] != 0 && std::abs(local[v][axis] - sign) > 1e-9) return std::nullopt;
      if (fixed[v] == 0) local[v][axis] = sign;
    }
  }
  // Tutte's map inside each side: every vertex the mean of its neighbours (Gauss-Seidel; rim vertices slide).
  for (int sweep = 0; sweep < 2000; ++sweep) {
    double moved = 0;
    for (Index v = 0; v < s.vertex_count(); ++v) {
      if (fixed[v] != 0) continue;
      Vec3 mean = Vec3::Zero();
      int count = 0;
      for (const Index e : s.vertex_edges[v]) {
        const Index w = s.edge_vertices[e][0] == v ? s.edge_vertices[e][1] : s.edge_vertices[e][0];
        if (on_rim[v] != 0 && on_rim[w] == 0) continue;
        mean += local[w];
        ++count;
      }
      mean /= count;
      if (on_rim[v] != 0) mean[plane_axis] = 0;
      const int axis = side_of[region[s.vertex_faces[v][0]]][0];
      mean[axis] = local[v][axis];
      moved = std::max(moved, (mean - local[v]).norm());
      local[v] = mean;
    }
    if (moved < 1e-13) break;
  }
  for (Index f = 0; f < s.face_count(); ++f) {
    const auto v = s.face_vertices[f];
    const int axis = side_of[region[f]][0];
    for (int c = 0; c < 4; ++c) {
      const Vec3& p = local[v[c]];
      const Vec3 e = local[v[(c + 1) % 4]] - p;
      const Vec3 g = local[v[(c + 3) % 4]] - p;
      const double sine = e.cross(g)[axis] * side_of[region[f]][1] / (e.norm() * g.norm());
      const double cosine = (box.axes * p.normalized()).dot(wall_normals[4 * f + c]);
      if (!(sine > 0.05) || !(cosine > 0.02)) return std::nullopt;
    }
  }
  for (const Vec3& p : local) layout.points.push_back(box.centre + box.axes * (box.radius * p));
  return layout;
}

}  // namespace flowcage
