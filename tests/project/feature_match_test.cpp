#include "core/project/feature_match.hpp"
#include "core/project/side_normals.hpp"

#include <algorithm>

#include "core/project/limit_projection.hpp"
#include "core/subdivide/refine.hpp"
#include "core/target/analytic_surfaces.hpp"
#include "tests/catch.hpp"
#include "tests/refit/hand_drawn_cages.hpp"
#include "tests/refit/patch_target.hpp"

using namespace flowcage;
using namespace flowcage::test;

namespace {

struct Matched {
  SurfaceLevel level;
  std::vector<CreaseChain> chains;
  FeatureMatch match;
};

Matched matched(const Cage& cage, const TargetSurface& target) {
  Matched m;
  m.level = build_surface_level(cage);
  m.chains = crease_chains(m.level);
  m.match = match_features(m.level, cage.points, m.chains, target);
  return m;
}

/// A strip of quads over the sheet [0, nx] x [0, 1] in z = 0, vertex i + (nx + 1) j.
Cage strip_cage(Index nx) {
  Cage cage = empty_cage();
  for (Index j = 0; j < 2; ++j) {
    for (Index i = 0; i <= nx; ++i) cage.points.emplace_back(i, j, 0);
  }
  for (Index i = 0; i < nx; ++i) add_face(cage, {i, i + 1, nx + 2 + i, nx + 1 + i});
  return cage;
}

}  // namespace

TEST_CASE("chains end at corners and close where there is none", "[chains]") {
  const SurfaceLevel box = build_surface_level(box_cage(Vec3::Zero(), Vec3::Ones(), true));
  const auto edges = crease_chains(box);
  CHECK(edges.size() == 12);
  for (const CreaseChain& chain : edges) {
    CHECK_FALSE(chain.closed);
    CHECK(chain.segment_count() == 1);
  }
  const SurfaceLevel cylinder = build_surface_level(cylinder_cage(1, 1));
  const auto rims = crease_chains(cylinder);
  REQUIRE(rims.size() == 2);
  for (const CreaseChain& chain : rims) {
    CHECK(chain.closed);
    CHECK(chain.vertices.size() == 8);
    CHECK(chain.edges.size() == 8);
  }
  // One level down: vertices and edge points in turn, each edge joining its neighbours.
  const SurfaceLevel child = build_child_level(cylinder);
  const CreaseChain below = child_chain(rims[0], cylinder, child);
  REQUIRE(below.segment_count() == 16);
  for (Index i = 0; i < 16; ++i) {
    const auto ends = child.edge_vertices[below.edges[i]];
    CHECK(std::minmax(ends[0], ends[1]) == std::minmax(below.vertex(i), below.vertex(i + 1)));
    CHECK(child.edge_sharpness[below.edges[i]] >= infinitely_sharp);
  }
}

TEST_CASE("a box cage with noise finds each edge and corner", "[match]") {
  const Box3 box(Vec3(0, 0, 0), Vec3(1, 2, 3));
  const auto target = box_surface(box);
  for (const unsigned seed : {1U, 2U, 3U}) {
    const Cage cage = with_noise(box_cage(box.min(), box.max(), true), 0.1, seed);
    const Matched m = matched(cage, *target);
    CHECK(m.match.warnings.empty());
    CHECK(m.match.unmatched_chains.empty());
    for (Index v = 0; v < 8; ++v) CHECK(m.match.end_corner[v] == v);
    for (const ChainMatch& chain : m.match.chains) {
      REQUIRE(chain.matched);
      CHECK(chain.path.pieces.size() == 1);
    }
  }
}

TEST_CASE("two corners closer than the noise are told apart by their chain", "[match]") {
  // A blunt edge of 1e-3: the cage's two corners are drawn crosswise by the noise along x, not in z.
  const Box3 box(Vec3(0, 0, 0), Vec3(1, 2, 1e-3));
  const auto target = box_surface(box);
  Cage cage = box_cage(box.min(), box.max(), true);
  for (Index v = 0; v < 8; ++v) cage.points[v].x() += (v & 4) != 0 ? 0.03 : -0.02;
  for (Vec3& p : cage.points) p.z() *= 0.6;
  const Matched m = matched(cage, *target);
  for (Index v = 0; v < 8; ++v) CHECK(m.match.end_corner[v] == v);
  for (const ChainMatch& chain : m.match.chains) CHECK(chain.matched);
}

