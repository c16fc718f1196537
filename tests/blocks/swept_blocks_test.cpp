// The swept-body route on wings in closed form: what is found, the topology, the mesh; and what it refuses.
#include <algorithm>
#include <cmath>
#include <set>

#include "core/base/error.hpp"
#include "core/blocks/swept_base.hpp"
#include "core/quality/quality_report.hpp"
#include "core/subdivide/refine.hpp"
#include "core/volume/start_swept.hpp"
#include "core/volume/wall_columns.hpp"
#include "occ_bridge/shapes.hpp"
#include "tests/blocks/swept_bodies.hpp"
#include "tests/catch.hpp"

using namespace flowcage;
using namespace flowcage::test;

namespace {

CadModel model_of(const Shape& shape) {
  Progress silent;
  return cad_model_of(shape, {}, silent);
}

/// The planform of HalfWing's defaults: chord 1 to 0.6 over a span of 2, leading edge swept by 25 degrees.
double chord_at(double s) {
  return 1 - 0.2 * s;
}

}  // namespace

TEST_CASE("a section of a wing has its chord, thickness and trailing edge") {
  const CadModel sharp = make_swept_body("wing_sharp");
  const CadModel blunt = make_swept_body("wing_blunt");
  const SweptAxes axes;
  for (const double s : {0.1, 0.9, 1.7}) {
    const AirfoilSection a = airfoil_section(sharp, axes, s).value();
    CHECK(a.kind == TrailingEdge::sharp);
    CHECK(a.leading.x() == Approx(s * std::tan(25 * M_PI / 180)).margin(1e-3).epsilon(0));
    CHECK(a.chord() == Approx(chord_at(s)).margin(1e-3).epsilon(0));
    CHECK(a.thickness() == Approx(0.12 * chord_at(s)).margin(3e-3).epsilon(0));
    const AirfoilSection b = airfoil_section(blunt, axes, s).value();
    CHECK(b.kind == TrailingEdge::blunt);
    CHECK((b.base_upper - b.base_lower).norm() == Approx(0.005 * chord_at(s)).margin(1e-6).epsilon(0));
  }
  CHECK_FALSE(airfoil_section(sharp, axes, 2.1).has_value());
}

TEST_CASE("span, chord and ends of a wing are found") {
  struct Row {
    const char* body;
    SweptEnd first, last;
    TrailingEdge trailing;
    double tip;  // ring at the far end
  };
  const std::vector<Row> rows{{"wing_sharp", SweptEnd::open, SweptEnd::flat, TrailingEdge::sharp, 2},
                              {"wing_blunt", SweptEnd::open, SweptEnd::flat, TrailingEdge::blunt, 2},
                              {"wing_rounded", SweptEnd::open, SweptEnd::rounded, TrailingEdge::sharp, 2},
                              {"onera_m6", SweptEnd::open, SweptEnd::rounded, TrailingEdge::sharp, 1.1963},
                              {"wing_closed_sharp", SweptEnd::flat, SweptEnd::flat, TrailingEdge::sharp, 2}};
  for (const Row& row : rows) {
    INFO(row.body);
    const SweptBody body = find_swept_body(make_swept_body(row.body), row.body);
    CHECK((body.axes.span - Vec3::UnitY()).norm() < 1e-12);
    CHECK((body.axes.chord - Vec3::UnitX()).norm() < 1e-6);
    CHECK(body.ends[0] == row.first);
    CHECK(body.ends[1] == row.last);
    CHECK(body.trailing == row.trailing);
    CHECK(body.sections.front().s == Approx(0).margin(1e-9).epsilon(0));
    CHECK(body.sections.back().s == Approx(row.tip).margin(1e-4).epsilon(0));
    CHECK(body.warnings.empty());
  }
}

TEST_CASE("blocks of a wing: topology, box, seats") {
  for (const char* name : {"wing_sharp", "wing_blunt", "wing_closed_sharp", "wing_closed_blunt"}) {
    INFO(name);
    const bool open = std::string(name).find("closed") == std::string::npos;
    const SweptBlocks swept = make_swept_blocks(make_swept_body(name), {}, name);
    const HexComplex& complex = *swept.blocks.complex;

    // The wall's cage: a sphere, or one with a hole.
    const SurfaceLevel coarse = build_surface_level(swept.cage);
    CHECK(topology_of(coarse).euler == (open ? 1 : 2));
    CHECK(topology_of(coarse).boundary_loops == (open ? 1 : 0));

    // Euler number of the hexes: a ball less what touches its boundary, or a shell between two spheres.
    const auto euler = static_cast<long>(complex.points.size()) - static_cast<long>(complex.edges.size()) +
                       static_cast<long>(complex.quads.size()) - static_cast<long>(complex.hexes.size());
    CHECK(euler == (open ? 1 : 2));

    // A block each face of the wall, and all of the wall at the cage's level 1.
    CHECK(swept.blocks.seats.size() == static_cast<std::size_t>(build_child_level(coarse).face_count()));
    // Cut at the trailing edge and the rims: more lines than vertices.
    CHECK(swept.cage_vertex.size() > static_cast<std::size_t>(build_child_level(coarse).vertex_count()));

    // The far field lies on the sides of a box; the symmetry plane at y = 0 to the bit.
    Box3 box;
    for (const Vec3& p : complex.points) box.extend(p);
    for (std::size_t q = 0; q < complex.quads.size(); ++q) {
      if (complex.quad_patch[q] < 1) continue;
      const bool symmetry = complex.patches[complex.quad_patch[q]].type == PatchType::symmetry;
      int sides = 0;
      for (int a = 0; a < 3; ++a) {
        for (const double side : {box.min()[a], box.max()[a]}) {
          const auto& c = complex.quads[q];
          sides +=
              std::all_of(c.begin(), c.end(), [&](Index v) { return complex.points[v][a] == side; }) ? 1 : 0;
        }
      }
      CHECK(sides == 1);
      if (symmetry) CHECK(complex.points[complex.quads[q][0]].y() == 0);
    }
    CHECK(swept.blocks.symmetry.has_value() == open);

    // Four blocks meet at an inboard trailing edge: the two C and the two wake blocks; a base has more.
    if (swept.plan.trailing != TrailingEdge::sharp) continue;
    const auto at = std::find_if(swept.corners.begin(), swept.corners.end(), [&](const SweptCorner& c) {
      return c.vertex == 0 && c.level == (open ? 0 : 1) + 2;
    });
    const auto corner = static_cast<Index>(at - swept.corners.begin());
    const auto blocks = std::count_if(complex.hexes.begin(), complex.hexes.end(), [&](const HexPoints& h) {
      return std::find(h.begin(), h.end(), corner) != h.end();
    });
    CHECK(blocks == 8);  // on both sides of the section
  }
}

