#include "core/blocks/drawn_blocks.hpp"

#include "core/base/error.hpp"
#include "core/mesh/block_mesh.hpp"
#include "tests/catch.hpp"

using namespace flowcage;

namespace {

/// n^3 cubes of edge 1 from the origin on, without the one at (n/2, n/2, n/2) where `hole`; boundary faces in
/// one patch of walls.
HexMesh cubes(Index n, bool hole) {
  std::vector<Vec3> points;
  const auto at = [n](Index i, Index j, Index k) { return i + (n + 1) * (j + (n + 1) * k); };
  for (Index k = 0; k <= n; ++k) {
    for (Index j = 0; j <= n; ++j) {
      for (Index i = 0; i <= n; ++i) points.emplace_back(i, j, k);
    }
  }
  const auto solid = [&](Index i, Index j, Index k) {
    const bool inside = std::min({i, j, k}) >= 0 && std::max({i, j, k}) < n;
    return inside && !(hole && i == n / 2 && j == n / 2 && k == n / 2);
  };
  std::vector<HexPoints> cells;
  BoundaryPatch wall{"body", PatchType::wall, {}, {}};
  for (Index k = 0; k < n; ++k) {
    for (Index j = 0; j < n; ++j) {
      for (Index i = 0; i < n; ++i) {
        if (!solid(i, j, k)) continue;
        const HexPoints hex{
            at(i, j, k),     at(i + 1, j, k),     at(i + 1, j + 1, k),     at(i, j + 1, k),
            at(i, j, k + 1), at(i + 1, j, k + 1), at(i + 1, j + 1, k + 1), at(i, j + 1, k + 1)};
        const std::array<bool, 6> open{!solid(i - 1, j, k), !solid(i + 1, j, k), !solid(i, j - 1, k),
                                       !solid(i, j + 1, k), !solid(i, j, k - 1), !solid(i, j, k + 1)};
        for (int f = 0; f < 6; ++f) {
          if (!open[f]) continue;
          std::array<Index, 4> quad{};
          for (int c = 0; c < 4; ++c) quad[c] = hex[hex_faces[f][c]];
          wall.quads.push_back(quad);
          wall.owner.push_back(static_cast<Index>(cells.size()));
        }
        cells.push_back(hex);
      }
    }
  }
  return {points, cells, {wall}};
}

}  // namespace

TEST_CASE("of blocks with walls only, the largest part of the boundary is the far field") {
  const DrawnBlocks blocks = sort_out_blocks(cubes(3, true), false, "cubes");
  CHECK(blocks.wall.cage.faces.size() == 6);
  CHECK(blocks.wall.cage.points.size() == 8);
  CHECK(blocks.wall.cage.patch_names == std::vector<std::string>{"body"});
  CHECK(blocks.patches.back().type == PatchType::farfield);
  // The blocks beside the hole's edges and corners touch it, so it gets a layer: one block a face.
  CHECK(blocks.pillowed);
  CHECK(blocks.draft.hexes.size() == 26 + 6);
  // The far field's twelve edges of three.
  CHECK(blocks.sharp.size() == 36);
  // Counter-clockwise seen from the fluid, which is outside of the hole.
  const Cage& cage = blocks.wall.cage;
  const Vec3 centre(1.5, 1.5, 1.5);
  for (Index f = 0; f < cage.faces.size(); ++f) {
    const auto v = cage.faces[f];
    const Vec3 normal = (cage.points[v[1]] - cage.points[v[0]]).cross(cage.points[v[3]] - cage.points[v[0]]);
    CHECK(normal.dot(cage.points[v[0]] - centre) > 0);
  }
}

TEST_CASE("a duct's blocks are all wall; a body's are not") {
  const DrawnBlocks duct = sort_out_blocks(cubes(2, false), true, "duct");
  CHECK(duct.wall.cage.faces.size() == 24);
  CHECK(duct.pillowed);
  CHECK(duct.draft.hexes.size() == 8 + 24);
  CHECK_THROWS_AS(sort_out_blocks(cubes(2, false), false, "duct"), Error);
}
