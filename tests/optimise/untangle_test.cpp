#include "core/optimise/untangle.hpp"

#include <bit>
#include <limits>

#include "core/base/parallel.hpp"
#include "tests/catch.hpp"
#include "tests/optimise/sample_meshes.hpp"

using namespace flowcage;

namespace {

double largest_distance(std::span<const Vec3> a, std::span<const Vec3> b) {
  double out = 0;
  for (std::size_t p = 0; p < a.size(); ++p) out = std::max(out, (a[p] - b[p]).norm());
  return out;
}

bool same_bits(double a, double b) {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}

bool same_bits(const Vec3& a, const Vec3& b) {
  return same_bits(a[0], b[0]) && same_bits(a[1], b[1]) && same_bits(a[2], b[2]);
}

bool same_bits(std::span<const Vec3> a, std::span<const Vec3> b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const Vec3& p, const Vec3& q) { return same_bits(p, q); });
}

std::vector<std::uint8_t> boundary_points(const HexView& mesh) {
  std::vector<std::uint8_t> out(mesh.points().size());
  for (const BoundaryPatch& patch : mesh.patches()) {
    for (const auto& quad : patch.quads) {
      for (const Index p : quad) out[p] = 1;
    }
  }
  return out;
}

void check_boundary_kept(const HexView& mesh, const UntangledPoints& result) {
  const std::vector<std::uint8_t> boundary = boundary_points(mesh);
  for (std::size_t p = 0; p < boundary.size(); ++p) {
    if (boundary[p] != 0) REQUIRE(same_bits(mesh.points()[p], result.points[p]));
  }
}

UntangledPoints run(const BlockMesh& mesh, const UntangleSettings& settings = {}) {
  Progress progress;
  return untangle(mesh, settings, progress);
}

/// A wing-like box in a sphere, its lines folded between wall and far field.
BlockMesh folded_shell(Index out) {
  BlockMesh mesh = sample::cube_shell(8, out);
  sample::ShellShape shape;
  shape.half = Vec3(1, 0.1, 3);
  shape.radius = 20;
  shape.out = out;
  shape.growth = std::pow(1000.0, 1.0 / out);
  sample::map_points(mesh, [&](const Vec3& p) { return sample::shell_point(p, shape); });
  const std::vector<std::uint8_t> boundary = boundary_points(mesh);
  for (std::size_t n = 0; n < boundary.size(); ++n) {
    Vec3& p = mesh.mutable_points()[n];
    const double s = std::clamp((p.norm() - 3.3) / 16.7, 0.0, 1.0);
    if (boundary[n] == 0) p += 6 * std::sin(3.14159265358979 * s) * Vec3(std::sin(p[1]), 0, std::sin(p[0]));
  }
  return mesh;
}

}  // namespace

TEST_CASE("untangle: a box with tangled inner points comes back near the regular grid") {
  std::mt19937 random(1);
  for (const double size : {0.6, 3.0}) {
    const BlockMesh regular = sample::box_mesh({10, 10, 10});
    BlockMesh mesh = regular;
    sample::shake(mesh, size, random);
    const UntangledPoints result = run(mesh);
    CHECK(result.report.before.inverted > 300);
    CHECK(result.report.after.inverted == 0);
    CHECK(result.report.after.uncertified == 0);
    CHECK(result.report.after.min_scaled_jacobian > 0.8);
    CHECK(result.report.after.mean_scaled_jacobian > 0.98);
    CHECK(largest_distance(result.points, regular.points()) < 0.5);
    check_boundary_kept(mesh, result);
  }
}

TEST_CASE("untangle: a box twisted by 120 degrees, all inner points in one place") {
  BlockMesh mesh = sample::box_mesh({8, 8, 16});
  const std::vector<std::uint8_t> boundary = boundary_points(mesh);
  for (std::size_t n = 0; n < boundary.size(); ++n) {
    Vec3& p = mesh.mutable_points()[n];
    const double angle = 2.0943951023932 * p[2] / 16;
    const Vec3 q = p - Vec3(4, 4, 0);
    p = boundary[n] != 0 ? Vec3(std::cos(angle) * q[0] - std::sin(angle) * q[1],
                                std::sin(angle) * q[0] + std::cos(angle) * q[1], q[2])
                         : Vec3(0, 0, 8);
  }
  const UntangledPoints result = run(mesh);
  CHECK(result.report.before.inverted > 1000);
  CHECK(result.report.after.inverted == 0);
  CHECK(result.report.after.uncertified == 0);
  CHECK(result.report.after.min_scaled_jacobian > 0.75);
  check_boundary_kept(mesh, result);
}

