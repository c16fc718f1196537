// Curved hexes: nodes, the Bezier bound of det J, orders.
#include <cmath>
#include <random>

#include "core/curve/curved_bound.hpp"
#include "core/curve/curved_mesh.hpp"
#include "core/curve/straighten.hpp"
#include "core/export/structured_blocks.hpp"
#include "core/target/analytic_surfaces.hpp"
#include "tests/catch.hpp"
#include "tests/export/sample_meshes.hpp"

using namespace flowcage;
using namespace flowcage::tests;

namespace {

/// Nodes of one cell by a map of the unit cube.
template <typename Map>
std::vector<Vec3> nodes_of(int order, const Map& map) {
  std::vector<Vec3> nodes;
  for (int k = 0; k <= order; ++k) {
    for (int j = 0; j <= order; ++j) {
      for (int i = 0; i <= order; ++i) nodes.push_back(map(Vec3(i, j, k) / order));
    }
  }
  return nodes;
}

/// det J at a place, by Lagrange's polynomials and their derivatives.
double jacobian_at(const std::vector<Vec3>& nodes, int order, const Vec3& x) {
  const auto basis = [order](int i, double t, bool derivative) {
    double value = derivative ? 0 : 1;
    const auto node = [order](int m) { return static_cast<double>(m) / order; };
    if (!derivative) {
      for (int m = 0; m <= order; ++m) value *= m == i ? 1 : (t - node(m)) / (node(i) - node(m));
      return value;
    }
    for (int l = 0; l <= order; ++l) {
      if (l == i) continue;
      double term = 1 / (node(i) - node(l));
      for (int m = 0; m <= order; ++m) term *= m == i || m == l ? 1 : (t - node(m)) / (node(i) - node(m));
      value += term;
    }
    return value;
  };
  std::array<Vec3, 3> column{Vec3::Zero(), Vec3::Zero(), Vec3::Zero()};
  for (int d = 0; d < 3; ++d) {
    std::size_t n = 0;
    for (int k = 0; k <= order; ++k) {
      for (int j = 0; j <= order; ++j) {
        for (int i = 0; i <= order; ++i, ++n) {
          column[d] += basis(i, x[0], d == 0) * basis(j, x[1], d == 1) * basis(k, x[2], d == 2) * nodes[n];
        }
      }
    }
  }
  return column[0].cross(column[1]).dot(column[2]);
}

double bernstein_value(const std::vector<double>& b, int n, const Vec3& x) {
  const auto basis = [n](int i, double t) {
    double value = 1;
    for (int m = 1; m <= i; ++m) value = value * (n - 1 - i + m) / m;
    return value * std::pow(t, i) * std::pow(1 - t, n - 1 - i);
  };
  double value = 0;
  for (int at = 0; at < n * n * n; ++at) {
    value += b[at] * basis(at % n, x[0]) * basis(at / n % n, x[1]) * basis(at / n / n, x[2]);
  }
  return value;
}

}  // namespace

TEST_CASE("the Bernstein coefficients are those of det J, and bound it") {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> move(-0.08, 0.08), place(0, 1);
  for (int order = 1; order <= 4; ++order) {
    CAPTURE(order);
    const auto nodes = nodes_of(order, [&](const Vec3& x) {
      return Vec3(x + 0.5 * Vec3(move(random), move(random), move(random)) / order);
    });
    const auto b = curved_jacobian_bernstein(nodes, order);
    REQUIRE(b.size() == static_cast<std::size_t>(27 * order * order * order));
    const auto [low, high] = std::minmax_element(b.begin(), b.end());
    for (int sample = 0; sample < 50; ++sample) {
      const Vec3 x(place(random), place(random), place(random));
      const double det = jacobian_at(nodes, order, x);
      CHECK(bernstein_value(b, 3 * order, x) == Approx(det).epsilon(1e-11));
      CHECK(det >= *low);
      CHECK(det <= *high);
    }
  }
}

