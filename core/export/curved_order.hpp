#pragma once
#include <vector>

namespace flowcage {

/// How the formats order the nodes of a Lagrange hex or quad of order p: entry n is the place of their n-th
/// node in CurvedMesh's order, i + (p + 1) (j + (p + 1) k), of a quad u + (p + 1) v.
struct CurvedOrder {
  std::vector<int> hex, quad;
};

/// VTK_LAGRANGE_HEXAHEDRON and VTK_LAGRANGE_QUADRILATERAL as of VTK 9.1 (files of version 2.2): corners;
/// edges (those of hex_edge_of_vtk) along their axes; faces as hex_faces, lower axis fastest; inside i
/// fastest.
CurvedOrder vtk_order(int order);

/// Gmsh: corners, edges, faces, inside; face and inside are numbered like a quad or hex of order p - 2 (Gmsh
/// reference manual, "Node ordering").
CurvedOrder gmsh_order(int order);

/// CGNS SIDS 3.3: corners, edges in the direction of F1, the sides, F6; faces F1 (1 2 3 4), F2 (1 2 6 5), F3
/// (2 3 7 6), F4 (3 4 8 7), F5 (4 1 5 8), F6 (5 6 7 8) as spirals from their first corner; inside by layers
/// of spirals.
CurvedOrder cgns_order(int order);

}  // namespace flowcage