TEST_CASE("untangle: folded lines between a thin wing and a far sphere") {
  for (const Index out : {4, 8}) {
    const BlockMesh mesh = folded_shell(out);
    const UntangledPoints result = run(mesh);
    CHECK(result.report.before.inverted > 150);
    CHECK(result.report.after.inverted == 0);
    CHECK(result.report.after.uncertified == 0);
    CHECK(result.report.after.min_scaled_jacobian > 0.35);
    CHECK(result.report.after.mean_scaled_jacobian > 0.85);
    check_boundary_kept(mesh, result);
  }
}

TEST_CASE("smooth: a good shell keeps its spacing at the wall and gains quality") {
  BlockMesh mesh = sample::cube_shell(8, 8);
  sample::ShellShape shape;
  shape.half = Vec3(1, 0.5, 3);
  shape.radius = 20;
  shape.growth = 2.3;
  sample::map_points(mesh, [&](const Vec3& p) { return sample::shell_point(p, shape); });
  const UntangledPoints result = run(mesh);
  CHECK(result.report.after.min_scaled_jacobian >= result.report.before.min_scaled_jacobian);
  CHECK(result.report.after.mean_scaled_jacobian > result.report.before.mean_scaled_jacobian + 0.05);
  // Three lines of a block's edge are pulled toward equal angles there; inside of the blocks the wall's cells
  // stay.
  double mean = 0;
  int count = 0;
  for (Index b = 0; b < mesh.block_count(); ++b) {
    for (Index j = 1; j < 8; ++j) {
      for (Index i = 1; i < 8; ++i) {
        const Index p = mesh.point_number(b, i, j, 0);
        const Index q = mesh.point_number(b, i, j, 1);
        const double ratio =
            (result.points[q] - result.points[p]).norm() / (mesh.points()[q] - mesh.points()[p]).norm();
        CHECK(ratio == Approx(1).margin(0.3));
        mean += std::log(ratio);
        ++count;
      }
    }
  }
  // Oblique lines are a little longer than target: the volume term wants the volume of the right-angled cell.
  CHECK(std::exp(mean / count) == Approx(1).margin(0.15));
}

TEST_CASE("untangle: a boundary that no inner points can mend is reported, with nothing worse") {
  BlockMesh mesh = sample::box_mesh({4, 4, 4});
  // A corner of the box pushed through the opposite one: its cell's own boundary faces fold.
  mesh.mutable_points()[mesh.point_number(0, 0, 0, 0)] = Vec3(2.5, 2.5, 2.5);
  const UntangledPoints result = run(mesh);
  CHECK(result.report.before.inverted >= 1);
  CHECK(result.report.after.inverted >= 1);
  CHECK(result.report.after.inverted <= result.report.before.inverted);
  REQUIRE(static_cast<Offset>(result.report.inverted.size()) == result.report.after.inverted);
  CHECK(result.report.inverted[0].cell == 0);
  CHECK((result.report.inverted[0].centre - Vec3(0.8, 0.8, 0.8)).norm() < 1.0);
  CHECK(result.report.inverted[0].scaled_jacobian <= 0);
  check_boundary_kept(mesh, result);
}

TEST_CASE("untangle: points of a symmetry plane stay in it to the bit") {
  std::mt19937 random(2);
  BlockMesh mesh = sample::box_mesh({6, 6, 6});
  const double plane = -0.1;  // no binary fraction
  sample::map_points(mesh, [&](const Vec3& p) { return Vec3(p[0], p[1] == 0 ? plane : p[1], p[2]); });
  sample::shake(mesh, 0.9, random);
  // Points of the plane are displaced within it: only sliding can mend that.
  for (Index k = 1; k < 6; ++k) {
    for (Index i = 1; i < 6; ++i)
      mesh.mutable_points()[mesh.point_number(0, i, 0, k)] += Vec3(i == 3 ? 1.4 : 0, 0, 0);
  }
  UntangleSettings settings;
  const std::vector<PointFreedom> per_patch{fixed_point, fixed_point, in_plane(1),
                                            fixed_point, fixed_point, fixed_point};
  settings.freedom = patch_freedom(mesh, per_patch);
  CHECK(run(mesh).report.after.inverted > 0);
  const UntangledPoints result = run(mesh, settings);
  CHECK(result.report.after.inverted == 0);
  double moved = 0;
  for (const auto& quad : mesh.patches()[2].quads) {
    for (const Index p : quad) {
      CHECK(same_bits(result.points[p][1], plane));
      moved = std::max(moved, (result.points[p] - mesh.points()[p]).norm());
    }
  }
  CHECK(moved > 0.3);
}

