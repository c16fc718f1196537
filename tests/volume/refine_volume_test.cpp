#include "core/volume/refine_volume.hpp"

#include <map>
#include <random>
#include <set>

#include "core/base/parallel.hpp"
#include "core/mesh/hex_numbering.hpp"
#include "core/volume/volume_masks.hpp"
#include "tests/blocks/sample_complexes.hpp"
#include "tests/catch.hpp"

using namespace flowcage;

namespace {

using Key = std::vector<Index>;  // sorted points of an edge, face or cell

Key key_of(std::initializer_list<Index> points) {
  Key k(points);
  std::sort(k.begin(), k.end());
  return k;
}

/// The published rules written down once more, for explicit cells: new points by the vertex, edge, face or
/// cell they belong to. `patch_of_quad` tells which boundary edges are creases.
std::map<Key, Vec3> refine_explicitly(const BlockMesh& mesh) {
  std::vector<HexPoints> cells(mesh.cell_count());
  mesh.read_cells(0, cells);
  const auto p = mesh.points();
  const auto mean = [&](const Key& k) {
    Vec3 s = Vec3::Zero();
    for (const Index v : k) s += p[v];
    return Vec3(s / static_cast<double>(k.size()));
  };
  std::set<Key> faces;
  std::set<Key> edges;
  std::map<Key, std::vector<Key>> cells_at_face;
  std::map<Key, std::set<Key>> cells_at_edge;
  std::map<Key, std::set<Key>> faces_at_edge;
  std::map<Index, std::vector<HexPoints>> cells_at_vertex;
  std::map<Key, Vec3> result;
  for (const HexPoints& h : cells) {
    Key cell(h.begin(), h.end());
    std::sort(cell.begin(), cell.end());
    result[cell] = mean(cell);
    for (const auto& f : hex_faces) {
      const Key face = key_of({h[f[0]], h[f[1]], h[f[2]], h[f[3]]});
      faces.insert(face);
      cells_at_face[face].push_back(cell);
      for (int n = 0; n < 4; ++n) {
        const Key edge = key_of({h[f[n]], h[f[(n + 1) % 4]]});
        edges.insert(edge);
        cells_at_edge[edge].insert(cell);
        faces_at_edge[edge].insert(face);
      }
    }
    for (const Index v : h) cells_at_vertex[v].push_back(h);
  }
  std::map<Key, std::vector<std::pair<Key, int>>> boundary_at_edge;  // boundary faces and their patches
  std::map<Index, std::vector<Key>> boundary_at_vertex;
  std::map<Index, std::set<Key>> boundary_edges_at_vertex;
  for (std::size_t n = 0; n < mesh.patches().size(); ++n) {
    for (const auto& q : mesh.patches()[n].quads) {
      const Key face = key_of({q[0], q[1], q[2], q[3]});
      for (int c = 0; c < 4; ++c) {
        const Key edge = key_of({q[c], q[(c + 1) % 4]});
        boundary_at_edge[edge].push_back({face, static_cast<int>(n)});
        boundary_at_vertex[q[c]].push_back(face);
        boundary_edges_at_vertex[q[c]].insert(edge);
        boundary_edges_at_vertex[q[(c + 1) % 4]].insert(edge);
      }
    }
  }
  const auto is_crease = [&](const Key& e) {
    return boundary_at_edge[e][0].second != boundary_at_edge[e][1].second;
  };
  for (const Key& f : faces) {
    const auto& two = cells_at_face[f];
    result[f] = two.size() == 1 ? mean(f) : Vec3((mean(two[0]) + 2 * mean(f) + mean(two[1])) / 4);
  }
  for (const Key& e : edges) {
    if (boundary_at_edge.count(e) != 0) {
      const auto& two = boundary_at_edge[e];
      result[e] = is_crease(e) ? mean(e) : Vec3((2 * mean(e) + mean(two[0].first) + mean(two[1].first)) / 4);
      continue;
    }
    Vec3 c = Vec3::Zero();
    Vec3 f = Vec3::Zero();
    for (const Key& cell : cells_at_edge[e]) c += mean(cell);
    for (const Key& face : faces_at_edge[e]) f += mean(face);
    const auto n = static_cast<double>(faces_at_edge[e].size());
    REQUIRE(cells_at_edge[e].size() == faces_at_edge[e].size());
    result[e] = (c / n + 2 * f / n + (n - 3) * mean(e)) / n;
  }
  for (const auto& [v, hexes] : cells_at_vertex) {
    if (boundary_at_vertex.count(v) == 0) {
      // Bajaj et al.: sum over the ring of 3^(d - dim) val / (4^d val) U, as the mean of quarter points.
      Vec3 s = Vec3::Zero();
      for (const HexPoints& h : hexes) {
        const auto& at = hex_corner_ijk[std::find(h.begin(), h.end(), v) - h.begin()];
        for (int c = 0; c < 8; ++c) {
          double w = 1.0 / 64;
          for (int axis = 0; axis < 3; ++axis) w *= hex_corner_ijk[c][axis] == at[axis] ? 3 : 1;
          s += w * p[h[c]];
        }
      }
      result[{v}] = s / static_cast<double>(hexes.size());
      continue;
    }
    std::vector<Index> crease_ends;
    Vec3 f = Vec3::Zero();
    Vec3 e = Vec3::Zero();
    for (const Key& face : boundary_at_vertex[v]) f += mean(face);
    for (const Key& edge : boundary_edges_at_vertex[v]) {
      e += mean(edge);
      if (is_crease(edge)) crease_ends.push_back(edge[0] == v ? edge[1] : edge[0]);
    }
    const auto n = static_cast<double>(boundary_at_vertex[v].size());
    if (crease_ends.size() > 2) {
      result[{v}] = p[v];
    } else if (crease_ends.size() == 2) {
      result[{v}] = (6 * p[v] + p[crease_ends[0]] + p[crease_ends[1]]) / 8;
    } else {
      result[{v}] = (f / n + 2 * e / n + (n - 3) * p[v]) / n;
    }
  }
  return result;
}

/// The largest distance between the refined mesh and the explicit rules.
double difference(const BlockMesh& parent, const BlockMesh& child) {
  const auto expected = refine_explicitly(parent);
  double worst = 0;
  std::set<Index> seen;
  for (Index b = 0; b < parent.block_count(); ++b) {
    const auto n = child.dims(b);
    for (Index k = 0; k <= n[2]; ++k) {
      for (Index j = 0; j <= n[1]; ++j) {
        for (Index i = 0; i <= n[0]; ++i) {
          std::set<Index> entity;  // the parent's points whose mean lies at (i,j,k)/2
          for (int c = 0; c < 8; ++c) {
            const auto& s = hex_corner_ijk[c];
            entity.insert(parent.point_number(b, (i + s[0] * (i % 2)) / 2, (j + s[1] * (j % 2)) / 2,
                                              (k + s[2] * (k % 2)) / 2));
          }
          const Index number = child.point_number(b, i, j, k);
          seen.insert(number);
          const Vec3& want = expected.at(Key(entity.begin(), entity.end()));
          worst = std::max(worst, (child.points()[number] - want).norm());
        }
      }
    }
  }
  CHECK(seen.size() == child.points().size());
  return worst;
}

BlockMesh random_mesh(const HexComplex& complex, std::mt19937& random, Index max_divisions) {
  std::vector<Index> divisions(complex.chord_count);
  for (Index& d : divisions) d = 1 + static_cast<Index>(random() % max_divisions);
  std::vector<Vec3> points(BlockMesh::point_count(complex, divisions));
  std::uniform_real_distribution<double> coordinate(-1, 1);
  for (Vec3& p : points) p = {coordinate(random), coordinate(random), coordinate(random)};
  return {std::make_shared<const HexComplex>(complex), divisions, points};
}

}  // namespace

