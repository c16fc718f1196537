#include "core/blocks/wall_blocks.hpp"

#include "core/base/error.hpp"
#include "core/blocks/shell.hpp"
#include "core/volume/refine_volume.hpp"
#include "core/volume/wall_columns.hpp"
#include "tests/blocks/sample_cages.hpp"
#include "tests/catch.hpp"

using namespace flowcage;
using sample::box_cage;

TEST_CASE("blocks given in any orientation are seated as the shell's own") {
  const Shell shell = build_shell(sample::sharp_box_cage({2, 2, 2}), box_cage({12, 12, 12}));
  // The same blocks, each turned so that another axis leaves the wall.
  HexComplex turned = *shell.complex;
  std::vector<HexPoints> hexes;
  for (std::size_t h = 0; h < turned.hexes.size(); ++h) {
    const HexPoints& x = turned.hexes[h];
    if (h % 3 == 0) hexes.push_back(x);
    if (h % 3 == 1) hexes.push_back({x[0], x[3], x[7], x[4], x[1], x[2], x[6], x[5]});
    if (h % 3 == 2) hexes.push_back({x[5], x[4], x[7], x[6], x[1], x[0], x[3], x[2]});
  }
  std::vector<BoundaryQuad> boundary;
  for (std::size_t q = 0; q < turned.quads.size(); ++q) {
    if (turned.quad_hexes[q][1] == no_index) boundary.push_back({turned.quads[q], turned.quad_patch[q]});
  }
  std::vector<SharpEdge> sharp;
  for (std::size_t e = 0; e < turned.edges.size(); ++e) {
    if (turned.edge_sharpness[e] > 0) {
      sharp.push_back({turned.edges[e][0], turned.edges[e][1], turned.edge_sharpness[e]});
    }
  }
  const auto complex = std::make_shared<const HexComplex>(
      build_hex_complex(turned.points, hexes, turned.patches, boundary, sharp));
  std::vector<Index> corner(shell.wall.vertex_count());
  for (std::size_t v = 0; v < corner.size(); ++v) corner[v] = static_cast<Index>(v);
  const WallBlocks blocks = seat_blocks(complex, shell.wall, corner, "blocks");
  CHECK(line_chords(blocks).size() == 1);

  BlockMesh a = refine_volume(start_volume(shell, shell.wall_points, 1));
  BlockMesh b = refine_volume(BlockMesh(complex));
  const WallColumns of_a = wall_columns(a, shell);
  const WallColumns of_b = wall_columns(b, blocks);
  REQUIRE(of_a.lines.size() == of_b.lines.size());
  CHECK(of_a.faces == of_b.faces);
  CHECK(of_a.edges == of_b.edges);
  for (std::size_t l = 0; l < of_a.lines.size(); ++l) {
    for (Index k = 0; k <= of_a.layers; ++k) {
      const Vec3& p = a.points()[line_point(a, shell, of_a.lines[l], k)];
      const Vec3& q = b.points()[line_point(b, blocks, of_b.lines[l], k)];
      CHECK((p - q).norm() < 1e-14);
    }
  }
}

TEST_CASE("blocks that touch the wall with two faces are refused with the place") {
  // One block in the corner of a wall of two quads.
  std::vector<Vec3> points;
  for (const auto& [x, y, z] : std::vector<std::array<double, 3>>{
           {0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}}) {
    points.emplace_back(x, y, z);
  }
  std::vector<BoundaryQuad> boundary;
  for (Index f = 0; f < 6; ++f) {
    const auto& c = hex_faces[f];
    boundary.push_back({{c[0], c[1], c[2], c[3]}, f == 0 || f == 2 ? 0 : 1});
  }
  const auto complex = std::make_shared<const HexComplex>(
      build_hex_complex(points, {{0, 1, 2, 3, 4, 5, 6, 7}},
                        {{"wall", PatchType::wall}, {"far", PatchType::farfield}}, boundary, {}));
  Cage cage;
  cage.points = {points[0], points[3], points[7], points[4], points[1], points[5]};
  cage.faces.push_row(std::vector<Index>{0, 1, 2, 3});
  cage.faces.push_row(std::vector<Index>{0, 3, 5, 4});
  cage.patch_names = {""};
  cage.face_patch = {0, 0};
  const std::vector<Index> corner{0, 3, 7, 4, 1, 5};
  CHECK_THROWS_WITH(seat_blocks(complex, build_surface_level(cage), corner, "blocks.msh"),
                    Catch::Matchers::Contains("blocks.msh") && Catch::Matchers::Contains("two faces"));
}
