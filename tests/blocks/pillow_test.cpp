#include "core/blocks/pillow.hpp"

#include "core/blocks/voxel_grid.hpp"
#include "core/mesh/block_mesh.hpp"
#include "core/optimise/untangle.hpp"
#include "tests/catch.hpp"

using namespace flowcage;

namespace {

BlockDraft cube_of_cells(Index cells) {
  VoxelGrid grid;
  for (std::vector<double>& l : grid.lines) {
    for (Index n = 0; n <= cells; ++n) l.push_back(n);
  }
  grid.body.assign(static_cast<std::size_t>(grid.cell_count()), 1);
  std::vector<Index> node;
  return draft_of_voxels(grid, 1, node);
}

HexComplex checked(const BlockDraft& draft) {
  return build_hex_complex(draft.points, draft.hexes, {7, {"side", PatchType::wall}}, draft.boundary, {});
}

double total_volume(const BlockDraft& draft) {
  double sum = 0;  // the boundary's quads are plane here: divergence theorem on their halves
  for (const BoundaryQuad& q : draft.boundary) {
    const auto p = [&](int n) -> const Vec3& { return draft.points[q.corners[n]]; };
    sum += p(0).dot(p(1).cross(p(2))) / 6 + p(0).dot(p(2).cross(p(3))) / 6;
  }
  return sum;
}

}  // namespace

TEST_CASE("a pillow under the whole boundary: one hex a quad, the boundary's points stay") {
  const BlockDraft cube = cube_of_cells(3);
  const Pillow p = pillow(cube, std::vector<char>(27, 1), [](const BoundaryQuad&) { return true; });
  CHECK(p.draft.hexes.size() == 27 + 54);
  CHECK(p.layer_hexes.size() == 54);
  CHECK(p.split_from.size() == 56);
  CHECK(p.draft.boundary.size() == 54);
  for (std::size_t b = 0; b < cube.boundary.size(); ++b) {
    CHECK(p.draft.boundary[b].corners == cube.boundary[b].corners);
  }
  const BlockMesh mesh(std::make_shared<const HexComplex>(checked(p.draft)));
  CHECK(hex_validity(mesh).inverted == 0);
}

TEST_CASE("a pillow that ends at the boundary: its side belongs to the patch beside it") {
  const BlockDraft cube = cube_of_cells(3);
  const Pillow p = pillow(cube, std::vector<char>(27, 1), [](const BoundaryQuad& q) { return q.patch != 1; });
  CHECK(p.draft.hexes.size() == 27 + 45);
  std::array<int, 8> quads{};
  for (const BoundaryQuad& q : p.draft.boundary) ++quads[q.patch];
  CHECK(quads[1] == 9 + 12);  // the side where it ends gets a ring of quads
  for (int side = 2; side <= 6; ++side) CHECK(quads[side] == 9);
  const HexComplex complex = checked(p.draft);
  CHECK(hex_validity(BlockMesh(std::make_shared<const HexComplex>(complex))).inverted == 0);
  for (const BoundaryQuad& q : p.draft.boundary) {
    if (q.patch != 1) continue;
    for (const Index v : q.corners) CHECK(p.draft.points[v].x() == 0);
  }
  CHECK(total_volume(p.draft) == Approx(27));
}

TEST_CASE("a pillow round one hex inside: six hexes, nothing else changes") {
  const BlockDraft cube = cube_of_cells(3);
  std::vector<char> set(27, 0);
  set[13] = 1;
  const Pillow p = pillow(cube, set, [](const BoundaryQuad&) { return true; });
  CHECK(p.draft.hexes.size() == 33);
  CHECK(p.split_from.size() == 8);
  CHECK(hex_validity(BlockMesh(std::make_shared<const HexComplex>(checked(p.draft)))).inverted == 0);
}

TEST_CASE("a pillow round a column that runs through: its ends are on the boundary") {
  const BlockDraft cube = cube_of_cells(3);
  std::vector<char> set(27, 0);
  for (const int h : {4, 13, 22}) set[h] = 1;  // along z
  const Pillow p = pillow(cube, set, [](const BoundaryQuad&) { return false; });
  CHECK(p.draft.hexes.size() == 27 + 12);
  CHECK(hex_validity(BlockMesh(std::make_shared<const HexComplex>(checked(p.draft)))).inverted == 0);
  CHECK(total_volume(p.draft) == Approx(27));
}
