// Meshes that the tests of the optimiser share.
#pragma once
#include <random>

#include "core/mesh/block_mesh.hpp"
#include "tests/blocks/sample_complexes.hpp"

namespace flowcage::sample {

/// Moves every point by f(its position).
template <typename F>
void map_points(BlockMesh& mesh, const F& f) {
  for (Vec3& p : mesh.mutable_points()) p = f(p);
}

/// Points of the blocks by trilinear interpolation of their corners; missing divisions are 4.
inline BlockMesh divided(const HexComplex& complex, std::vector<Index> divisions) {
  divisions.resize(static_cast<std::size_t>(complex.chord_count), 4);
  BlockMesh mesh(std::make_shared<HexComplex>(complex), divisions,
                 std::vector<Vec3>(static_cast<std::size_t>(BlockMesh::point_count(complex, divisions))));
  for (Index b = 0; b < mesh.block_count(); ++b) {
    const auto n = mesh.dims(b);
    for (Index k = 0; k <= n[2]; ++k) {
      for (Index j = 0; j <= n[1]; ++j) {
        for (Index i = 0; i <= n[0]; ++i) {
          const Vec3 t(double(i) / n[0], double(j) / n[1], double(k) / n[2]);
          Vec3 p = Vec3::Zero();
          for (int c = 0; c < 8; ++c) {
            double w = 1;
            for (int a = 0; a < 3; ++a) w *= hex_corner_ijk[c][a] == 1 ? t[a] : 1 - t[a];
            p += w * complex.points[complex.hexes[b][c]];
          }
          mesh.mutable_points()[mesh.point_number(b, i, j, k)] = p;
        }
      }
    }
  }
  return mesh;
}

/// n[0] x n[1] x n[2] unit cells in one block; patches i-min .. k-max.
inline BlockMesh box_mesh(std::array<Index, 3> n) {
  const HexComplex one = grid_complex({1, 1, 1});
  std::vector<Index> divisions(static_cast<std::size_t>(one.chord_count));
  for (int a = 0; a < 3; ++a) divisions[one.edge_chord[one.hex_edges[0][4 * a]]] = n[a];
  BlockMesh mesh = divided(one, divisions);
  map_points(mesh, [&](const Vec3& p) { return Vec3(p[0] * n[0], p[1] * n[1], p[2] * n[2]); });
  return mesh;
}

/// Six blocks between the cubes |x|max = 1 (patch 0 "wall") and 2 (patch 1 "farfield"), `around` cells on
/// each side of the cube, `out` between them.
inline BlockMesh cube_shell(Index around, Index out) {
  std::vector<Vec3> points;
  for (const double size : {1.0, 2.0}) {
    for (int c = 0; c < 8; ++c) {
      const auto [i, j, k] = hex_corner_ijk[c];
      points.push_back(size * Vec3(2.0 * i - 1, 2.0 * j - 1, 2.0 * k - 1));
    }
  }
  std::vector<HexPoints> hexes;
  std::vector<BoundaryQuad> boundary;
  for (const auto& f : hex_faces) {  // outward quad of the inner cube is the bottom
    hexes.push_back({f[0], f[1], f[2], f[3], f[0] + 8, f[1] + 8, f[2] + 8, f[3] + 8});
    boundary.push_back({{f[0], f[1], f[2], f[3]}, 0});
    boundary.push_back({{f[0] + 8, f[1] + 8, f[2] + 8, f[3] + 8}, 1});
  }
  const HexComplex complex = build_hex_complex(
      points, hexes, {{"wall", PatchType::wall}, {"farfield", PatchType::farfield}}, boundary, {});
  std::vector<Index> divisions(static_cast<std::size_t>(complex.chord_count), around);
  divisions[complex.edge_chord[complex.hex_edges[0][8]]] = out;
  return divided(complex, divisions);
}

/// A cube shell mapped between a box of half sizes `half` and a sphere; cells grow geometrically outward,
/// from the wall on.
struct ShellShape {
  Vec3 half = Vec3::Ones();
  double radius = 10;
  double growth = 1.3;
  Index out = 8;
};
inline Vec3 shell_point(const Vec3& p, const ShellShape& shape) {
  const double r = p.cwiseAbs().maxCoeff();
  const Vec3 q = p / r;
  const double layers = (r - 1) * shape.out;
  const double s = (std::pow(shape.growth, layers) - 1) / (std::pow(shape.growth, shape.out) - 1);
  const Vec3 inner = q.cwiseProduct(shape.half);
  return inner + s * (shape.radius * q.normalized() - inner);
}

/// Moves inner points by a random vector of at most `size` in each coordinate.
inline void shake(BlockMesh& mesh, double size, std::mt19937& random) {
  std::vector<std::uint8_t> boundary(mesh.points().size());
  for (const BoundaryPatch& patch : mesh.patches()) {
    for (const auto& quad : patch.quads) {
      for (const Index p : quad) boundary[p] = 1;
    }
  }
  // Not uniform_real_distribution: its numbers differ between standard libraries.
  const auto number = [&] { return 2.0 * static_cast<double>(random()) / 4294967295.0 - 1.0; };
  for (std::size_t p = 0; p < boundary.size(); ++p) {
    const Vec3 move(number(), number(), number());
    if (boundary[p] == 0) mesh.mutable_points()[p] += size * move;
  }
}

}  // namespace flowcage::sample
