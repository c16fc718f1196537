#include "core/limit/quad_blocks.hpp"

#include <algorithm>
#include <map>

#include "core/subdivide/refine.hpp"
#include "tests/catch.hpp"
#include "tests/limit/half_cages.hpp"
#include "tests/refit/hand_drawn_cages.hpp"
#include "tests/subdivide/cage_zoo.hpp"

using namespace flowcage;

namespace {

std::vector<QuadBlock> blocks_of(const SurfaceLevel& level) {
  auto blocks = partition_into_blocks(level);
  REQUIRE(blocks);
  return *blocks;
}
std::size_t block_count(const Cage& cage, int depth) {
  return blocks_of(build_levels(cage, depth).back()).size();
}

// Corner q of cell (i,j): 0 lower left, then counter-clockwise.
Index corner_vertex(const SurfaceLevel& level, const QuadBlock& block, Index i, Index j, Index q) {
  const Index cell = i + block.count_u * j;
  return level.face_vertices[block.faces[cell]][(block.turns[cell] + q) % 4];
}

// What partition_into_blocks promises.
void check_partition(const SurfaceLevel& level, const std::vector<QuadBlock>& blocks) {
  const std::vector<char> irregular = irregular_corners(level);
  std::vector<int> times(static_cast<std::size_t>(level.face_count()), 0);
  std::vector<Index> block_of(times.size());
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    const QuadBlock& block = blocks[b];
    REQUIRE(block.faces.size() == static_cast<std::size_t>(block.count_u * block.count_v));
    std::map<Index, int> edge_uses;
    for (Index j = 0; j < block.count_v; ++j) {
      for (Index i = 0; i < block.count_u; ++i) {
        const Index cell = i + block.count_u * j, face = block.faces[cell];
        ++times[face];
        block_of[face] = static_cast<Index>(b);
        CHECK(level.face_patch[face] == block.patch);
        if (i > 0) {
          CHECK(corner_vertex(level, block, i, j, 0) == corner_vertex(level, block, i - 1, j, 1));
          CHECK(corner_vertex(level, block, i, j, 3) == corner_vertex(level, block, i - 1, j, 2));
          CHECK(level.edge_sharpness[level.face_edges[face][(block.turns[cell] + 3) % 4]] == 0);
        }
        if (j > 0) {
          CHECK(corner_vertex(level, block, i, j, 0) == corner_vertex(level, block, i, j - 1, 3));
          CHECK(corner_vertex(level, block, i, j, 1) == corner_vertex(level, block, i, j - 1, 2));
          CHECK(level.edge_sharpness[level.face_edges[face][block.turns[cell]]] == 0);
        }
        for (Index q = 0; q < 4; ++q) {
          if (!irregular[level.face_vertices.offsets[face] + (block.turns[cell] + q) % 4]) continue;
          CHECK(i == (q == 1 || q == 2 ? block.count_u - 1 : 0));
          CHECK(j == (q >= 2 ? block.count_v - 1 : 0));
        }
        const std::array<bool, 4> outside{j == 0, i + 1 == block.count_u, j + 1 == block.count_v, i == 0};
        for (Index q = 0; q < 4; ++q) {
          if (outside[q]) ++edge_uses[level.face_edges[face][(block.turns[cell] + q) % 4]];
        }
      }
    }
    for (const auto& [edge, uses] : edge_uses) CHECK(uses == 1);  // no block meets itself
  }
  CHECK(std::all_of(times.begin(), times.end(), [](int n) { return n == 1; }));
}

}  // namespace

TEST_CASE("Blocks: as few as the topology allows") {
  // Each face of a cube is a block: all its vertices are irregular.
  CHECK(block_count(zoo::cube(), 1) == 6);
  CHECK(block_count(zoo::cube(), 3) == 6);
  // A torus is regular everywhere; two cuts each way, so that no block meets itself.
  CHECK(block_count(zoo::torus(4, 4), 1) == 4);
  CHECK(block_count(zoo::torus(8, 5), 2) == 4);
  CHECK(block_count(zoo::grid(3, 4), 2) == 1);
  // A mantle in two halves, and caps of a core of 2 x 2 and four blocks round it.
  CHECK(block_count(test::cylinder_cage(1, 3), 2) == 12);
  // Upper and lower side, and a cap of six: its strips end at the two inner vertices.
  CHECK(block_count(test::wing_cage({}), 2) == 8);
  CHECK(block_count(test::box_cage(Vec3(0, 0, 0), Vec3(1, 2, 3), true), 2) == 6);
}

TEST_CASE("Blocks: a border of patches that bends is followed, with T-junctions") {
  Cage cage = zoo::grid(3, 3);
  cage.patch_names = {"outer", "inner"};
  cage.face_patch.assign(9, 0);
  cage.face_patch[4] = 1;
  const std::vector<SurfaceLevel> levels = build_levels(cage, 1);
  const std::vector<QuadBlock> blocks = blocks_of(levels.back());
  check_partition(levels.back(), blocks);
  // A square in a square leaves a frame, which is no fewer than four rectangles.
  CHECK(blocks.size() == 5);
}

TEST_CASE("Blocks: rectangles that cover every cage, irregular vertices only at their corners") {
  for (const zoo::NamedCage& named : zoo::all()) {
    INFO(named.name);
    std::vector<SurfaceLevel> levels = build_levels(named.cage, 1);
    auto blocks = partition_into_blocks(levels.back());
    if (!blocks) {
      levels.push_back(build_child_level(levels.back()));
      blocks = partition_into_blocks(levels.back());
    }
    REQUIRE(blocks);
    check_partition(levels.back(), *blocks);
  }
}

TEST_CASE("Blocks of half models: mirrored edges are borders, but their vertices count as inner ones") {
  for (const HalfCage& half : half_cages()) {
    INFO(half.name);
    SurfaceLevel level = build_child_level(half_level(half));
    auto blocks = partition_into_blocks(level);
    if (!blocks) {
      level = build_child_level(level);
      blocks = partition_into_blocks(level);
    }
    REQUIRE(blocks);
    check_partition(level, *blocks);
  }
}
