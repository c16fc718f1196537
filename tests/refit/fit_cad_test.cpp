// The figures that the loop has to reach on CAD bodies built in code (issue: deviation after level 3).
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/cage/read_cage.hpp"
#include "core/project/feature_match.hpp"
#include "core/project/split_at_bends.hpp"
#include "core/refit/fit_surface.hpp"
#include "occ_bridge/cad_model.hpp"
#include "occ_bridge/shapes.hpp"
#include "tests/catch.hpp"
#include "tests/refit/fit_bodies.hpp"
#include "tests/refit/hand_drawn_cages.hpp"

using namespace flowcage;
using namespace flowcage::test;

namespace {

SurfaceFit fitted(const Cage& cage, const TargetSurface& target, int levels = 3) {
  Progress silent;
  FitSettings settings;
  settings.levels = levels;
  SurfaceFit fit = fit_surface(cage, target, settings, silent);
  for (const FittedLevel& level : fit.levels) {
    INFO("level " << level.report.level << ": max " << level.report.max_deviation << ", rms "
                  << level.report.rms_deviation << " at " << level.report.worst_place.transpose());
    CHECK(level.report.folds == 0);
  }
  return fit;
}

void check_root_plane(const SurfaceFit& fit) {
  for (const FittedLevel& level : fit.levels) {
    for (Index e = 0; e < level.topology.edge_count(); ++e) {
      if (!level.topology.is_boundary_edge(e)) continue;
      for (const Index v : level.topology.edge_vertices[e]) CHECK(level.control_points[v].y() == 0.0);
    }
  }
}

}  // namespace

TEST_CASE("the bodies of the fit's table reach their figures at levels 2 and 3", "[fit][cad]") {
  for (const std::string& name : fit_body_names()) {
    const FitBody body = make_fit_body(name);
    const SurfaceFit fit = fitted(body.cage, body.cad);
    INFO(name);
    CHECK(fit.unmatched_chains.empty());
    CHECK(fit.levels[2].report.max_deviation < body.asked[0]);
    CHECK(fit.max_deviation < body.asked[1]);
    CHECK(fit.coverage_deviation < 1.5 * fit.max_deviation);
    CHECK(fit.levels[3].report.crease_deviation <= fit.max_deviation * (1 + 1e-9));
    if (name.starts_with("wing_")) check_root_plane(fit);
  }
}

TEST_CASE("orders of convergence: regular regions, mirrored halves, creases", "[fit][cad]") {
  for (const char* name : {"torus", "half_torus", "cylinder"}) {
    const FitBody body = make_fit_body(name);
    const SurfaceFit fit = fitted(body.cage, body.cad);
    INFO(name);
    CHECK(fit.levels[2].report.max_deviation > 14 * fit.levels[3].report.max_deviation);
  }
  // The ends of a crease have no curvature (the natural end of a spline): a factor of 4.
  const FitBody wing = make_fit_body("wing_sharp");
  const SurfaceFit fit = fitted(wing.cage, wing.cad, 4);
  CHECK(fit.levels[3].report.crease_deviation > 3.5 * fit.levels[4].report.crease_deviation);
  CHECK(fit.max_deviation < wing.asked[2]);
}

TEST_CASE("without the mirror image a half body loses an order at its symmetry plane", "[fit][cad]") {
  const FitBody body = make_fit_body("half_torus");
  FitSettings plain;
  plain.mirror = false;
  Progress silent;
  const SurfaceFit without = fit_surface(body.cage, body.cad, plain, silent);
  const SurfaceFit with = fitted(body.cage, body.cad);
  CHECK(without.max_deviation > 30 * with.max_deviation);
  check_root_plane(with);
}

TEST_CASE("rough cages: noise of 1 % and 3 % of the diagonal on every vertex", "[fit][cad]") {
  for (const char* name : {"sphere", "torus", "wing_sharp", "wing_blunt", "wing_thin_base", "rounded_box"}) {
    const FitBody body = make_fit_body(name);
    const double plain = fitted(body.cage, body.cad, 2).max_deviation;
    for (const double noise : {0.01, 0.03}) {
      for (const unsigned seed : {1U, 8U, 14U}) {
        INFO(name << ", noise " << noise << ", seed " << seed);
        const SurfaceFit fit = fitted(with_noise(body.cage, noise * body.cad.diagonal(), seed), body.cad, 2);
        CHECK(fit.unmatched_chains.empty());
        CHECK(fit.max_deviation < 3 * plain);
      }
    }
  }
}

TEST_CASE("a crease's vertex next to a section's nose is laid on it, however rough the cage", "[fit][cad]") {
  const FitBody body = make_fit_body("wing_sharp");
  for (const unsigned seed : {0U, 1U, 2U, 3U}) {
    const Cage cage = with_noise(body.cage, seed == 0 ? 0 : 0.02 * body.cad.diagonal(), seed);
    const SurfaceLevel level = build_surface_level(cage);
    const std::vector<CreaseChain> chains = crease_chains(level);
    const FeatureMatch match = match_features(level, cage.points, chains, body.cad);
    int sections = 0;
    for (std::size_t c = 0; c < chains.size(); ++c) {
      if (chains[c].segment_count() < 6) continue;  // the trailing edge
      const ChainMatch& chain = match.chains[c];
      ++sections;
      INFO("seed " << seed);
      REQUIRE(chain.pinned.size() == 1);
      const Vec3 nose = point_on_path(body.cad, chain.path, chain.pinned[0]).position;
      CHECK(std::abs(nose.z()) < 1e-4);
      CHECK(std::abs(nose.x() - nose.y() * std::tan(25 * std::numbers::pi / 180)) < 1e-4);
    }
    CHECK(sections == 2);
  }
}

