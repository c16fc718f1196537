#include "core/mesh/block_mesh.hpp"

#include <map>
#include <random>
#include <set>

#include "core/base/error.hpp"
#include "core/mesh/hex_adjacency.hpp"
#include "core/mesh/hex_numbering.hpp"
#include "tests/blocks/sample_complexes.hpp"
#include "tests/catch.hpp"

using namespace flowcage;
using sample::contains;
using sample::message_of;

TEST_CASE("hex numbering: edges and faces agree with the corners' positions") {
  for (int c = 0; c < 8; ++c) {
    const auto [i, j, k] = hex_corner_ijk[c];
    CHECK(hex_corner_at(i, j, k) == c);
  }
  for (int e = 0; e < 12; ++e) {
    const auto& a = hex_corner_ijk[hex_edges[e][0]];
    const auto& b = hex_corner_ijk[hex_edges[e][1]];
    const int axis = e / 4;
    int others = 0;
    for (int x = 0, bit = 1; x < 3; ++x) {
      if (x == axis) continue;
      CHECK(a[x] == b[x]);
      others += bit * a[x];
      bit = 2;
    }
    CHECK(a[axis] == 0);
    CHECK(b[axis] == 1);
    CHECK(e % 4 == others);
  }
  for (int f = 0; f < 6; ++f) {
    for (const int c : hex_faces[f]) CHECK(hex_corner_ijk[c][f / 2] == f % 2);
  }
  // As the formats' own manuals list them (corners from 0).
  const int vtk[12][2] = {{0, 1}, {1, 2}, {2, 3}, {3, 0}, {4, 5}, {5, 6},
                          {6, 7}, {7, 4}, {0, 4}, {1, 5}, {2, 6}, {3, 7}};
  const int cgns[12][2] = {{0, 1}, {1, 2}, {2, 3}, {3, 0}, {0, 4}, {1, 5},
                           {2, 6}, {3, 7}, {4, 5}, {5, 6}, {6, 7}, {7, 4}};
  const int blockmesh[12][2] = {{0, 1}, {3, 2}, {7, 6}, {4, 5}, {0, 3}, {1, 2},
                                {5, 6}, {4, 7}, {0, 4}, {1, 5}, {2, 6}, {3, 7}};
  const int cgns_faces[6][4] = {{0, 3, 2, 1}, {0, 1, 5, 4}, {1, 2, 6, 5},
                                {2, 3, 7, 6}, {0, 4, 7, 3}, {4, 5, 6, 7}};
  const auto same_edge = [](const int* given, int ours) {
    return std::set<int>{given[0], given[1]} == std::set<int>(hex_edges[ours].begin(), hex_edges[ours].end());
  };
  for (int n = 0; n < 12; ++n) {
    CHECK(same_edge(vtk[n], hex_edge_of_vtk[n]));
    CHECK(same_edge(cgns[n], hex_edge_of_cgns[n]));
    CHECK(same_edge(blockmesh[n], hex_edge_of_blockmesh[n]));
  }
  for (int n = 0; n < 6; ++n) {
    const auto& ours = hex_faces[hex_face_of_cgns[n]];
    CHECK(std::set<int>(ours.begin(), ours.end()) == std::set<int>(cgns_faces[n], cgns_faces[n] + 4));
  }
}