TEST_CASE("signs: affine, bent, inverted inside although its corners are sound") {
  for (int order = 2; order <= 4; ++order) {
    CAPTURE(order);
    const auto affine =
        nodes_of(order, [](const Vec3& x) { return Vec3(2 * x.x() + x.y(), x.y(), 1e-6 * x.z()); });
    CHECK(curved_jacobian_sign(affine, order) == JacobianSign::positive);
    const auto b = curved_jacobian_bernstein(affine, order);
    CHECK(*std::min_element(b.begin(), b.end()) == Approx(2e-6).epsilon(1e-9));
    const auto bent =
        nodes_of(order, [](const Vec3& x) { return Vec3(x.x(), x.y(), x.z() + 0.4 * x.x() * (1 - x.x())); });
    CHECK(curved_jacobian_sign(bent, order) == JacobianSign::positive);
    // x(t) = t - a sin-like bump: the corners keep a slope of 1 - a' > 0, the middle turns back.
    const auto folded = nodes_of(order, [](const Vec3& x) {
      const double t = x.x();
      return Vec3(t + 6 * t * (1 - t) * (1 - 2 * t) * -1 * x.y() * (1 - x.y()) * 4, x.y(), x.z());
    });
    const bool turns = order >= 3;  // a cubic bump needs order 3
    CHECK((curved_jacobian_sign(folded, order) == JacobianSign::not_positive) == turns);
    const auto mirrored = nodes_of(order, [](const Vec3& x) { return Vec3(-x.x(), x.y(), x.z()); });
    CHECK(curved_jacobian_sign(mirrored, order) == JacobianSign::not_positive);
    auto no_number = affine;
    no_number[5].x() = std::nan("");
    CHECK(curved_jacobian_sign(no_number, order) == JacobianSign::not_positive);
  }
}

TEST_CASE("curved cells of a shell of spheres: nodes on the sphere, volume of the shell, all proved valid") {
  const HexMesh shell = sphere_shell(4, 3, 2);
  // The six sides as blocks of 4 x 4 x 3 cells: merged from the cells is not possible, so one block a cell.
  const BlockMesh blocks = blocks_of_cells(shell);
  const auto sphere = sphere_surface(Vec3::Zero(), 1);
  for (int order = 2; order <= 4; ++order) {
    CAPTURE(order);
    CurveReport report;
    Progress progress;
    const CurvedMesh curved = make_curved_mesh(blocks, *sphere, order, report, progress);
    CHECK(curved.cell_count() == shell.cell_count());
    CHECK(report.max_wall_distance < 1e-12);
    CHECK(report.max_correction > 1e-3);  // one cell a block: the interpolation alone is the facet
    const CurvedValidity validity = measure_curved_validity(curved);
    CHECK(validity.not_positive == 0);
    CHECK(validity.undecided == 0);
    CHECK(validity.min_ratio > 0.1);
    for (const Index n : curved.patch_quads(0)) {
      CHECK(curved.nodes.points()[n].norm() == Approx(1).epsilon(1e-12));
    }
    // The linear mesh's points stay, at the ends of the cells.
    std::vector<Index> nodes(static_cast<std::size_t>(curved.nodes_per_cell()));
    std::vector<HexPoints> cells(static_cast<std::size_t>(shell.cell_count()));
    shell.read_cells(0, cells);
    for (Offset c = 0; c < shell.cell_count(); ++c) {
      curved.read_cell(c, nodes);
      CHECK(curved.nodes.points()[nodes.front()] == shell.points()[cells[c][0]]);
      CHECK(curved.nodes.points()[nodes.back()] == shell.points()[cells[c][6]]);
    }
  }
}

