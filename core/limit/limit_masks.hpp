#pragma once
#include <span>
#include <vector>

#include "core/subdivide/masks.hpp"

namespace flowcage {

/// Limit weights of Catmull-Clark vertices as functions of rule and valence alone: no mesh, no points.
/// The neighbourhood is the ring of a vertex P whose faces are all quads: the other ends E[i] of its edges
/// and the opposite corners F[i] of its faces, counter-clockwise, F[i] between E[i] and E[i + 1].
///
/// A limit mask is a left eigenvector of the ring's subdivision matrix: for eigenvalue 1 the position, for
/// the next two the tangents (Halstead, Kass & DeRose 1993; Stam 1998).

/// A combination of ring points: vertex P + sum edges[i] E[i] + sum faces[i] F[i].
struct RingWeights {
  double vertex = 0;
  std::vector<double> edges, faces;

  void reset(int edge_count, int face_count);
};

/// What the masks need of a vertex. All its sharp features are infinitely sharp.
struct LimitRing {
  VertexRule rule = VertexRule::smooth;
  int edge_count = 0, face_count = 0;  ///< face_count == edge_count - 1 on a boundary
  std::span<const int> sharp_edges;    ///< places in the ring, ascending, boundary edges included
};

/// Faces between two neighbouring sharp edges: the surface is smooth in it.
/// Edges first_edge .. first_edge + face_count (cyclic) bound and cross it.
struct SmoothSector {
  int first_edge = 0, face_count = 0;
};

/// In ring order, starting at the first sharp edge; one sector if there is none (from edge 0), or one
/// (from it).
void list_sectors(const LimitRing& ring, std::vector<SmoothSector>& sectors);

/// Whether the vertex leaves the limit surface over the sector's faces plain bicubics, that is: four faces
/// round a smooth vertex, two in a crease's sector, one in a corner's.
bool is_regular(const LimitRing& ring, const SmoothSector& sector);

/// Position. The weights sum to 1.
void limit_position_mask(const LimitRing& ring, RingWeights& position);

/// Two tangents of a sector; u x v points to the side from which faces are counter-clockwise; the weights
/// sum to 0; lengths mean nothing.
///   smooth:  the pair of the subdominant eigenvalue, u toward E[0].
///   dart:    u toward the sharp edge (symmetric), v across it (antisymmetric); their eigenvalues differ.
///   crease:  u along the crease, from the sector's last edge to its first, v into the sector. With one face
///            the surface touches its own crease (the two eigenvalues 1/4 are defective) and v is the
///            crease's curvature vector E + E' - 2 P, zero where the crease is straight. With more than four
///            faces the published rules are not C1 in the sector; u and v hold on the crease.
///   corner:  no tangent plane exists unless the sector has one face; u and v are those edges fitted to the
///            sector's fan, equal to its two edges where it has one face.
void limit_tangent_masks(const LimitRing& ring, const SmoothSector& sector, RingWeights& u, RingWeights& v);

/// Writes a combination of the child ring's points in the parent's. On return `weights.faces` belongs to the
/// centroids of the parent's faces, which may be any polygons.
void pull_back_to_centroids(double vertex_sharpness, std::span<const double> edge_sharpness,
                            RingWeights& weights);

/// Centroids of quads in ring points.
void spread_centroids_of_quads(RingWeights& weights);

}  // namespace flowcage
