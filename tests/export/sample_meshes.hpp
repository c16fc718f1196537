#pragma once
#include <functional>
#include <string>

#include "core/mesh/hex_view.hpp"

namespace flowcage::tests {

/// n[0] x n[1] x n[2] cells on the unit cube, moved by `map`. Patches i-min "wall" (wall), k-min "symmetry
/// plane" (symmetry), i-max "inlet", j-max "outlet", the others "far".
HexMesh box_mesh(const std::array<Index, 3>& n, const std::function<Vec3(const Vec3&)>& map);
HexMesh box_mesh(const std::array<Index, 3>& n);

/// Moves each inner point by up to `amount` in each direction, from a fixed seed.
HexMesh perturbed_box(const std::array<Index, 3>& n, double amount);

/// O-grid between the spheres of radius 1 ("sphere", wall) and `outer` ("farfield"): six blocks of n x n
/// (on the cube's faces, equiangular) times `layers`. `half` cuts it at z = 0 (n even; "symmetry").
HexMesh sphere_shell(Index n, Index layers, double outer, bool half = false);

/// As HexMesh, with other numbers for points and cells and turned cells: the same mesh for any reader.
HexMesh shuffled(const HexMesh& mesh, unsigned seed);

/// Volume by the divergence theorem over the patches, each quad cut into four triangles at its mean.
double enclosed_volume(const HexView& mesh);

}  // namespace flowcage::tests
