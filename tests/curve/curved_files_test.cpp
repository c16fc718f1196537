// Curved cells in VTU, Gmsh and CGNS, as VTK, gmsh and cgnscheck read them.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iostream>
#include <map>
#include <sstream>

#include "core/curve/curved_bound.hpp"
#include "core/export/curved_order.hpp"
#include "core/export/structured_blocks.hpp"
#include "core/export/write_curved.hpp"
#include "tests/catch.hpp"
#include "tests/export/peers.hpp"
#include "tests/export/sample_meshes.hpp"

using namespace flowcage;
using namespace flowcage::tests;

namespace {

/// Two cells side by side, moved by the map of degree `order` that read_curved.py knows.
CurvedMesh two_cells(int order) {
  const HexMesh box = box_mesh({2, 1, 1}, [](const Vec3& p) { return Vec3(2 * p.x(), p.y(), p.z()); });
  CurvedMesh curved = interpolated_mesh(blocks_of_cells(box), order);
  for (Vec3& p : curved.nodes.mutable_points()) {
    p = Vec3(p.x() + 0.1 * std::pow(p.y(), order), p.y() + 0.05 * std::pow(p.z(), order),
             p.z() + 0.1 * p.x() * std::pow(p.y(), order - 1));
  }
  return curved;
}

std::map<std::string, double> seen_by_vtk(const std::filesystem::path& file, int order) {
  const PeerRun said = run(fmt::format(
      "/usr/bin/python3 " FLOWCAGE_TEST_SOURCES "/curve/read_curved.py '{}' {}", file.string(), order));
  CAPTURE(said.output);
  REQUIRE(said.exit_code == 0);
  std::map<std::string, double> values;
  std::istringstream words(said.output);
  std::string name;
  for (double value = 0; words >> name >> value;) values[name] = value;
  return values;
}

}  // namespace

TEST_CASE("every order of nodes is a permutation with the corners first") {
  for (int order = 1; order <= 4; ++order) {
    for (const CurvedOrder& of : {vtk_order(order), gmsh_order(order), cgns_order(order)}) {
      for (const std::vector<int>* list : {&of.hex, &of.quad}) {
        std::vector<int> sorted = *list;
        std::sort(sorted.begin(), sorted.end());
        const std::size_t n = order + 1;
        REQUIRE(sorted.size() == (list == &of.hex ? n * n * n : n * n));
        for (std::size_t i = 0; i < sorted.size(); ++i) CHECK(sorted[i] == static_cast<int>(i));
        CHECK((*list)[0] == 0);
        CHECK((*list)[1] == order);
        CHECK((*list)[2] == order + (order + 1) * order);
      }
    }
  }
}

TEST_CASE("VTK, gmsh and cgnscheck read curved cells of order 2 to 4") {
  const bool have_vtk = have_python_module("vtk"), have_gmsh = have_program("gmsh");
  const bool have_cgnscheck = have_program("cgnscheck");
  for (int order = 2; order <= 4; ++order) {
    CAPTURE(order);
    const CurvedMesh mesh = two_cells(order);
    const ScratchFolder folder;
    const auto vtu = folder.path() / "a.vtu", msh = folder.path() / "a.msh", cgns = folder.path() / "a.cgns";
    {
      std::ofstream vtu_file(vtu, std::ios::binary), msh_file(msh);
      const auto notes = write_curved_vtu(vtu_file, mesh);
      CHECK(notes.size() == 1);  // "symmetry plane"
      CHECK(write_curved_gmsh(msh_file, mesh) == notes);
      CHECK(write_curved_cgns(cgns, mesh) == notes);
    }
    if (have_vtk) {
      for (const auto& file : {vtu, cgns}) {
        CAPTURE(file);
        const auto seen = seen_by_vtk(file, order);
        CHECK(seen.at("hexes") == 2);
        if (seen.count("unsupported") != 0) {
          std::cout << "skipped: this VTK does not read HEXA_125\n";
          continue;
        }
        CHECK(seen.at("distance") < 1e-12);
        if (file == cgns) continue;  // VTK reads the boundary of CGNS on demand
        CHECK(seen.at("quads") == 10);
        CHECK(seen.at("quad_distance") < 1e-12);
      }
    }
    if (have_cgnscheck) {
      const PeerRun said = run("cgnscheck -v '" + cgns.string() + "'");
      CAPTURE(said.output);
      CHECK(said.exit_code == 0);
      CHECK(said.output.find("WARNING") == std::string::npos);
      CHECK(said.output.find("ERROR") == std::string::npos);
      CHECK(said.output.find("Element Set Type=HEXA_" +
                             std::to_string((order + 1) * (order + 1) * (order + 1))) != std::string::npos);
    }
    if (have_gmsh) {
      // gmsh bounds the Jacobians of its elements itself: nodes in a wrong order fold them.
      const auto script = folder.path() / "check.geo";
      std::ofstream(script)
          << "Merge \"a.msh\";\nPlugin(AnalyseMeshQuality).JacobianDeterminant = 1;\n"
             "Plugin(AnalyseMeshQuality).DimensionOfElements = 3;\nPlugin(AnalyseMeshQuality).Run;\n";
      const PeerRun said = run("gmsh '" + script.string() + "' -");
      CAPTURE(said.output);
      CHECK(said.exit_code == 0);
      CHECK(said.output.find("Error") == std::string::npos);
      const auto at = said.output.find("minJ/maxJ =");
      REQUIRE(at != std::string::npos);
      const double worst = std::stod(said.output.substr(at + 11));
      CHECK(worst ==
            Approx(measure_curved_validity(mesh).min_ratio).epsilon(0.03));  // its bound against ours
    }
  }
}