TEST_CASE("the faces beside a place tell which side of a thin body it is on", "[match]") {
  const auto target = box_surface(Box3(Vec3(0, 0, 0), Vec3(1, 1, 0.01)));
  const Csr<Vec3> normals =
      normals_at(*target, std::vector<Vec3>{Vec3(1, 1, 0.01), Vec3(0.5, 1, 0), Vec3(0.5, 0.5, 0.01)});
  CHECK(normals.row_size(0) == 3);
  CHECK(normals.row_size(1) == 2);
  REQUIRE(normals.row_size(2) == 1);
  CHECK((normals[2][0] - Vec3(0, 0, 1)).norm() < 1e-12);
  const std::vector<SideNormal> upper{{Vec3(0, 0, 1), 1}, {Vec3(0, 1, 0), 1}};
  CHECK(normal_mismatch(upper, normals[0]) == 0);
  // The lower edge has no face that looks up: 1 - cosine is 1 or more for half of the weight, less 0.3.
  CHECK(normal_mismatch(upper, normals[1]) == Approx(0.5 - 0.3).epsilon(1e-12));
}

TEST_CASE("rims are followed once round, evenly", "[match]") {
  const auto target = cylinder_surface({});
  const Matched m = matched(cylinder_cage(1, 1), *target);
  for (std::size_t c = 0; c < 2; ++c) {
    const ChainMatch& chain = m.match.chains[c];
    REQUIRE(chain.matched);
    CHECK(chain.path.closed);
    CHECK(chain.path.length() == Approx(2 * std::numbers::pi).epsilon(1e-12));
    for (std::size_t k = 0; k < 8; ++k) {
      CHECK(chain.s[k + 1] - chain.s[k] == Approx(std::numbers::pi / 4).epsilon(1e-6));
      const double middle = parameter_at(chain, static_cast<double>(k) + 0.5);
      CHECK(middle == Approx(0.5 * (chain.s[k] + chain.s[k + 1])).epsilon(1e-9));
      const Vec3 place = point_on_path(*target, chain.path, chain.s[k]).position;
      const Vec3 drawn = cylinder_cage(1, 1).points[m.chains[c].vertices[k]];
      CHECK((place - drawn).norm() < 1e-4);
    }
  }
}

TEST_CASE("a cage may follow a part of a chain, and one chain may go over several", "[match]") {
  // The sheet is 6 long; the strip covers x in [0, 4]: its long sides end in the middle of the sheet's.
  const auto target = sheet_surface(Vec3(0, 0, 0), Vec3(6, 0, 0), Vec3(0, 1, 0));
  const Matched m = matched(strip_cage(4), *target);
  Index matched_sides = 0;
  for (std::size_t c = 0; c < m.chains.size(); ++c) {
    const ChainMatch& chain = m.match.chains[c];
    if (!chain.matched) continue;
    const Vec3 first = point_on_path(*target, chain.path, 0).position;
    const Vec3 last = point_on_path(*target, chain.path, chain.path.length()).position;
    if (std::abs(chain.path.length() - 4) < 0.1) {
      ++matched_sides;
      CHECK(std::max(first.x(), last.x()) == Approx(4).margin(0.1));
    }
  }
  CHECK(matched_sides == 2);
  // The end of the strip at x = 4 follows nothing and is not snapped to the sheet's end at x = 6.
  CHECK(std::count_if(m.match.chains.begin(), m.match.chains.end(),
                      [](const ChainMatch& c) { return !c.matched; }) == 1);
  CHECK(m.match.warnings.size() == 1);

  // A ring of boundary vertices without a corner round the whole sheet: over four chains, corners pinned.
  Cage disc = empty_cage();
  const std::vector<Vec3> rim{{0, 0, 0}, {2, 0, 0}, {4, 0, 0}, {6, 0, 0},
                              {6, 1, 0}, {4, 1, 0}, {2, 1, 0}, {0, 1, 0}};
  disc.points = rim;
  disc.points.emplace_back(2, 0.5, 0);
  disc.points.emplace_back(4, 0.5, 0);
  add_face(disc, {0, 1, 8, 7});
  add_face(disc, {1, 2, 9, 8});
  add_face(disc, {2, 3, 4, 9});
  add_face(disc, {4, 5, 9});
  add_face(disc, {5, 6, 8, 9});
  add_face(disc, {6, 7, 8});
  const Matched ring = matched(disc, *target);
  const SurfaceLevel& level = ring.level;
  for (std::size_t c = 0; c < ring.chains.size(); ++c) CHECK(ring.match.chains[c].matched);
  (void)level;
  CHECK(ring.match.unmatched_chains.empty());
  for (std::size_t c = 0; c < ring.chains.size(); ++c) {
    const ChainMatch& chain = ring.match.chains[c];
    for (std::size_t k = 0; k < chain.s.size(); ++k) {
      const Index v = ring.chains[c].vertex(static_cast<Index>(k));
      CHECK((point_on_path(*target, chain.path, chain.s[k]).position - disc.points[v]).norm() < 0.05);
    }
  }
}