TEST_CASE("nodes between lattice points: fourth order on smooth lattices, thin layers keep their order") {
  double last = 0;
  for (const Index n : {8, 16, 32}) {
    const auto map = [](const Vec3& x) {
      return Vec3((1 + x.z()) * std::cos(x.x()), (1 + x.z()) * std::sin(x.x()),
                  x.y() + 0.1 * std::sin(3 * x.x()));
    };
    const HexMesh box = box_mesh({1, 1, 1});
    const BlockMesh one = blocks_of_cells(box);
    std::vector<Index> divisions(one.chord_divisions().size(), n);
    BlockMesh smooth(
        one.shared_complex(), divisions,
        std::vector<Vec3>(static_cast<std::size_t>(BlockMesh::point_count(one.complex(), divisions))));
    for (Index k = 0; k <= n; ++k) {
      for (Index j = 0; j <= n; ++j) {
        for (Index i = 0; i <= n; ++i) {
          smooth.mutable_points()[smooth.point_number(0, i, j, k)] = map(Vec3(i, j, k) / n);
        }
      }
    }
    const CurvedMesh curved = interpolated_mesh(smooth, 2);
    double error = 0;
    const Index inner = 4;  // away from the ends, where slopes are one-sided
    for (Index i = inner; i <= 2 * n - inner; ++i) {
      const Vec3 x(static_cast<double>(i) / (2 * n), 0.5, 0.25);
      const Vec3 node = curved.nodes.points()[curved.nodes.point_number(0, i, n, n / 2)];
      error = std::max(error, (node - map(x)).norm());
    }
    if (last > 0) CHECK(last / error > 13);
    last = error;
  }
  // Layers that grow from 1e-6, and then a jump.
  const HexMesh box = box_mesh({1, 1, 1});
  const BlockMesh one = blocks_of_cells(box);
  std::vector<Index> divisions(one.chord_divisions().size(), 1);
  const Index chord = one.complex().edge_chord[one.complex().hex_edges[0][8]];
  divisions[chord] = 6;
  const std::array<double, 7> heights{0, 1e-6, 2e-6, 4e-6, 1e-5, 0.5, 1};
  BlockMesh layers(
      one.shared_complex(), divisions,
      std::vector<Vec3>(static_cast<std::size_t>(BlockMesh::point_count(one.complex(), divisions))));
  for (Index k = 0; k <= 6; ++k) {
    for (Index c = 0; c < 4; ++c) {
      layers.mutable_points()[layers.point_number(0, c % 2, c / 2, k)] = Vec3(c % 2, c / 2, heights[k]);
    }
  }
  const CurvedMesh curved = interpolated_mesh(layers, 4);
  for (Index k = 0; k < 24; ++k) {
    CHECK(curved.nodes.points()[curved.nodes.point_number(0, 0, 0, k)].z() <
          curved.nodes.points()[curved.nodes.point_number(0, 0, 0, k + 1)].z());
  }
  CHECK(measure_curved_validity(curved).not_positive == 0);
}

TEST_CASE("cells that are not valid are straightened, nodes that are the same in both stay") {
  const HexMesh box = box_mesh({3, 3, 3});
  for (int order = 2; order <= 4; ++order) {
    CAPTURE(order);
    CurvedMesh mesh = interpolated_mesh(blocks_of_cells(box), order);
    const std::vector<Vec3> straight(mesh.nodes.points().begin(), mesh.nodes.points().end());
    std::vector<Index> nodes(static_cast<std::size_t>(mesh.nodes_per_cell()));
    mesh.read_cell(13, nodes);  // the middle cell: folded by a node of its face to cell 12
    const Index folded = nodes[(order + 1) * (1 + (order + 1))];
    mesh.nodes.mutable_points()[folded].x() += 0.4;
    mesh.read_cell(0, nodes);  // far from it, bent but valid
    const Index bent = nodes[1];
    mesh.nodes.mutable_points()[bent].y() -= 0.02;
    const Vec3 place = mesh.nodes.points()[bent];
    REQUIRE(measure_curved_validity(mesh).not_positive > 0);
    CHECK(straighten_cells(mesh, straight) > 0);
    CHECK(measure_curved_validity(mesh).not_positive == 0);
    CHECK(measure_curved_validity(mesh).undecided == 0);
    CHECK(mesh.nodes.points()[bent] == place);
    CHECK(mesh.nodes.points()[folded].x() - straight[folded].x() < 0.21);
  }
}