TEST_CASE("untangle: an outer boundary slides on its sphere") {
  BlockMesh mesh = sample::cube_shell(6, 5);
  sample::ShellShape shape;
  shape.out = 5;
  shape.growth = 1.5;
  sample::map_points(mesh, [&](const Vec3& p) { return sample::shell_point(p, shape); });
  // The outer points are twisted about z by up to 50 degrees.
  std::vector<std::uint8_t> outer(mesh.points().size());
  for (const auto& quad : mesh.patches()[1].quads) {
    for (const Index p : quad) outer[p] = 1;
  }
  for (std::size_t p = 0; p < outer.size(); ++p) {
    if (outer[p] == 0) continue;
    const Vec3 q = mesh.points()[p];
    const Eigen::AngleAxisd turn(0.9 * std::cos(0.3 * q[2]), Vec3::UnitZ());
    mesh.mutable_points()[p] = turn * q;
  }
  UntangleSettings settings;
  const std::vector<PointFreedom> per_patch{fixed_point, on_surface(0)};
  settings.freedom = patch_freedom(mesh, per_patch);
  settings.projectors.emplace_back([](std::span<const Vec3> queries, std::span<Vec3> feet) {
    for (std::size_t n = 0; n < queries.size(); ++n) feet[n] = 10 * queries[n].normalized();
  });
  const UntangledPoints held = run(mesh);
  const UntangledPoints result = run(mesh, settings);
  CHECK(result.report.after.inverted == 0);
  CHECK(result.report.after.mean_scaled_jacobian > held.report.after.mean_scaled_jacobian + 0.02);
  double moved = 0;
  for (std::size_t p = 0; p < outer.size(); ++p) {
    if (outer[p] == 0) continue;
    CHECK(result.points[p].norm() == Approx(10).epsilon(1e-12));
    moved = std::max(moved, (result.points[p] - mesh.points()[p]).norm());
  }
  CHECK(moved > 1);
}

TEST_CASE("untangle: never worse than the input, whatever the input") {
  std::mt19937 random(7);
  for (int n = 0; n < 25; ++n) {
    BlockMesh mesh = sample::divided(sample::random_complex(random), {});
    sample::shake(mesh, 0.15 * (n % 6), random);
    if (n % 5 == 0) {
      for (Vec3& p : mesh.mutable_points())
        p += 0.1 * (n % 4) * Vec3(std::sin(9 * p[1]), std::cos(8 * p[0]), 0);
    }
    UntangleSettings settings;
    settings.max_untangle_passes = 10;
    settings.max_smooth_passes = 2;
    const UntangledPoints result = run(mesh, settings);
    const HexValidity& before = result.report.before;
    const HexValidity& after = result.report.after;
    CHECK(after.inverted <= before.inverted);
    if (after.inverted == before.inverted) CHECK(after.min_scaled_jacobian >= before.min_scaled_jacobian);
    check_boundary_kept(mesh, result);
  }
}

TEST_CASE("untangle: the same mesh at any size and the same bits on any number of threads") {
  std::mt19937 random(8);
  BlockMesh mesh = sample::box_mesh({14, 14, 14});
  sample::shake(mesh, 0.8, random);
  UntangleSettings settings;
  settings.max_smooth_passes = 1;
  set_thread_count(1);
  const UntangledPoints one = run(mesh, settings);
  for (const int threads : {2, 8}) {
    set_thread_count(threads);
    CHECK(same_bits(run(mesh, settings).points, one.points));
  }
  set_thread_count(0);
  for (const double size : {std::ldexp(1.0, -20), std::ldexp(1.0, 14)}) {  // about 1e-6 and 1e4, exactly
    BlockMesh scaled = mesh;
    sample::map_points(scaled, [&](const Vec3& p) { return Vec3(size * p); });
    std::vector<Vec3> back = run(scaled, settings).points;
    for (Vec3& p : back) p /= size;
    CHECK(same_bits(back, one.points));
  }
  BlockMesh tiny = mesh;
  sample::map_points(tiny, [&](const Vec3& p) { return Vec3(1e-9 * p); });
  const UntangledPoints result = run(tiny, settings);
  CHECK(result.report.after.inverted == 0);
  CHECK(result.report.after.mean_scaled_jacobian ==
        Approx(one.report.after.mean_scaled_jacobian).margin(0.01));
}

