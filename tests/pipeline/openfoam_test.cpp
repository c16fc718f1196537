// What OpenFOAM itself says of the files written, and whether our figures are its figures.
#include <fmt/format.h>

#include <cmath>

#include "core/export/write_polymesh.hpp"
#include "core/quality/quality_report.hpp"
#include "tests/catch.hpp"
#include "tests/export/peers.hpp"
#include "tests/export/sample_meshes.hpp"

using namespace flowcage;
using namespace flowcage::tests;

namespace {

struct Sample {
  const char* name;
  HexMesh mesh;
  bool ok;
};

std::vector<Sample> samples() {
  std::vector<Sample> list;
  list.push_back({"one cube", box_mesh({1, 1, 1}), true});
  list.push_back({"box", box_mesh({4, 3, 5}), true});
  list.push_back(
      {"sheared box",
       box_mesh({5, 4, 3}, [](const Vec3& p) { return Vec3(2 * p.x() + 0.8 * p.y(), p.y(), 0.3 * p.z()); }),
       true});
  list.push_back({"perturbed box", perturbed_box({9, 8, 7}, 0.03), true});
  list.push_back(
      {"stretched box",
       box_mesh({6, 6, 6},
                [](const Vec3& p) { return Vec3(p.x(), p.y(), 1e-4 * std::pow(p.z(), 3) + 1e-7 * p.z()); }),
       false});
  list.push_back({"torn box", perturbed_box({6, 6, 6}, 0.15), false});
  list.push_back({"sphere", sphere_shell(8, 10, 5), true});
  list.push_back({"half sphere", sphere_shell(8, 6, 20, true), true});
  list.push_back({"shuffled sphere", shuffled(sphere_shell(6, 5, 4), 3), true});
  return list;
}

}  // namespace

TEST_CASE("checkMesh accepts what is valid and prints our figures") {
  if (!have_program("checkMesh")) return;
  for (const bool binary : {true, false}) {
    for (const Sample& sample : samples()) {
      CAPTURE(sample.name, binary);
      const ScratchFolder folder;
      PolyMeshSettings settings;
      settings.binary = binary;
      const HexAdjacency adjacency = build_hex_adjacency(sample.mesh);
      const auto notes = write_openfoam_case(folder.path(), sample.mesh, adjacency, settings);
      const CheckMesh foam = check_mesh(folder.path());
      CAPTURE(foam.output);
      const QualityReport ours = measure_quality(sample.mesh, adjacency);
      CHECK(foam.mesh_ok == sample.ok);
      CHECK(check_mesh_failures(ours).empty() == foam.mesh_ok);
      CHECK(foam.output.find("Boundary definition OK") != std::string::npos);
      CHECK(foam.output.find("Upper triangular ordering OK") != std::string::npos);
      const auto same = [&](const char* words, double value) {
        CAPTURE(words);
        REQUIRE(foam.figures.count(words) == 1);
        // The controlDict written asks for 12 digits; zeros are sums of rounding errors, and acos near 1
        // makes 1e-6 degrees of them.
        CHECK(value ==
              Approx(foam.figures.at(words)).epsilon(1e-10).margin(std::abs(value) < 1e-5 ? 3e-6 : 0));
      };
      const auto count = [&](const char* words, Offset value) { same(words, static_cast<double>(value)); };
      count("cells", ours.cells);
      count("points", ours.points);
      count("internal faces", ours.internal_faces);
      count("hexahedra", ours.cells);
      same("Max aspect ratio", ours.aspect_ratio.max);
      same("Max skewness", ours.skewness.max);
      if (ours.internal_faces > 0) {
        same("Mesh non-orthogonality Max", ours.non_orthogonality.max);
        same("average", ours.non_orthogonality.mean);
      }
      // checkMesh prints either the figure or the failure.
      if (ours.high_aspect_cells == 0) same("Max cell openness", ours.max_openness);
      if (ours.not_positive_volumes == 0) {
        same("Min volume", ours.min_volume);
        same("Max volume", ours.max_volume);
        same("Total volume", ours.total_volume);
      } else {
        count("Number of negative volume cells", ours.not_positive_volumes);
        same("Minimum negative volume", ours.min_volume);
      }
      if (ours.non_orthogonality_errors > 0) {
        count("Number of non-orthogonality errors", ours.non_orthogonality_errors);
      }
      if (ours.wrong_pyramids > 0) count("Error in face pyramids", ours.wrong_pyramids);
      if (ours.severely_non_orthogonal > 0) {
        CHECK(foam.output.find(fmt::format("> 70 degrees) faces: {}.", ours.severely_non_orthogonal)) !=
              std::string::npos);
      }
      if (ours.skew_faces > 0) {
        CHECK(foam.output.find(fmt::format(" {} highly skew faces", ours.skew_faces)) != std::string::npos);
      }
    }
  }
}
