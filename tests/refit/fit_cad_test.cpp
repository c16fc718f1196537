// The figures that the loop has to reach on CAD bodies built in code (issue: deviation after level 3).
#include <fmt/format.h>

#include <algorithm>

#include "core/cage/read_cage.hpp"
#include "core/refit/fit_surface.hpp"
#include "occ_bridge/cad_model.hpp"
#include "occ_bridge/shapes.hpp"
#include "tests/catch.hpp"
#include "tests/refit/hand_drawn_cages.hpp"

using namespace flowcage;
using namespace flowcage::test;

namespace {

CadModel wing_model(const WingCageShape& cage) {
  HalfWing wing;
  wing.airfoil = naca_symmetric(cage.thickness, cage.half_base);
  wing.root_chord = cage.root_chord;
  wing.tip_chord = cage.tip_chord;
  wing.semi_span = cage.semi_span;
  wing.leading_edge_sweep_degrees = cage.sweep_degrees;
  Progress silent;
  return cad_model_of(make_half_wing(wing), {}, silent);
}

SurfaceFit fitted(const Cage& cage, const TargetSurface& target) {
  Progress silent;
  SurfaceFit fit = fit_surface(cage, target, {}, silent);
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

TEST_CASE("swept NACA 0012 half wing, flat tip, sharp and blunt trailing edge", "[fit][cad]") {
  for (const double half_base : {0.0, 0.0005, 0.0025}) {
    WingCageShape wing;
    wing.half_base = half_base;
    const CadModel model = wing_model(wing);
    const SurfaceFit fit = fitted(wing_cage(wing), model);
    INFO("base " << 2 * half_base << " of the chord");
    CHECK(fit.unmatched_chains.empty());
    CHECK(fit.max_deviation < 5e-5);
    CHECK(fit.coverage_deviation < 1.5 * fit.max_deviation);
    check_root_plane(fit);
  }
}

TEST_CASE("a wing's cage may be drawn 3 % of the chord beside the wing", "[fit][cad]") {
  const WingCageShape wing;
  const CadModel model = wing_model(wing);
  for (const unsigned seed : {1U, 2U}) {
    const SurfaceFit fit = fitted(with_noise(wing_cage(wing), 0.03, seed), model);
    CHECK(fit.unmatched_chains.empty());
    CHECK(fit.max_deviation < 5e-5);
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