TEST_CASE("cell masks are the published rules on a regular grid") {
  // A vertex of 8 cells: (1 6 1)/8 cubed.
  const auto vertex = cell_mask({0, 0, 0}, 4);
  CHECK(vertex[0] == 27.0 / 64);
  CHECK(vertex[6] == 1.0 / 64);
  for (int a = 0; a < 3; ++a) {
    for (int b = 0; b < 3; ++b) {
      for (int c = 0; c < 3; ++c) {
        for (const Index n : {3, 4, 5, 8}) {
          double sum = 0;
          for (const double w : cell_mask({a, b, c}, n)) sum += w;
          CHECK(sum == Approx(1).margin(1e-15));
        }
      }
    }
  }
}

TEST_CASE("refinement agrees with the rules written out on explicit cells") {
  std::mt19937 random(3);
  for (int trial = 0; trial < 30; ++trial) {
    const BlockMesh mesh = random_mesh(sample::random_complex(random), random, 3);
    const BlockMesh child = refine_volume(mesh);
    CHECK(child.cell_count() == 8 * mesh.cell_count());
    CHECK(difference(mesh, child) < 4e-15);
    if (trial < 5) CHECK(difference(child, refine_volume(child)) < 4e-15);
  }
  const BlockMesh grid =
      random_mesh(sample::grid_complex({2, 2, 2}), random, 3);  // creases between its sides
  CHECK(difference(grid, refine_volume(grid)) < 4e-15);
}

