// Exports of whole aircraft and assemblies whose parts pass through or touch each other, where their folder
// is there.
#include <cstdio>
#include <filesystem>
#include <random>

#include "core/project/winding_number.hpp"
#include "occ_bridge/cad_model.hpp"
#include "tests/catch.hpp"

using namespace flowcage;

TEST_CASE("real bodies that overlap: projections land on the outer skin") {
  const std::filesystem::path folder = FLOWCAGE_REAL_CAD_DIR;
  if (!std::filesystem::is_directory(folder)) {
    std::puts("skipped: no folder of real CAD files");
    return;
  }
  for (const char* name : {"f16_vsp.stp"}) {
    const std::string file = (folder / name).string();
    if (!std::filesystem::exists(file)) continue;
    CAPTURE(name);
    Progress silent;
    CadReadSettings as_read;
    as_read.unite = false;
    const CadModel parts = read_cad({&file, 1}, as_read, silent);
    const CadModel skin = read_cad({&file, 1}, {}, silent);
    REQUIRE_FALSE(skin.summary().overlaps.empty());
    for (const CadOverlap& overlap : skin.summary().overlaps) CHECK(overlap.united);

    const Tessellation& mesh = parts.tessellation();
    const WindingTree tree = build_winding_tree(mesh.points, mesh.triangles);
    std::mt19937 random(3);
    // Near the faces, hidden ones included: from far outside the nearest face is never a hidden one.
    std::uniform_real_distribution<double> unit(-0.005, 0.005);
    std::uniform_int_distribution<std::size_t> any(0, mesh.points.size() - 1);
    std::vector<Vec3> points;
    for (int i = 0; i < 3000; ++i) {
      const double x = unit(random), y = unit(random), z = unit(random);
      points.push_back(mesh.points[any(random)] + parts.diagonal() * Vec3(x, y, z));
    }
    // On a hidden piece both sides are in a body besides its own. The tessellation is off by up to off / 2,
    // so that a few feet beside a junction look like it.
    const auto seem_hidden = [&](const CadModel& model) {
      const double off = 2e-3 * parts.diagonal();
      std::vector<SurfacePoint> feet(points.size());
      model.closest_points(points, {}, feet);
      int count = 0;
      for (const SurfacePoint& foot : feet) {
        const double outer = winding_number(tree, foot.position + off * foot.normal);
        const double inner = winding_number(tree, foot.position - off * foot.normal);
        count += outer > 0.6 && inner > 1.6 ? 1 : 0;
      }
      return count;
    };
    CHECK(10 * seem_hidden(skin) <= seem_hidden(parts));
    std::printf("%s: %d of %zu feet look hidden, %d as read\n", name, seem_hidden(skin), points.size(),
                seem_hidden(parts));
  }
}