TEST_CASE("cages so rough that upper and lower side or the nose's vertex are mistaken at first",
          "[fit][cad]") {
  const FitBody body = make_fit_body("wing_fuselage");
  const double plain = fitted(body.cage, body.cad, 2).max_deviation;
  // Seeds of each kind: a tip's rim without a way round, a rim matched the other way round, the nose given to
  // the vertex beside, a tip cap's inner vertices outside of its rim.
  for (const unsigned seed : {8U, 21U, 6U, 32U, 16U}) {
    INFO("seed " << seed);
    const SurfaceFit fit = fitted(with_noise(body.cage, 0.03 * body.cad.diagonal(), seed), body.cad, 2);
    CHECK(fit.unmatched_chains.empty());
    CHECK(fit.max_deviation < 3 * plain);
  }
}

TEST_CASE("a blunt trailing edge of 0.1 % of the chord into a rounded tip: no fold, smooth or rough cage",
          "[fit][cad]") {
  // The rim of the base's half disc (radius 1.2e-4 of the diagonal) is far below a cell's size: a crease
  // of one cage edge follows it, whose ends are made corners.
  const FitBody body = make_fit_body("wing_round_tip_blunt");
  const SurfaceFit fit = fitted(body.cage, body.cad, 5);
  CHECK(fit.unmatched_chains.empty());
  CHECK(fit.max_deviation < 1e-4);
  CHECK(fit.rms_deviation < 1e-6);
  REQUIRE(fit.warnings.size() == 1);
  CHECK(fit.warnings[0].find("turns back") != std::string::npos);
  check_root_plane(fit);
  const double plain = fit.levels[2].report.max_deviation;
  for (const unsigned seed : {1U, 5U, 6U, 13U}) {
    INFO("seed " << seed);
    const SurfaceFit rough = fitted(with_noise(body.cage, 0.01 * body.cad.diagonal(), seed), body.cad, 2);
    CHECK(rough.max_deviation < 3 * plain);
  }
}

TEST_CASE("a crease is cut where its CAD edge turns back: three curves, end to end", "[fit][cad]") {
  const FitBody body = make_fit_body("wing_round_tip_blunt");
  SurfaceLevel level = build_surface_level(body.cage);
  const std::vector<CreaseChain> drawn = crease_chains(level);
  const FeatureMatch match = match_features(level, body.cage.points, drawn, body.cad);
  const SplitCreases split = split_at_bends(std::move(level), body.cage.points, drawn, match, body.cad);
  REQUIRE(split.chains.size() == drawn.size() + 2);
  double length = 0, drawn_length = 0;
  for (const ChainMatch& chain : match.chains) drawn_length += chain.path.length();
  for (std::size_t c = 0; c < split.chains.size(); ++c) {
    const ChainMatch& chain = split.match.chains[c];
    REQUIRE(chain.matched);
    length += chain.path.length();
    CHECK(chain.s.front() == 0);
    CHECK(std::abs(chain.s.back() - chain.path.length()) < 1e-12);
    for (const bool last : {false, true}) {
      const Index v = last ? split.chains[c].vertices.back() : split.chains[c].vertices.front();
      if (!split.match.end_is_fixed[v] || split.chains[c].closed) continue;
      const Vec3 at = point_on_path(body.cad, chain.path, last ? chain.s.back() : 0).position;
      CHECK((at - split.match.end_position[v]).norm() < 1e-9);
    }
  }
  CHECK(std::abs(length - drawn_length) < 1e-9);
  const std::vector<Index> corners = vertices_at_bends(body.cage, body.cad);
  REQUIRE(corners.size() == 2);
  for (const Index v : corners) {  // a quarter of the half circle's turn from its ends
    const Vec3& at = split.match.end_position[v];
    CHECK(std::abs(std::abs(at.z()) - 3e-4 / std::sqrt(2)) < 2e-5);
    CHECK(at.y() > 2);
  }
}

TEST_CASE("ONERA M6 half wing: sharp trailing edge into a rounded tip", "[fit][cad]") {
  Progress silent;
  const CadModel model = cad_model_of(make_onera_m6(), {}, silent);
  const Cage cage = scale_cage(read_cage(FLOWCAGE_SOURCE_DIR "/examples/02_onera_m6/cage.obj"), 1e-3);
  const SurfaceFit fit = fitted(cage, model);
  CHECK(fit.unmatched_chains.empty());
  CHECK(fit.max_deviation < 1e-3);
  CHECK(fit.rms_deviation < 2e-5);
  CHECK(fit.coverage_deviation < 1.5 * fit.max_deviation);
  check_root_plane(fit);
  // What limits it is the apex at the trailing edge's end.
  CHECK((fit.worst_place - Vec3(1.1436, 1.1963, 0)).norm() < 0.05);
}
