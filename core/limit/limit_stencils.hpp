#pragma once
#include <vector>

#include "core/mesh/stencil_table.hpp"
#include "core/mesh/surface_level.hpp"

namespace flowcage {

/// Where a sample of the limit surface sits on its level.
enum class SampleSite : std::uint8_t { vertex, edge, face };

/// A set of limit points of one level as rows over its control vertices, with their tangents where the
/// surface is smooth. Order: vertices (#V), then edges' midpoints (#E), then faces' midpoints (#F).
struct LimitSamples {
  StencilTable position;
  StencilTable tangent_u, tangent_v;  ///< rows for the same samples; normal = tangent_u x tangent_v, on the
                                      ///< fluid's side. At a crease vertex: those of the first smooth sector.
};

/// Limit position of each control vertex: one row a vertex. Interior of valence n: (n^2 P + 4 sum E + sum
/// F)/(n(n+5)) (Stam 1998); crease and boundary (1,4,1)/6; corner P; darts by their own left eigenvector;
/// semi-sharp features and vertices with n-gons through symbolic refinement until the mask holds. The rows
/// sum to 1.
StencilTable limit_stencils(const SurfaceLevel& level);

/// Tangents of each vertex: two tables like limit_stencils. Rows sum to 0; not normalised.
/// Zero rows only at corners, where no tangent exists; there the directions of two edges of the first sector
/// are given.
struct TangentStencils {
  StencilTable u, v;
};
TangentStencils tangent_stencils(const SurfaceLevel& level);

/// The oversampled system of the paper's equation C V = L: limits at vertices, edges' and faces' midpoints
/// (about four samples a control vertex), through one symbolic refinement.
LimitSamples oversampled_limit_stencils(const SurfaceLevel& level);

}  // namespace flowcage
