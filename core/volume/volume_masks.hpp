#pragma once
#include <array>
#include <span>

#include "core/base/types.hpp"

namespace flowcage {

/// The weights of 3-D Catmull-Clark subdivision, free of any mesh.
///
/// Every interior rule is a mean over the cells at the new point of a combination of that cell's corners
/// alone, so a mesh needs only to know its cells. With C the mean of a cell's corners, F that of a face's:
///   cell point    C
///   face point    (C_l + 2 F + C_r) / 4              = mean over 2 cells of (C + F) / 2
///   edge point    (C~ + 2 F~ + (N-3) E) / N          = mean over N cells of (C + F_a + F_b + (N-3) E) / N
///   vertex point  mean over the cells of the trilinear quarter point (27,9,9,9,3,3,3,1)/64
/// where C~ and F~ are means over the N cells and the N faces at the edge, E the edge's midpoint (Joy &
/// MacCracken 1996), and the vertex rule is that of Bajaj, Schaefer, Warren & Xu 2002.
///
/// `site` is the new point's place in the cell: per axis 0 (the low side), 1 (the middle) or 2 (the high
/// side). Weights by hex corner (VTK order), sum 1. `cells_at_edge` is N; it matters to edge points only.
std::array<double, 8> cell_mask(std::array<int, 3> site, Index cells_at_edge);

/// The same for the boundary surface, whose points follow 2-D Catmull-Clark rules alone: weights of a quad's
/// corners (cyclic) in its contribution to
///   the edge point of its first side,  mean over 2 quads of (F + E) / 2
///   the vertex point of its corner 0,  mean over n quads of (F + E_a + E_b + (n-3) P) / n
std::array<double, 4> quad_edge_mask();
std::array<double, 4> quad_vertex_mask(Index valence);

/// How a boundary vertex is refined: shares of the smooth, the crease (1 6 1)/8 and the corner rule, sum 1.
/// Chosen and blended as in core/subdivide: fewer than two sharp edges smooth, two crease, more or a sharp
/// vertex corner; where a sharpness decays to 0 in this step, the parent's and the child's rule are mixed by
/// the mean of the decaying sharpnesses (DeRose, Kass & Truong 1998).
struct VertexRule {
  double smooth = 0, crease = 0, corner = 0;
  std::array<Index, 2> crease_edges{no_index, no_index};  ///< places in the given span
};
VertexRule vertex_rule(std::span<const double> edge_sharpness, double vertex_sharpness);

/// One level's decay.
inline double decayed(double sharpness) {
  return sharpness >= infinitely_sharp ? sharpness : (sharpness > 1 ? sharpness - 1 : 0);
}

}  // namespace flowcage
