#include "core/mesh/stencil_table.hpp"

#include <array>
#include <numeric>

#include "core/base/parallel.hpp"
#include "core/limit/limit_stencils.hpp"
#include "core/mesh/stencil_builder.hpp"
#include "core/subdivide/refine.hpp"
#include "tests/catch.hpp"
#include "tests/subdivide/cage_zoo.hpp"

using namespace flowcage;

namespace {

StencilTable table_of(Index control, const std::vector<std::vector<std::pair<Index, double>>>& rows) {
  return build_stencils(static_cast<Offset>(rows.size()), control,
                        [&](Index begin, Index end, StencilWriter& out) {
                          for (Index r = begin; r < end; ++r) {
                            for (const auto& [vertex, weight] : rows[r]) out.add(vertex, weight);
                            out.end_row();
                          }
                        });
}
bool equal(const StencilTable& a, const StencilTable& b) {
  return a.offsets == b.offsets && a.indices == b.indices && a.weights == b.weights &&
         a.control_vertex_count == b.control_vertex_count;
}

}  // namespace

TEST_CASE("a written row is sorted, adds up repeated vertices and drops what cancels") {
  const StencilTable table = table_of(5, {{{4, 1}, {0, 2}, {4, 0.5}}, {}, {{3, 1}, {2, 1}, {3, -1}}});
  CHECK(table.offsets == std::vector<Offset>{0, 2, 2, 3});
  CHECK(table.indices == std::vector<Index>{0, 4, 2});
  CHECK(table.weights == std::vector<double>{2, 1.5, 1});
  const std::vector<Vec3> points{{1, 0, 0}, {0, 0, 0}, {0, 5, 0}, {0, 0, 0}, {0, 0, 2}};
  CHECK(apply_stencils(table, points) == std::vector<Vec3>{{2, 0, 3}, {0, 0, 0}, {0, 5, 0}});
}

TEST_CASE("composition and concatenation of tables") {
  const StencilTable first = table_of(3, {{{0, 0.5}, {1, 0.5}}, {{2, 1}}, {{1, 2}, {2, -1}}});
  const StencilTable second = table_of(3, {{{0, 2}, {2, 1}}, {{1, 3}}});
  CHECK(equal(compose(second, first), table_of(3, {{{0, 1}, {1, 3}, {2, -1}}, {{2, 3}}})));
  CHECK(equal(concatenate(first, table_of(3, {{{0, 7}}})),
              table_of(3, {{{0, 0.5}, {1, 0.5}}, {{2, 1}}, {{1, 2}, {2, -1}}, {{0, 7}}})));
}

TEST_CASE("tables and points are the same bits on any number of threads") {
  zoo::Random random(5);
  Cage cage = zoo::torus(9, 7);
  zoo::scramble(cage, random, 40);
  zoo::add_tags(cage, random, zoo::Tags::mixed, 0.2);
  std::vector<std::vector<Vec3>> points;
  std::vector<LimitSamples> samples;
  for (const int threads : {1, 2, 8}) {
    set_thread_count(threads);
    const std::vector<SurfaceLevel> levels = build_levels(cage, 4);
    points.push_back(refine_points(levels, cage.points));
    samples.push_back(oversampled_limit_stencils(levels[2]));
  }
  set_thread_count(0);
  REQUIRE(samples[0].position.size() > 5000);  // more than one range of the parallel loops
  for (const int k : {1, 2}) {
    CHECK(points[k] == points[0]);
    CHECK(equal(samples[k].position, samples[0].position));
    CHECK(equal(samples[k].tangents.u, samples[0].tangents.u));
    CHECK(equal(samples[k].tangents.v, samples[0].tangents.v));
  }
}
