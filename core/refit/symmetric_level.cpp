#include "core/refit/symmetric_level.hpp"

#include <algorithm>
#include <cmath>

#include "core/mesh/mirror.hpp"

namespace flowcage {
namespace {

constexpr double right_angle_sine = 1e-3;  // of the normal's angle to the plane

/// Whether the target's normals lie in the plane along each segment of a chain.
std::vector<bool> right_angled_segments(const CreaseChain& chain, const ChainMatch& match, int axis,
                                        const TargetSurface& target) {
  constexpr int samples = 8;
  const Index n = chain.segment_count();
  std::vector<Vec3> places;
  for (Index i = 0; i < n; ++i) {
    for (int k = 0; k < samples; ++k) {
      const double part = (k + 0.5) / samples;
      places.push_back(
          point_on_path(target, match.path, match.s[i] + part * (match.s[i + 1] - match.s[i])).position);
    }
  }
  std::vector<SurfacePoint> feet(places.size());
  target.closest_points(places, {}, feet);
  std::vector<bool> right(static_cast<std::size_t>(n), true);
  for (std::size_t k = 0; k < feet.size(); ++k) {
    if (feet[k].status == FootStatus::failed || std::abs(feet[k].normal[axis]) > right_angle_sine) {
      right[k / samples] = false;
    }
  }
  return right;
}

/// The direction of a crease chain's path at the end that lies at v.
Vec3 end_tangent(const CreaseChain& chain, const ChainMatch& match, Index v, const TargetSurface& target) {
  const bool at_front = chain.vertices.front() == v;
  return point_on_path(target, match.path, at_front ? match.s.front() : match.s.back()).tangent;
}

/// Corners of the whole body among the vertices of mirrored edges.
void tag_corners(std::span<const CreaseChain> chains, const FeatureMatch& match, int axis,
                 const TargetSurface& target, std::span<const Index> in_plane, SurfaceLevel& level) {
  for (const Index v : in_plane) {
    if (!match.end_is_fixed[v]) continue;
    bool has_crease = false, slanted = false;
    for (std::size_t c = 0; c < chains.size(); ++c) {
      const CreaseChain& chain = chains[c];
      if (chain.boundary || chain.closed) continue;
      if (chain.vertices.front() != v && chain.vertices.back() != v) continue;
      has_crease = true;
      slanted = slanted || !match.chains[c].matched ||
                std::abs(end_tangent(chain, match.chains[c], v, target)[axis]) < 1 - right_angle_sine;
    }
    if (!has_crease || slanted) level.vertex_sharpness[v] = infinitely_sharp;
  }
}

}  // namespace

SurfaceLevel symmetric_level(SurfaceLevel level, std::span<const CreaseChain> chains,
                             const FeatureMatch& match, std::span<const ChainPlane> planes,
                             const TargetSurface& target) {
  for (int axis = 0; axis < 3; ++axis) {
    const auto first = std::find_if(planes.begin(), planes.end(),
                                    [&](const ChainPlane& plane) { return plane.axis == axis; });
    if (first == planes.end()) continue;
    std::vector<Index> edges, creases, vertices;
    bool any = false;
    for (const ChainPlane& plane : planes) {
      if (plane.axis != axis || plane.value != first->value) continue;
      const CreaseChain& chain = chains[plane.chain];
      const std::vector<bool> right = right_angled_segments(chain, match.chains[plane.chain], axis, target);
      for (Index i = 0; i < chain.segment_count(); ++i) {
        edges.push_back(chain.edges[i]);
        if (right[i]) {
          any = true;
        } else {
          creases.push_back(chain.edges[i]);
        }
      }
      vertices.insert(vertices.end(), chain.vertices.begin(), chain.vertices.end());
    }
    if (!any) continue;
    const std::vector<double> tagged = level.vertex_sharpness;
    level = mirrored(std::move(level), axis, first->value, edges);
    for (const Index e : creases) level.edge_sharpness[e] = infinitely_sharp;
    // A cage's own corner tags hold for the whole body; those of single faces are gone.
    for (const Index v : vertices) {
      if (level.vertex_faces.row_size(v) > 1) level.vertex_sharpness[v] = tagged[v];
    }
    tag_corners(chains, match, axis, target, vertices, level);
  }
  return level;
}

std::vector<Index> whole_sharp_counts(const SurfaceLevel& level) {
  std::vector<Index> counts = sharp_edge_counts(level);
  if (!level.mirrors.any()) return counts;
  std::vector<bool> in_plane(counts.size(), false);
  for (Index e = 0; e < level.edge_count(); ++e) {
    if (level.edge_mirror_axis[e] < 0) continue;
    for (const Index v : level.edge_vertices[e]) in_plane[v] = true;
  }
  for (Index e = 0; e < level.edge_count(); ++e) {
    if (level.edge_sharpness[e] < infinitely_sharp || level.edge_mirror_axis[e] >= 0) continue;
    for (const Index v : level.edge_vertices[e]) {
      if (in_plane[v]) ++counts[v];
    }
  }
  return counts;
}

}  // namespace flowcage
