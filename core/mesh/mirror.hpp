#pragma once
#include <optional>
#include <span>
#include <vector>

#include "core/mesh/mirror_planes.hpp"
#include "core/mesh/surface_level.hpp"

namespace flowcage {

/// Half models. The boundary rule of subdivision makes a boundary a curve of its own: it reflects every
/// coordinate oddly, so that second derivatives vanish across it. At a symmetry plane that is right for the
/// coordinate normal to the plane alone. A mirrored edge is instead what it would be if the surface's mirror
/// image were attached there: an inner edge, normal coordinate odd, the two others even. (Images of the first
/// ring of control points as ghost points: the usual treatment of symmetry in spline fitting.)

/// The level with `edges` mirrored at the plane. They get sharpness 0, and their vertices that were corners
/// because they have one face are none any more. Where the whole surface is to have a crease in the plane (it
/// meets the plane at another angle than 90 degrees) or a corner, set edge_sharpness or vertex_sharpness
/// after this; leaving single edges of a chain in the plane out is different: the surface is open there.
/// The vertices count as lying in the plane to the last bit, whatever their points are.
/// Preconditions: boundary edges; no other plane of this axis yet.
SurfaceLevel mirrored(SurfaceLevel level, int axis, double value, std::span<const Index> edges);

/// A level together with one ring of mirror images beyond its mirrored edges, so that every vertex of the
/// level has its whole ring. Elements of the level keep their numbers, images follow; only the rings of the
/// level's own vertices are complete, those of images are empty; no edge of it is mirrored. Faces that are
/// images run the other way round, so that orientation is consistent.
/// Without mirrored edges it is the level itself, which must outlive this and is not copied.
class MirrorExtension {
 public:
  explicit MirrorExtension(const SurfaceLevel& level);

  const SurfaceLevel& level() const { return extended_ ? *extended_ : own_; }
  /// nullptr without mirrored edges.
  const MirrorFold* fold() const { return extended_ ? &fold_ : nullptr; }
  /// Bit a: the vertex (of the level) lies in the plane of axis a.
  unsigned planes_of(Index v) const { return extended_ ? fold_.in_planes[v] : 0; }
  /// The same for an edge.
  unsigned planes_of_edge(Index e) const;
  /// False for an image.
  bool is_own_face(Index f) const { return f < own_.face_count(); }
  /// Points of the extended level. Precondition: mirrored edges; points.size() == #V of the level.
  std::vector<Vec3> extend(std::span<const Vec3> points) const;

 private:
  const SurfaceLevel& own_;
  std::optional<SurfaceLevel> extended_;
  MirrorFold fold_;
};

}  // namespace flowcage
