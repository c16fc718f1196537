#include "core/blocks/voxel_grid.hpp"

#include "core/blocks/grid_lines.hpp"
#include "tests/catch.hpp"

using namespace flowcage;

namespace {

VoxelGrid even_grid(Index cells) {
  VoxelGrid grid;
  for (std::vector<double>& l : grid.lines) {
    for (Index n = 0; n <= cells; ++n) l.push_back(n);
  }
  grid.body.assign(static_cast<std::size_t>(grid.cell_count()), 0);
  return grid;
}

}  // namespace

TEST_CASE("voxels that touch along an edge or at a point are no manifold, and are repaired") {
  for (const std::array<Index, 3>& other : {std::array<Index, 3>{2, 2, 1}, std::array<Index, 3>{2, 2, 2}}) {
    VoxelGrid grid = even_grid(4);
    const Index first = grid.cell({1, 1, 1}), second = grid.cell(other);
    grid.body[first] = grid.body[second] = 1;
    CHECK(non_manifold_nodes(grid).size() == (other[2] == 1 ? 2 : 1));
    std::vector<double> fraction(grid.body.size(), 0);
    fraction[first] = 1;
    fraction[second] = 0.6;
    CHECK(repair_manifold(grid, fraction) >= 1);
    CHECK(non_manifold_nodes(grid).empty());
    CHECK(grid.body[first] == 1);
  }
}

TEST_CASE("one voxel is no defect") {
  VoxelGrid grid = even_grid(3);
  grid.body[grid.cell({1, 1, 1})] = 1;
  CHECK(non_manifold_nodes(grid).empty());
  CHECK(repair_manifold(grid, std::vector<double>(grid.body.size(), 0)) == 0);
  CHECK(voxel_parts(grid, 1).count == 1);
  CHECK(voxel_parts(grid, 0).count == 1);
}

TEST_CASE("a shell of voxels cuts the fluid in two parts") {
  VoxelGrid grid = even_grid(5);
  for (Index c = 0; c < grid.cell_count(); ++c) {
    const std::array<Index, 3> at = grid.cell_at(c);
    const bool inner = std::all_of(at.begin(), at.end(), [](Index i) { return i >= 1 && i <= 3; });
    grid.body[c] = inner && at != std::array<Index, 3>{2, 2, 2} ? 1 : 0;
  }
  const VoxelParts fluid = voxel_parts(grid, 0);
  CHECK(fluid.count == 2);
  CHECK(fluid.part[0] == 0);
  CHECK(fluid.part[grid.cell({2, 2, 2})] == 1);
}

TEST_CASE("the draft of a grid round one voxel: 26 hexes, 6 wall quads, 9 a side, right-handed") {
  VoxelGrid grid = even_grid(3);
  grid.body[grid.cell({1, 1, 1})] = 1;
  std::vector<Index> node;
  const BlockDraft draft = draft_of_voxels(grid, 0, node);
  CHECK(draft.hexes.size() == 26);
  CHECK(draft.points.size() == 64);
  std::array<int, 7> quads{};
  for (const BoundaryQuad& q : draft.boundary) ++quads[q.patch];
  CHECK(quads == std::array<int, 7>{6, 9, 9, 9, 9, 9, 9});
  const HexComplex complex =
      build_hex_complex(draft.points, draft.hexes, {7, {"side", PatchType::wall}}, draft.boundary, {});
  CHECK(complex.hexes.size() == 26);
  for (const HexPoints& h : draft.hexes) {
    const Vec3 &o = draft.points[h[0]], i = draft.points[h[1]], j = draft.points[h[3]],
               k = draft.points[h[4]];
    CHECK((i - o).cross(j - o).dot(k - o) == Approx(1));
  }
}

TEST_CASE("grid lines stand on anchors, opposite charts stay apart, the rest is filled and grows") {
  AmbientFrame frame;
  frame.far = Box3(Vec3::Constant(-10), Vec3::Constant(10));
  frame.size = {0.5, 0.5, 0.5};
  std::array<std::vector<LineAnchor>, 3> anchors;
  anchors[0] = {{-1, 1, -1}, {1, 1, 1}};
  anchors[1] = {{-0.01, 1, -1}, {0.01, 1, 1}};            // a thin plate
  anchors[2] = {{-1, 1, -1}, {-0.95, 5, -1}, {1, 1, 1}};  // two steps of one side: the larger stays
  const auto lines = grid_lines(frame, anchors, 2);
  const auto has = [](const std::vector<double>& l, double v) {
    return std::any_of(l.begin(), l.end(), [&](double x) { return std::abs(x - v) < 1e-12; });
  };
  for (int axis = 0; axis < 3; ++axis) {
    CHECK(lines[axis].front() == -10);
    CHECK(lines[axis].back() == 10);
    CHECK(std::is_sorted(lines[axis].begin(), lines[axis].end()));
  }
  for (const double v : {-1.0, -0.5, 0.0, 0.5, 1.0}) CHECK(has(lines[0], v));
  CHECK(has(lines[1], -0.01));
  CHECK(has(lines[1], 0.01));
  CHECK(has(lines[2], -0.95));
  CHECK_FALSE(has(lines[2], -1));
}