TEST_CASE("repair: only the neighbourhood of bad cells moves") {
  BlockMesh mesh = sample::box_mesh({20, 20, 20});
  const Index bad_a = mesh.point_number(0, 5, 5, 5);
  const Index bad_b = mesh.point_number(0, 14, 14, 14);
  mesh.mutable_points()[bad_a] += Vec3(1.5, 0.2, 0.4);
  mesh.mutable_points()[bad_b] += Vec3(-0.3, 1.7, 0.1);
  RepairSettings settings;
  settings.rings = 2;
  Progress progress;
  const UntangledPoints result = repair_cells(mesh, settings, progress);
  CHECK(result.report.patches == 2);
  CHECK(result.report.before.inverted > 2);
  CHECK(result.report.after.inverted == 0);
  CHECK(result.report.after.min_scaled_jacobian > 0.8);
  CHECK(result.report.optimised_cells < 600);
  for (Index k = 0; k <= 20; ++k) {
    for (Index j = 0; j <= 20; ++j) {
      for (Index i = 0; i <= 20; ++i) {
        const auto far = [&](Index c) {
          return std::max({std::abs(i - c), std::abs(j - c), std::abs(k - c)}) > 4;
        };
        const Index p = mesh.point_number(0, i, j, k);
        if (far(5) && far(14)) REQUIRE(same_bits(mesh.points()[p], result.points[p]));
      }
    }
  }
  // Nothing to do: nothing moves.
  const BlockMesh good = sample::box_mesh({5, 5, 5});
  const UntangledPoints same = repair_cells(good, settings, progress);
  CHECK(same.report.patches == 0);
  CHECK(same_bits(same.points, good.points()));
}

TEST_CASE("untangle: explicit hexes, limits, cancellation and broken input") {
  std::mt19937 random(9);
  BlockMesh mesh = sample::box_mesh({6, 6, 6});
  sample::shake(mesh, 0.8, random);
  Progress progress;
  std::vector<HexPoints> cells(static_cast<std::size_t>(mesh.cell_count()));
  mesh.read_cells(0, cells);
  const HexMesh copy({mesh.points().begin(), mesh.points().end()}, cells, mesh.patches());
  CHECK(same_bits(untangle(copy, {}, progress).points, run(mesh).points));

  UntangleSettings little;
  little.max_cell_evaluations = 10.0 * static_cast<double>(mesh.cell_count());
  const UntangledPoints stopped = run(mesh, little);
  CHECK(stopped.report.limit_reached);
  CHECK(stopped.report.evaluations < run(mesh).report.evaluations);
  CHECK(stopped.report.after.inverted <= stopped.report.before.inverted);

  class Impatient : public Progress {
    bool cancelled() const override { return true; }
  } impatient;
  CHECK_THROWS_AS(untangle(mesh, {}, impatient), Error);

  UntangleSettings wrong;
  wrong.freedom.resize(3);
  CHECK_THROWS_WITH(untangle(mesh, wrong, progress), contains_text("3 entries"));
  wrong.freedom.assign(mesh.points().size(), on_surface(0));
  CHECK_THROWS_WITH(untangle(mesh, wrong, progress), contains_text("projector 0 of 0"));
  BlockMesh broken = mesh;
  broken.mutable_points()[100][1] = std::numeric_limits<double>::quiet_NaN();
  CHECK_THROWS_WITH(untangle(broken, {}, progress), contains_text("point 100"));
  BlockMesh flat = mesh;
  sample::map_points(flat, [](const Vec3&) { return Vec3(0, 0, 0); });
  const UntangledPoints nothing = run(flat);
  CHECK(nothing.report.after.inverted == nothing.report.before.inverted);
}
