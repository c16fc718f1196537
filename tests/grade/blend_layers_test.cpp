// Layers on blocks that go on beyond the wall: the sheet of their chord, and how the layers end there.
#include "core/grade/blend_layers.hpp"

#include <numeric>

#include "core/grade/boundary_layers.hpp"
#include "core/mesh/visit_cells.hpp"
#include "core/quality/jacobian.hpp"
#include "core/volume/refine_volume.hpp"
#include "tests/blocks/sample_complexes.hpp"
#include "tests/catch.hpp"

using namespace flowcage;
using sample::contains;
using sample::grid_complex;
using sample::message_of;

namespace {

constexpr Index row = 8;  // blocks along x

/// A row of unit blocks along x, each 8 cells a side; the wall is the floor of the first.
struct Floor {
  WallBlocks blocks;
  BlockMesh mesh;

  explicit Floor(int refinements = 3) : blocks(seated()), mesh(blocks.complex) {
    for (int n = 0; n < refinements; ++n) mesh = refine_volume(mesh);
  }

 private:
  static WallBlocks seated() {
    const auto complex = std::make_shared<const HexComplex>(grid_complex({row, 1, 1}));
    Cage floor;
    floor.points = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    floor.faces.push_row(std::vector<Index>{0, 1, 2, 3});
    floor.face_patch = {0};
    floor.patch_names = {""};
    const std::vector<Index> corners{0, 1, row + 2, row + 1};
    return seat_blocks(complex, build_surface_level(floor), corners, "floor");
  }
};

/// The sheet of upright edges.
ChordSheet upright(const BlockMesh& mesh, bool forward = true) {
  const HexComplex& c = mesh.complex();
  const Index edge = c.hex_edges[0][8];
  return chord_sheet(mesh, c.edge_chord[edge],
                     std::array{SheetStart{edge, (c.edges[edge][0] == c.hexes[0][0]) == forward}});
}

}  // namespace

TEST_CASE("the sheet of a chord has each line once, from its near end on") {
  const Floor floor(1);
  const ChordSheet sheet = upright(floor.mesh);
  CHECK(sheet.lines.size() == (2 * row + 1) * 3);
  CHECK(sheet.faces.size() == 4 * row);
  for (const SheetLine& line : sheet.lines) {
    const std::vector<Vec3> p = sheet_positions(floor.mesh, sheet, line);
    REQUIRE(p.size() == 3);
    CHECK(p[0].z() == Approx(0).margin(1e-14));
    CHECK(p[2].z() == Approx(1));
    CHECK(p[1].head<2>() == p[0].head<2>());
  }
  const ChordSheet down = upright(floor.mesh, false);
  CHECK(sheet_positions(floor.mesh, down, down.lines[0])[0].z() == Approx(1));
  // The near end at the bottom of the first block and at the top of the last.
  const HexComplex& c = floor.mesh.complex();
  const Index first = c.hex_edges[0][8];
  const Index last = c.hex_edges[row - 1][8];
  const std::array starts{SheetStart{first, c.edges[first][0] == c.hexes[0][0]},
                          SheetStart{last, c.edges[last][0] != c.hexes[row - 1][0]}};
  CHECK(contains(message_of([&] { chord_sheet(floor.mesh, c.edge_chord[first], starts); }),
                 "has a wall at both of its ends"));
}

TEST_CASE("layers keep their height over the wall and end within two of its diagonals") {
  const Floor floor;
  LayerReport report;
  constexpr double height = 1e-4;
  const BlockMesh out = insert_boundary_layers(floor.mesh, floor.blocks, {height, 1.2, 0}, report);
  CHECK(report.min_height == Approx(height).epsilon(1e-12));
  CHECK(report.max_height == Approx(height).epsilon(1e-12));
  const ChordSheet sheet = upright(out);
  const std::vector<double> own =
      relaxed_spacing(std::vector{0.0, 0.125, 0.25, 0.375, 0.5, 0.625, 0.75, 0.875, 1.0}, report.cells);
  std::map<double, double> first_height;  // by x
  const double end = 1 + 2 * std::sqrt(2.0);
  for (const SheetLine& line : sheet.lines) {
    const std::vector<Vec3> p = sheet_positions(out, sheet, line);
    const double x = p[0].x();
    first_height[x] = p[1].z();
    CHECK(p.front().z() == Approx(0).margin(1e-14));
    CHECK(p.back().z() == Approx(1).epsilon(1e-14));
    for (std::size_t k = 1; x > end && k < p.size(); ++k) CHECK(p[k].z() == Approx(own[k]).epsilon(1e-9));
  }
  double before = height;
  for (const auto& [x, h] : first_height) {
    if (x <= 1) CHECK(h == Approx(height).epsilon(1e-9));
    CHECK(h >= before * (1 - 1e-9));
    if (x > 1 && x < end) CHECK(h > before);
    before = h;
  }
  double least = 1;
  visit_cells(out, 0, out.cell_count(), [&](Offset, const HexPoints& cell) {
    least = std::min(least, scaled_jacobian(corners_of(out, cell)));
  });
  CHECK(least > 0.8);
}

TEST_CASE("relaxed spacing: the line's own size at its end, finer at a constant ratio toward its start") {
  std::vector<double> lengths(11);
  std::iota(lengths.begin(), lengths.end(), 0.0);
  const std::vector<double> s = relaxed_spacing(lengths, 40);
  REQUIRE(s.size() == 41);
  CHECK(s.front() == 0);
  CHECK(s.back() == 10);
  // (exp(10 c) - 1) / c = 40: c = 0.2337; a cell is c thick less than its neighbour, in their sizes.
  constexpr double c = 0.23368;
  CHECK(std::expm1(10 * c) / c == Approx(40).epsilon(1e-3));
  CHECK(s[40] - s[39] == Approx(std::log1p(c) / c).epsilon(1e-3));
  for (std::size_t k = 2; k < s.size(); ++k) {
    CHECK(1 / (s[k - 1] - s[k - 2]) - 1 / (s[k] - s[k - 1]) == Approx(c).epsilon(0.02));
  }
  const std::vector<double> same = relaxed_spacing(lengths, 10);
  for (std::size_t k = 0; k < same.size(); ++k) CHECK(same[k] == Approx(lengths[k]).margin(1e-9));
  const std::vector<double> fewer = relaxed_spacing(lengths, 4);
  CHECK(std::is_sorted(fewer.begin(), fewer.end()));
  CHECK(fewer.back() == 10);
}