namespace {

/// Every block's lattice point, from coordinates: positions interpolated in the coarse hexes identify shared
/// points without any use of the numbering.
void check_numbering(const HexComplex& complex, const std::vector<Index>& divisions) {
  const auto shared = std::make_shared<const HexComplex>(complex);
  const Index count = BlockMesh::point_count(complex, divisions);
  BlockMesh mesh(shared, divisions, std::vector<Vec3>(count, Vec3::Zero()));
  std::map<std::array<long, 3>, Index> by_place;
  std::vector<std::array<long, 3>> place_of(count, {-1, -1, -1});
  Offset cell = 0;
  for (Index b = 0; b < mesh.block_count(); ++b) {
    const auto n = mesh.dims(b);
    const auto where = [&](Index i, Index j, Index k) {
      Vec3 p = Vec3::Zero();
      for (int c = 0; c < 8; ++c) {
        const auto& s = hex_corner_ijk[c];
        const double u = static_cast<double>(i) / n[0];
        const double v = static_cast<double>(j) / n[1];
        const double w = static_cast<double>(k) / n[2];
        p += (s[0] ? u : 1 - u) * (s[1] ? v : 1 - v) * (s[2] ? w : 1 - w) *
             complex.points[complex.hexes[b][c]];
      }
      return std::array<long, 3>{std::lround(p.x() * 1e7), std::lround(p.y() * 1e7),
                                 std::lround(p.z() * 1e7)};
    };
    for (Index k = 0; k <= n[2]; ++k) {
      for (Index j = 0; j <= n[1]; ++j) {
        for (Index i = 0; i <= n[0]; ++i) {
          const Index number = mesh.point_number(b, i, j, k);
          REQUIRE(number >= 0);
          REQUIRE(number < count);
          const auto at = where(i, j, k);
          const auto [it, fresh] = by_place.emplace(at, number);
          REQUIRE(it->second == number);  // watertight: one place, one number
          REQUIRE((place_of[number] == at || fresh));
          place_of[number] = at;
        }
      }
    }
    CHECK(mesh.block_begin(b) == cell);
    for (Index k = 0; k < n[2]; ++k) {
      for (Index j = 0; j < n[1]; ++j) {
        for (Index i = 0; i < n[0]; ++i, ++cell) {
          std::array<HexPoints, 1> one{};
          mesh.read_cells(cell, one);
          REQUIRE(mesh.block_of(cell) == b);
          for (int c = 0; c < 8; ++c) {
            const auto& s = hex_corner_ijk[c];
            REQUIRE(one[0][c] == mesh.point_number(b, i + s[0], j + s[1], k + s[2]));
          }
        }
      }
    }
  }
  CHECK(static_cast<Index>(by_place.size()) == count);  // every number is used
  CHECK(cell == mesh.cell_count());

  // Batches that start and end anywhere; patches as the cell faces that occur once.
  std::vector<HexPoints> all(mesh.cell_count());
  mesh.read_cells(0, all);
  std::mt19937 random(7);
  for (int n = 0; n < 20; ++n) {
    const Offset begin = random() % mesh.cell_count();
    std::vector<HexPoints> part(random() % (mesh.cell_count() - begin) + 1);
    mesh.read_cells(begin, part);
    REQUIRE(std::equal(part.begin(), part.end(), all.begin() + begin));
  }
  std::map<std::array<Index, 4>, std::vector<std::pair<Index, std::array<Index, 4>>>> faces;
  for (Offset c = 0; c < mesh.cell_count(); ++c) {
    for (const auto& f : hex_faces) {
      const std::array<Index, 4> q{all[c][f[0]], all[c][f[1]], all[c][f[2]], all[c][f[3]]};
      auto key = q;
      std::sort(key.begin(), key.end());
      faces[key].push_back({static_cast<Index>(c), q});
    }
  }
  std::size_t boundary = 0;
  for (const auto& [key, uses] : faces) {
    REQUIRE(uses.size() <= 2);
    boundary += uses.size() == 1 ? 1 : 0;
  }
  std::size_t listed = 0;
  for (const BoundaryPatch& patch : mesh.patches()) {
    REQUIRE(patch.quads.size() == patch.owner.size());
    for (std::size_t n = 0; n < patch.quads.size(); ++n, ++listed) {
      auto key = patch.quads[n];
      std::sort(key.begin(), key.end());
      const auto& uses = faces.at(key);
      REQUIRE(uses.size() == 1);
      REQUIRE(uses[0].first == patch.owner[n]);
      auto turned = uses[0].second;  // the same cycle, outward
      std::rotate(turned.begin(), std::find(turned.begin(), turned.end(), patch.quads[n][0]), turned.end());
      REQUIRE(turned == patch.quads[n]);
    }
  }
  CHECK(listed == boundary);
}

/// The closed form of a block mesh's adjacency against the faces that match by their points.
void check_adjacency(const BlockMesh& mesh) {
  const FaceMatching matched = match_faces(mesh);
  const HexAdjacency closed = build_hex_adjacency(mesh);
  REQUIRE(closed.across.empty());
  REQUIRE(matched.uncovered.empty());
  CHECK(closed.internal_faces == matched.adjacency.internal_faces);
  CHECK(closed.boundary_owner == matched.adjacency.boundary_owner);
  std::vector<CellNeighbours> all(mesh.cell_count()), expected(mesh.cell_count());
  closed.read_across(0, all);
  matched.adjacency.read_across(0, expected);
  REQUIRE(all == expected);
  std::mt19937 random(8);
  for (int n = 0; n < 20; ++n) {
    const Offset begin = random() % mesh.cell_count();
    std::vector<CellNeighbours> part(random() % (mesh.cell_count() - begin) + 1);
    closed.read_across(begin, part);
    REQUIRE(std::equal(part.begin(), part.end(), expected.begin() + begin));
  }
}

}  // namespace

TEST_CASE("block mesh numbering is watertight on random complexes") {
  std::mt19937 random(20111024);
  for (int trial = 0; trial < 60; ++trial) {
    const HexComplex complex = sample::random_complex(random);
    std::vector<Index> divisions(complex.chord_count);
    for (Index& d : divisions) d = 1 + static_cast<Index>(random() % 4);
    check_numbering(complex, divisions);
  }
}

