#pragma once
#include <array>
#include <cstdint>
#include <span>

#include "core/base/types.hpp"

namespace flowcage {

/// Catmull-Clark weights as functions of sharpness and valence alone: no mesh, no points.
/// Smooth rules: Catmull & Clark 1978. Creases, corners, darts, semi-sharp blending: DeRose, Kass & Truong,
/// "Subdivision Surfaces in Character Animation", SIGGRAPH 1998, section 3 and appendix, with the conventions
/// of OpenSubdiv: a sharpness of infinitely_sharp or more never decays, any other decays by 1 a level; a rule
/// that changes within the next level is blended by the mean fractional sharpness.
/// Notation: P the vertex, E the other ends of its edges, F the centroids of its faces, in ring order.

enum class VertexRule : std::uint8_t {
  smooth,  ///< no sharp edge
  dart,    ///< one sharp edge: the smooth mask
  crease,  ///< two sharp edges
  corner   ///< three or more, or a sharp vertex
};

/// Sharpness at the next level.
double decayed_sharpness(double sharpness);

/// Sharp means > 0; boundary edges count as infinitely sharp.
VertexRule vertex_rule(double vertex_sharpness, std::span<const double> edge_sharpness);

/// New vertex = vertex P + edge sum(E) + face sum(F) + crease (E[crease_edges[0]] + E[crease_edges[1]]).
struct VertexMask {
  double vertex = 1, edge = 0, face = 0, crease = 0;
  std::array<int, 2> crease_edges{0, 0};
};
/// Precondition: a vertex with a boundary has its two boundary edges infinitely sharp.
VertexMask vertex_mask(double vertex_sharpness, std::span<const double> edge_sharpness);
/// The same without any sharpness.
VertexMask smooth_vertex_mask(int valence);

/// Edge point = end (A + B) + face (F_left + F_right).
struct EdgeMask {
  double end = 0.5, face = 0;
};
EdgeMask edge_mask(double sharpness);

}  // namespace flowcage