TEST_CASE("a crease far from every sharp edge stays unmatched", "[match]") {
  const auto target = cylinder_surface({});
  Cage cage = cylinder_cage(1, 1);
  cage.creases.clear();
  // A crease ring half way in on the top cap, far from the rim by a whole cell.
  for (Index i = 0; i < 8; ++i) add_crease(cage, 25 + i, 25 + (i + 1) % 8);
  const Matched m = matched(cage, *target);
  REQUIRE(m.chains.size() == 1);
  CHECK_FALSE(m.match.chains[0].matched);
  CHECK(m.match.unmatched_chains.size() == 2);
  CHECK(m.match.warnings.size() == 1);
}

TEST_CASE("places along a chain are monotone and smooth", "[match]") {
  ChainMatch match;
  match.path.offsets = {0, 10};
  match.w = match.s = {0, 1, 3, 6, 10};  // quadratic: second differences constant
  match.slope = {0.5, 1.5, 2.5, 3.5, 4.5};
  match.table_w = match.table_s = {0, 5, 10};
  match.table_density = {1, 1, 1};
  for (double t = 0; t <= 4; t += 0.125)
    CHECK(parameter_at(match, t) == Approx(t * (t + 1) / 2).margin(1e-12));
}

TEST_CASE("points gather where a path is curved, and return the vertices' places", "[match]") {
  // A chain along a sheet's straight side has even steps; round a NACA section they shrink at the nose.
  const WingCageShape wing;
  const auto target = wing_target(wing, TipShape::flat);
  const Cage cage = wing_cage(wing);
  const Matched m = matched(cage, *target);
  for (std::size_t c = 0; c < m.chains.size(); ++c) {
    const ChainMatch& chain = m.match.chains[c];
    REQUIRE(chain.matched);
    const Index n = m.chains[c].segment_count();
    for (Index k = 0; k <= n; ++k) CHECK(parameter_at(chain, k) == Approx(chain.s[k]).margin(1e-12));
    if (n < 6) continue;
    const double at_nose = parameter_at(chain, 3.05) - parameter_at(chain, 2.95);
    const double behind = parameter_at(chain, 4.05) - parameter_at(chain, 3.95);
    CHECK(at_nose < 0.4 * behind);
  }
}

TEST_CASE("on a thin body a limit point beyond the middle still goes to its own side", "[projection]") {
  const auto target = box_surface(Box3(Vec3(0, 0, 0), Vec3(1, 1, 0.02)));
  // Upper-side samples that sank below the middle: the nearest face is the lower one.
  const std::vector<Vec3> points{Vec3(0.5, 0.5, 0.005), Vec3(0.5, 0.5, -0.03), Vec3(0.5, 0.5, 0.3),
                                 Vec3(0.5, 0.5, 5)};
  const std::vector<Vec3> normals(4, Vec3(0.1, 0, 1).normalized());
  const std::vector<double> lengths(4, 0.25);
  const auto feet = project_limit_points(*target, {points, normals, lengths, {}});
  for (int i = 0; i < 3; ++i) {
    REQUIRE(feet[i].status != FootStatus::failed);
    CHECK(feet[i].position.z() == Approx(0.02).margin(1e-12));
    CHECK(feet[i].normal.z() == Approx(1));
  }
  // Along the normal, not perpendicular: x moves with z.
  CHECK(feet[2].position.x() == Approx(0.5 - 0.028).margin(1e-9));
  // Farther than the reach of 1.5 edge lengths: an absurd jump, refused.
  CHECK(feet[3].status == FootStatus::failed);
}
