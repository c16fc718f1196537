#pragma once
#include <span>
#include <vector>

#include "core/mesh/stencil_table.hpp"
#include "core/mesh/surface_level.hpp"

namespace flowcage {

/// Limit position of each control vertex: one row a vertex. Interior of valence n: (n^2 P + 4 sum E + sum
/// F)/(n(n+5)) (Stam 1998); crease and boundary (1,4,1)/6; corner P; darts by their own left eigenvector;
/// semi-sharp features and vertices with n-gons through symbolic refinement of the vertex's ring until the
/// mask holds. At mirrored edges the smooth surface goes on as its image (mirror.hpp). The rows sum to 1. The
/// same limit in the points of any finer level: rows are invariant under refinement.
StencilTable limit_stencils(const SurfaceLevel& level);

/// Tangents of each vertex: two tables like limit_stencils. Rows sum to 0; not normalised; u x v points to
/// the side from which faces are counter-clockwise. At a crease vertex: those of its first smooth sector
/// (see SectorTangents). At a corner no tangent plane exists in general: a plane fitted to the edges of the
/// first sector is given, the exact one where the sector has one face.
struct TangentStencils {
  StencilTable u, v;
};
TangentStencils tangent_stencils(const SurfaceLevel& level);

/// Tangents by vertex and smooth sector: the faces between two neighbouring sharp (or boundary) edges.
/// Sectors of vertex v are [first_sector[v], first_sector[v + 1]), counter-clockwise; a vertex without sharp
/// edges has one. Semi-sharp edges decay to nothing, hence do not bound sectors. At a mirrored edge a sector
/// goes on beyond the plane; sectors of images alone, and images among the faces, are left out.
/// Example: vertex 0 smooth of valence 3, vertex 1 on a crease through four faces 5 6 7 8:
///   first_sector 0 1 3, faces (0 1 2) (5 6) (7 8), u and v have three rows.
struct SectorTangents {
  std::vector<Index> first_sector;  ///< #V + 1
  Csr<Index> faces;                 ///< #sectors rows, counter-clockwise
  StencilTable u, v;                ///< #sectors rows; masks and their limits: limit_masks.hpp
};
SectorTangents sector_tangent_stencils(const SurfaceLevel& level);

/// The oversampled system of the paper's equation C V = L: limits at vertices (#V), then edges' midpoints
/// (#E), then faces' midpoints (#F), about four samples a control vertex, through one symbolic refinement.
struct LimitSamples {
  StencilTable position;     ///< rows over the level's control vertices
  StencilTable refinement;   ///< points of the child level, where a sample is a vertex
  TangentStencils tangents;  ///< of the child's points; at a crease those of the first smooth sector
};
LimitSamples oversampled_limit_stencils(const SurfaceLevel& level);

/// tangent u x tangent v of each sample: on the fluid's side, of no particular length.
std::vector<Vec3> sample_normals(const LimitSamples& samples, std::span<const Vec3> points);

/// What its `position` gives of #V points, without the table: a tenth of the work where it is needed once.
std::vector<Vec3> oversampled_limit_points(const SurfaceLevel& level, std::span<const Vec3> points);

}  // namespace flowcage
