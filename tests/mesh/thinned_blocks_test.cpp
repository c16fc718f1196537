#include "core/mesh/thinned_blocks.hpp"

#include <numeric>

#include "core/mesh/visit_cells.hpp"
#include "core/quality/jacobian.hpp"
#include "tests/blocks/sample_complexes.hpp"
#include "tests/catch.hpp"

using namespace flowcage;

namespace {

/// Unit blocks, their chords along x, y, z divided into n[0], n[1], n[2] equal cells each.
BlockMesh divided_grid(std::array<Index, 3> blocks, std::array<Index, 3> n) {
  const auto complex = std::make_shared<const HexComplex>(sample::grid_complex(blocks));
  std::vector<Index> divisions(complex->chord_count);
  for (std::size_t e = 0; e < complex->edges.size(); ++e) {
    const Vec3 d = complex->points[complex->edges[e][1]] - complex->points[complex->edges[e][0]];
    int axis = 0;
    d.cwiseAbs().maxCoeff(&axis);
    divisions[complex->edge_chord[e]] = n[axis];
  }
  BlockMesh mesh(complex, divisions, std::vector<Vec3>(BlockMesh::point_count(*complex, divisions)));
  for (Index b = 0; b < mesh.block_count(); ++b) {
    const auto dims = mesh.dims(b);
    for (Index k = 0; k <= dims[2]; ++k) {
      for (Index j = 0; j <= dims[1]; ++j) {
        for (Index i = 0; i <= dims[0]; ++i) {
          mesh.mutable_points()[mesh.point_number(b, i, j, k)] =
              complex->points[complex->hexes[b][0]] +
              Vec3(double(i) / dims[0], double(j) / dims[1], double(k) / dims[2]);
        }
      }
    }
  }
  return mesh;
}

}  // namespace

TEST_CASE("thinned blocks: points of the finer mesh, the same volume, the worst of the covered cells") {
  const BlockMesh fine = divided_grid({2, 1, 2}, {9, 8, 10});
  REQUIRE(fine.cell_count() == 4 * 720);
  // Stride 3: 9 keeps 3; 8 keeps 3 in thirds; 10 keeps 4.
  const ThinnedBlocks thinned = thin_blocks(fine, 150);
  CHECK(thinned.stride == 3);
  CHECK(thinned.mesh.cell_count() == 4 * 3 * 3 * 4);
  REQUIRE(thinned.point.size() == thinned.mesh.points().size());
  for (std::size_t p = 0; p < thinned.point.size(); ++p) {
    CHECK(thinned.mesh.points()[p] == fine.points()[thinned.point[p]]);
  }
  double volume = 0;
  visit_cells(thinned.mesh, 0, thinned.mesh.cell_count(), [&](Offset, const HexPoints& cell) {
    const auto corners = corners_of(thinned.mesh, cell);
    CHECK(scaled_jacobian(corners) == Approx(1));
    volume += corner_jacobians(corners)[0];
  });
  CHECK(volume == Approx(4));

  // One bad cell: the cell that covers it, and no other, has its value.
  std::vector<float> values(static_cast<std::size_t>(fine.cell_count()), 1.0F);
  const Offset bad = fine.block_begin(2) + 4 + 9 * (7 + 8 * 5);
  values[bad] = -0.5F;
  const std::vector<float> least = least_of_covered(fine, thinned, values);
  REQUIRE(least.size() == 144);
  CHECK(std::accumulate(least.begin(), least.end(), 0.0F) == Approx(142.5));
  // (4, 7, 5) of 9 x 8 x 10 lies in the kept cell (1, 2, 2) of 3 x 3 x 4, whose lines are 0 3 5 8 and 0 3 5
  // 8 10.
  CHECK(least[thinned.mesh.block_begin(2) + 1 + 3 * (2 + 3 * 2)] == -0.5F);

  CHECK(thin_blocks(fine, fine.cell_count()).stride == 1);
  CHECK(thin_blocks(fine, 1).mesh.cell_count() == 4);  // one cell a block
}

TEST_CASE("thinned blocks fit, from whatever end a block counts the divisions") {
  // The same lines from both ends, for any odd or even number of divisions: neighbours keep the same ones.
  for (const Index n : {7, 8, 9, 10, 11}) {
    for (const Offset most : {40, 90, 200}) {
      const ThinnedBlocks thinned = thin_blocks(divided_grid({2, 1, 1}, {n, n, n}), most);
      for (Index b = 0; b < 2; ++b) {
        for (int axis = 0; axis < 3; ++axis) {
          const Index kept = thinned.mesh.dims(b)[axis];
          for (Index t = 0; t <= kept; ++t) {
            std::array<Index, 3> low{}, high{};
            low[axis] = t;
            high[axis] = kept - t;
            const Vec3 p = thinned.mesh.points()[thinned.mesh.point_number(b, low[0], low[1], low[2])];
            const Vec3 q = thinned.mesh.points()[thinned.mesh.point_number(b, high[0], high[1], high[2])];
            const double middle = axis == 0 ? 2 * b + 1 : 1;
            CHECK(p[axis] + q[axis] == Approx(middle));
          }
        }
      }
    }
  }
}