TEST_CASE("the mesh of a wing is valid, fits and is near its topology's bound") {
  Progress silent;
  for (const char* name : {"wing_sharp", "wing_blunt"}) {
    INFO(name);
    const VolumeResult r = mesh_swept_body(make_swept_body(name), name, 2, {}, silent);
    const QualityReport& q = r.quality;
    CHECK(r.fit.max_deviation < 5e-5);
    CHECK(r.fit.unmatched_chains.empty());
    CHECK(r.validity.inverted == 0);
    CHECK(r.validity.uncertified == 0);
    CHECK(q.scaled_jacobian.min > 0.25);
    CHECK(q.scaled_jacobian.mean > 0.955);
    CHECK(check_mesh_failures(q).empty());
  }
}

TEST_CASE(
    "layers of a wing end in the wake and past the tip: no face is warped by more than they are thick") {
  Progress silent;
  LayerSettings layers;
  layers.first_height = 1e-5 * 2;
  const VolumeResult r = mesh_swept_body(make_swept_body("wing_sharp"), "wing_sharp", 2, layers, silent);
  CHECK(r.validity.inverted == 0);
  CHECK(r.validity.uncertified == 0);
  CHECK(r.quality.wrong_pyramids == 0);
  CHECK(r.quality.non_orthogonality_errors == 0);
  CHECK(r.quality.skew_faces == 0);
  // The least stands at the far field's edge outboard of the tip, whatever the layers' reach (.187).
  CHECK(r.quality.scaled_jacobian.min > 0.18);
  CHECK(r.quality.scaled_jacobian.mean > 0.9);
}

TEST_CASE("each vertex of the cut wall has a column of its own") {
  for (const char* name : {"wing_sharp", "wing_blunt"}) {
    INFO(name);
    const SweptBlocks swept = make_swept_blocks(make_swept_body(name), {}, name);
    const std::vector<SurfaceLevel> levels = build_levels(swept.cage, 1);
    const BlockMesh mesh = start_swept_volume(swept, refine_points(levels, swept.cage.points), 2);
    const WallColumns columns = wall_columns(mesh, swept.blocks);
    CHECK(columns.lines.size() == static_cast<std::size_t>(swept.blocks.wall.vertex_count()));
  }
}

TEST_CASE("lines across a base are straight") {
  const SweptBlocks swept = make_swept_blocks(make_swept_body("wing_blunt"), {}, "wing_blunt");
  const std::vector<SurfaceLevel> levels = build_levels(swept.cage, 2);
  const SurfaceLevel cut = build_child_level(swept.blocks.wall);
  std::vector<Vec3> points = refine_points(levels, swept.cage.points);
  const std::vector<Vec3> straight = points;
  // Drift along the span, as a fit leaves it: edges stay, everything else moves.
  std::set<Index> sharp;
  for (Index e = 0; e < levels.back().edge_count(); ++e) {
    if (levels.back().edge_sharpness[e] == 0) continue;
    for (const Index v : levels.back().edge_vertices[e]) sharp.insert(v);
  }
  Index inner = 0;
  for (Index v = 0; v < levels.back().vertex_count(); ++v) {
    const double rear = points[v].y() * std::tan(25 * M_PI / 180) + chord_at(points[v].y());
    const bool on_base = std::abs(points[v].x() - rear) < 1e-4 && sharp.count(v) == 0;
    if (!on_base) continue;
    ++inner;
    points[v].y() += 0.05;
  }
  REQUIRE(inner > 20);
  straighten_base(swept, cut, levels.back(), points);
  double worst = 0;
  for (std::size_t v = 0; v < points.size(); ++v) {
    // The cage's own base is smooth across: its rows are straight up to the smoothing along the span.
    worst = std::max(worst, (points[v] - straight[v]).norm());
  }
  CHECK(worst < 0.02);
}

TEST_CASE("bodies that are not swept are refused with the reason") {
  Progress silent;
  const auto reason = [&](const Shape& shape) {
    try {
      find_swept_body(model_of(shape), "body");
    } catch (const Error& e) {
      CHECK(e.kind() == ErrorKind::input);
      CHECK_FALSE(e.remedy().empty());
      return std::string(e.what());
    }
    return std::string();
  };
  CHECK_THAT(reason(make_torus(1, 0.3)), contains_text("no swept body"));
  CHECK_THAT(reason(make_sphere(1)), contains_text("thicker than half their chord"));
  HalfWing wing;
  wing.airfoil = naca_symmetric(0.12, 0);
  wing.closed_root = true;
  const Shape one = make_half_wing(wing);
  CHECK_THAT(reason(make_compound(one, translated(one, Vec3(0, 0, 1)))), contains_text("several parts"));
}
