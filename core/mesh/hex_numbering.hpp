#pragma once
#include <array>

#include "core/mesh/hex_view.hpp"

namespace flowcage {

/// The numbers of a hex's corners, edges and faces, drawn once; everything else refers to this page.
///
///            7-----------6          Corners: VTK order. Corner c sits at (i,j,k) = hex_corner_ijk[c].
///           /|          /|
///          / |         / |          Edges: 4*axis + a + 2*b, where a and b are the positions (0 or 1) on
///         4-----------5  |          the other two axes, in ascending order of the axes. Each runs in the
///         |  |        |  |          direction of its axis:
///         |  3--------|--2            0: 0-1   1: 3-2   2: 4-5   3: 7-6   along i, at (j,k)
///    k    | /         | /             4: 0-3   5: 1-2   6: 4-7   7: 5-6   along j, at (i,k)
///    | j  |/          |/              8: 0-4   9: 1-5  10: 3-7  11: 2-6   along k, at (i,j)
///    |/   0-----------1
///    +--i                           Faces: i-min i-max j-min j-max k-min k-max = 2*axis + side; their
///                                   corners, outward, are hex_faces (mesh/hex_view).
inline constexpr std::array<std::array<int, 3>, 8> hex_corner_ijk{
    {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}}};

/// The corner at (i,j,k), each 0 or 1.
constexpr int hex_corner_at(int i, int j, int k) {
  return 4 * k + (j == 0 ? i : 3 - i);
}

inline constexpr std::array<std::array<int, 2>, 12> hex_edges{
    {{0, 1}, {3, 2}, {4, 5}, {7, 6}, {0, 3}, {1, 2}, {4, 7}, {5, 6}, {0, 4}, {1, 5}, {3, 7}, {2, 6}}};

/// Maps to other programs' orders: entry n is our number of their n-th item. Corners agree everywhere.
/// VTK (VTK_QUADRATIC_HEXAHEDRON's mid-edge nodes; its faces are hex_faces).
inline constexpr std::array<int, 12> hex_edge_of_vtk{0, 5, 1, 4, 2, 7, 3, 6, 8, 9, 11, 10};
inline constexpr std::array<int, 6> hex_face_of_vtk{0, 1, 2, 3, 4, 5};
/// CGNS SIDS 3.3.3, HEXA_8 and HEXA_20: faces F1 (1 4 3 2), F2 (1 2 6 5), F3 (2 3 7 6), F4 (3 4 8 7),
/// F5 (1 5 8 4), F6 (5 6 7 8); mid-edge nodes 9 to 20.
inline constexpr std::array<int, 12> hex_edge_of_cgns{0, 5, 1, 4, 8, 9, 11, 10, 2, 7, 3, 6};
inline constexpr std::array<int, 6> hex_face_of_cgns{4, 2, 1, 3, 0, 5};
/// OpenFOAM's cellModel "hex": x-min, x-max, y-min, y-max, z-min, z-max; blockMesh numbers its edges like us
/// but orders those of one axis cyclically.
inline constexpr std::array<int, 6> hex_face_of_openfoam{0, 1, 2, 3, 4, 5};
inline constexpr std::array<int, 12> hex_edge_of_blockmesh{0, 1, 3, 2, 4, 5, 7, 6, 8, 9, 11, 10};

}  // namespace flowcage