TEST_CASE("a block with sharp edges stays the block: equal cells, volume and sides kept") {
  BlockMesh mesh(std::make_shared<const HexComplex>(sample::grid_complex({1, 1, 1})));
  for (int level = 0; level < 4; ++level) mesh = refine_volume(mesh);
  REQUIRE(mesh.cell_count() == 4096);
  for (Index k = 0; k <= 16; ++k) {
    for (Index j = 0; j <= 16; ++j) {
      for (Index i = 0; i <= 16; ++i) {
        const Vec3& p = mesh.points()[mesh.point_number(0, i, j, k)];
        for (const auto& [x, n] : {std::pair{p.x(), i}, {p.y(), j}, {p.z(), k}}) {
          if (n == 0 || n == 16) REQUIRE(x == n / 16);  // flat to the last bit
          REQUIRE(x > -1e-15);
          REQUIRE(x < 1 + 1e-15);
        }
      }
    }
  }
}

TEST_CASE("refinement commutes with affine maps") {
  std::mt19937 random(5);
  for (int trial = 0; trial < 10; ++trial) {
    const BlockMesh mesh = random_mesh(sample::random_complex(random), random, 2);
    Eigen::Matrix3d a;
    a << 1, 0.3, -0.2, 0.1, 0.8, 0.25, -0.4, 0.2, 1.1;
    const Vec3 shift(0.5, -0.25, 0.75);
    BlockMesh moved = mesh;
    for (Vec3& p : moved.mutable_points()) p = a * p + shift;
    BlockMesh first = refine_volume(refine_volume(mesh));
    const BlockMesh second = refine_volume(refine_volume(moved));
    double worst = 0;
    for (std::size_t n = 0; n < first.points().size(); ++n) {
      worst = std::max(worst, (a * first.points()[n] + shift - second.points()[n]).norm());
    }
    CHECK(worst < 4e-15);
  }
}

TEST_CASE("a boundary in a plane of constant coordinate stays in it to the last bit") {
  std::mt19937 random(11);
  for (const double value : {0.0, 0.1, -1.0 / 3, 1234.5678e-3}) {
    BlockMesh mesh = random_mesh(sample::grid_complex({2, 3, 2}), random, 2);
    for (const auto& q : mesh.patches()[2].quads) {
      for (const Index v : q) mesh.mutable_points()[v].y() = value;
    }
    for (int level = 0; level < 3; ++level) {
      mesh = refine_volume(mesh);
      for (const auto& q : mesh.patches()[2].quads) {
        for (const Index v : q) REQUIRE(mesh.points()[v].y() == value);
      }
    }
  }
}

TEST_CASE("refinement gives the same bits on any number of threads") {
  std::mt19937 random(17);
  const BlockMesh mesh = random_mesh(sample::grid_complex({3, 2, 2}), random, 4);
  set_thread_count(1);
  const BlockMesh one = refine_volume(refine_volume(mesh));
  set_thread_count(4);
  const BlockMesh four = refine_volume(refine_volume(mesh));
  set_thread_count(0);
  CHECK(std::equal(one.points().begin(), one.points().end(), four.points().begin()));
}

TEST_CASE("semi-sharp edges decay by one a level") {
  HexComplex complex = sample::grid_complex({1, 1, 1});
  for (double& s : complex.edge_sharpness) s = 1.5;
  const BlockMesh mesh(std::make_shared<const HexComplex>(complex));
  const BlockMesh once = refine_volume(mesh);
  CHECK(once.complex().edge_sharpness[0] == 0.5);
  CHECK(once.points()[0] == mesh.points()[0]);  // three edges sharper than 1: a corner in this step
  const BlockMesh twice = refine_volume(once);
  CHECK(twice.complex().edge_sharpness[0] == 0);
  CHECK(twice.points()[0] != mesh.points()[0]);
}