TEST_CASE("block adjacency: the closed form is what the faces' points say") {
  std::mt19937 random(20261130);
  for (int trial = 0; trial < 60; ++trial) {
    const HexComplex complex = trial == 0 ? sample::grid_complex({2, 3, 2}) : sample::random_complex(random);
    std::vector<Index> divisions(complex.chord_count);
    for (Index& d : divisions) d = 1 + static_cast<Index>(random() % 5);
    const Index points = BlockMesh::point_count(complex, divisions);
    check_adjacency(
        {std::make_shared<const HexComplex>(complex), divisions, std::vector<Vec3>(points, Vec3::Zero())});
  }
}

TEST_CASE("hex complex: adjacency, chords and boundary of a grid of blocks") {
  const HexComplex c = sample::grid_complex({2, 3, 4});
  CHECK(c.points.size() == 60);
  CHECK(c.edges.size() == 2 * 20 + 3 * 15 + 4 * 12);
  CHECK(c.quads.size() == 3 * 12 + 4 * 8 + 5 * 6);
  CHECK(c.chord_count == 2 + 3 + 4);
  Index boundary = 0;
  for (std::size_t q = 0; q < c.quads.size(); ++q) {
    CHECK((c.quad_patch[q] == no_index) == (c.quad_hexes[q][1] != no_index));
    if (c.quad_patch[q] == no_index) continue;
    ++boundary;
    const Vec3 normal = (c.points[c.quads[q][2]] - c.points[c.quads[q][0]])
                            .cross(c.points[c.quads[q][3]] - c.points[c.quads[q][1]]);
    const Vec3 centre = (c.points[c.quads[q][0]] + c.points[c.quads[q][2]]) / 2;
    CHECK(normal.dot(centre - Vec3(1, 1.5, 2)) > 0);
  }
  CHECK(boundary == 2 * (6 + 8 + 12));
  Index sharp = 0;
  for (const double s : c.edge_sharpness) sharp += s > 0 ? 1 : 0;
  CHECK(sharp == 4 * (2 + 3 + 4));  // each side is a patch of its own
}

TEST_CASE("hex complex: what is no block mesh is refused with its place") {
  const HexComplex c = sample::grid_complex({2, 1, 1});
  const auto boundary = sample::boundary_of(c);
  const auto build = [&](auto change) {
    auto points = c.points;
    auto hexes = c.hexes;
    auto quads = boundary;
    change(points, hexes, quads);
    return build_hex_complex(points, hexes, c.patches, quads, {});
  };
  using Points = std::vector<Vec3>&;
  using Hexes = std::vector<HexPoints>&;
  using Quads = std::vector<BoundaryQuad>&;
  CHECK_NOTHROW(build([](Points, Hexes, Quads) {}));
  CHECK(contains(message_of([&] { build([](Points, Hexes h, Quads) { h[0][1] = h[0][0]; }); }), "twice"));
  CHECK(contains(message_of([&] { build([](Points, Hexes h, Quads) { h[0][1] = 99; }); }), "99"));
  CHECK(contains(message_of([&] { build([](Points, Hexes h, Quads) { h.push_back(h[0]); }); }), "quad"));
  CHECK(contains(message_of([&] { build([](Points, Hexes, Quads q) { q.pop_back(); }); }), "no patch"));
  CHECK(contains(message_of([&] { build([](Points, Hexes, Quads q) { q[0].patch = 17; }); }), "17"));
  CHECK(contains(message_of([&] { build([](Points p, Hexes, Quads) { p[3].x() = std::nan(""); }); }),
                 "finite"));
  CHECK(contains(message_of([&] { build([](Points p, Hexes, Quads) { p.push_back(Vec3::Zero()); }); }),
                 "no block"));
  CHECK(contains(message_of([&] {
                   build([](Points, Hexes h, Quads) {
                     std::swap(h[1][0], h[1][4]);  // inside out
                     std::swap(h[1][1], h[1][5]);
                     std::swap(h[1][2], h[1][6]);
                     std::swap(h[1][3], h[1][7]);
                   });
                 }),
                 "inside out"));
}

TEST_CASE("hex complex: blocks that touch only along an edge or at a corner are refused") {
  const HexComplex c = sample::grid_complex({2, 2, 2});
  std::map<Index, std::vector<Index>> keep{{0, {0, 3}}, {1, {0, 7}}};
  for (const auto& [kind, blocks] : keep) {
    std::vector<HexPoints> hexes;
    std::map<Index, Index> number;
    std::vector<Vec3> points;
    for (const Index b : blocks) {
      HexPoints h = c.hexes[b];
      for (Index& v : h) {
        const auto [it, fresh] = number.emplace(v, static_cast<Index>(points.size()));
        if (fresh) points.push_back(c.points[v]);
        v = it->second;
      }
      hexes.push_back(h);
    }
    CHECK(contains(message_of([&] { sample::with_one_patch(points, hexes); }),
                   kind == 0 ? "only along it" : "touch at corner"));
  }
}
