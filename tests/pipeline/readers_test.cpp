// Meshes that other programs wrote, or wrote again.
#include <fstream>

#include "core/export/read_mesh.hpp"
#include "core/export/write_polymesh.hpp"
#include "core/export/write_vtu.hpp"
#include "core/quality/quality_report.hpp"
#include "tests/catch.hpp"
#include "tests/export/peers.hpp"
#include "tests/export/sample_meshes.hpp"

using namespace flowcage;
using namespace flowcage::tests;

TEST_CASE("VTU files of VTK and meshio are read whatever their encoding") {
  const bool have_vtk = have_python_module("vtk"), have_meshio = have_python_module("meshio");
  const HexMesh mesh = sphere_shell(6, 4, 3, true);
  const ScratchFolder folder;
  const auto file = folder.path() / "mesh.vtu";
  {
    std::ofstream out(file, std::ios::binary);
    write_vtu(out, mesh);
  }
  std::vector<std::string> forms;
  if (have_vtk) {
    forms = {"vtk-ascii",
             "vtk-binary",
             "vtk-binary-64",
             "vtk-appended-raw",
             "vtk-appended-raw-64",
             "vtk-appended-base64",
             "vtk-appended-base64-64",
             "vtk-binary-zlib",
             "vtk-binary-zlib-64",
             "vtk-appended-raw-zlib",
             "vtk-appended-base64-zlib-64"};
  }
  if (have_meshio) forms.insert(forms.end(), {"meshio-ascii", "meshio-binary", "meshio-zlib"});
  std::string command = "/usr/bin/python3 " FLOWCAGE_TEST_SOURCES "/pipeline/rewrite_vtu.py '" +
                        file.string() + "' '" + folder.path().string() + "'";
  for (const std::string& form : forms) command += " " + form;
  const PeerRun said = run(command);
  CAPTURE(said.output);
  REQUIRE(said.exit_code == 0);
  for (const std::string& form : forms) {
    CAPTURE(form);
    const bool by_vtk = form.starts_with("vtk");
    const auto again = folder.path() / (form + ".vtu");
#ifndef FLOWCAGE_HAVE_ZLIB
    if (form.find("zlib") != std::string::npos) {
      CHECK_THROWS_WITH(read_vtu(again), Catch::Contains("compressed by vtkZLibDataCompressor"));
      continue;
    }
#endif
    const HexMesh read = read_vtu(again);
    REQUIRE(read.cell_count() == mesh.cell_count());
    std::vector<HexPoints> cells(static_cast<std::size_t>(mesh.cell_count())), read_cells = cells;
    mesh.read_cells(0, cells);
    read.read_cells(0, read_cells);
    CHECK(read_cells == cells);
    // ASCII of VTK has fewer digits than a double.
    double distance = 0;
    REQUIRE(read.points().size() == mesh.points().size());
    for (std::size_t p = 0; p < mesh.points().size(); ++p) {
      distance = std::max(distance, (read.points()[p] - mesh.points()[p]).norm());
    }
    CHECK(distance <= (form.find("ascii") != std::string::npos ? 1e-5 : 0));
    REQUIRE(read.patches().size() == mesh.patches().size());
    for (std::size_t i = 0; i < mesh.patches().size(); ++i) {
      CHECK(read.patches()[i].quads.size() == mesh.patches()[i].quads.size());
      CHECK(read.patches()[i].owner == mesh.patches()[i].owner);
      if (by_vtk) {  // meshio does not write field data
        CHECK(read.patches()[i].name == mesh.patches()[i].name);
        CHECK(read.patches()[i].type == mesh.patches()[i].type);
      }
    }
  }
}

TEST_CASE("OpenFOAM's own conversion of ASCII and binary gives the same mesh") {
  if (!have_program("foamFormatConvert")) return;
  const HexMesh mesh = shuffled(sphere_shell(6, 5, 4), 5);
  for (const bool binary : {true, false}) {
    CAPTURE(binary);
    const ScratchFolder folder;
    PolyMeshSettings settings;
    settings.binary = binary;
    write_openfoam_case(folder.path(), mesh, build_hex_adjacency(mesh), settings);
    const HexMesh before = read_polymesh(folder.path());
    std::string control = read_text(folder.path() / "system/controlDict");
    control.replace(control.find("writeFormat     binary"), 22,
                    binary ? "writeFormat ascii" : "writeFormat binary");
    control.replace(control.find("writePrecision  12"), 18, "writePrecision 17");
    std::ofstream(folder.path() / "system/controlDict") << control;
    const PeerRun said = run("WM_PROJECT_DIR=/usr/share/openfoam foamFormatConvert -constant -case '" +
                             folder.path().string() + "'");
    CAPTURE(said.output);
    REQUIRE(said.exit_code == 0);
    const std::string converted = read_text(folder.path() / "constant/polyMesh/points");
    REQUIRE(converted.find(binary ? "ascii;" : "binary;") != std::string::npos);
    const HexMesh after = read_polymesh(folder.path());
    CHECK(std::equal(before.points().begin(), before.points().end(), after.points().begin(),
                     after.points().end()));
    std::vector<HexPoints> a(static_cast<std::size_t>(before.cell_count())), b = a;
    REQUIRE(after.cell_count() == before.cell_count());
    before.read_cells(0, a);
    after.read_cells(0, b);
    CHECK(a == b);
    for (std::size_t i = 0; i < before.patches().size(); ++i) {
      CHECK(before.patches()[i].name == after.patches()[i].name);
      CHECK(before.patches()[i].quads == after.patches()[i].quads);
    }
  }
}

TEST_CASE("A mesh of blockMesh is measured as checkMesh does") {
  if (!have_program("blockMesh") || !have_program("checkMesh")) return;
  const ScratchFolder folder;
  std::filesystem::create_directories(folder.path() / "constant");
  write_case_files(folder.path(), "case.foam");
  std::ofstream(folder.path() / "system/blockMeshDict")
      << "FoamFile { version 2.0; format ascii; class dictionary; object blockMeshDict; }\n"
         "vertices ((0 0 0) (2 0 0.1) (2.2 1 0) (0 1.2 0) (0 0 1) (2 0 1.3) (2 1 1) (0.3 1 1)\n"
         "          (4 -1 0) (4 2 0) (4 0 2) (4 1 1));\n"
         "blocks (hex (0 1 2 3 4 5 6 7) (8 6 5) simpleGrading (3 1 0.5)\n"
         "        hex (1 8 9 2 5 10 11 6) (7 6 5) simpleGrading (1 1 0.5));\n"
         "edges (arc 1 2 (2.4 0.5 0)); boundary (left { type wall; faces ((0 4 7 3)); });\n"
         "defaultPatch { name rest; type patch; }\nmergePatchPairs ();\n";
  for (const char* format : {"ascii", "binary"}) {
    CAPTURE(format);
    std::string control = read_text(folder.path() / "system/controlDict");
    const auto at = control.find("writeFormat");
    control.replace(at, control.find(';', at) - at, std::string("writeFormat ") + format);
    std::ofstream(folder.path() / "system/controlDict") << control;
    const PeerRun made =
        run("WM_PROJECT_DIR=/usr/share/openfoam blockMesh -case '" + folder.path().string() + "'");
    CAPTURE(made.output);
    REQUIRE(made.exit_code == 0);
    const HexMesh mesh = read_mesh(folder.path() / "case.foam");
    CHECK(mesh.cell_count() == 15 * 30);
    const QualityReport ours = measure_quality(mesh, build_hex_adjacency(mesh));
    const CheckMesh foam = check_mesh(folder.path());
    CAPTURE(foam.output);
    CHECK(ours.non_orthogonality.max == Approx(foam.figures.at("Mesh non-orthogonality Max")).epsilon(1e-9));
    CHECK(ours.non_orthogonality.mean == Approx(foam.figures.at("average")).epsilon(1e-9));
    CHECK(ours.skewness.max == Approx(foam.figures.at("Max skewness")).epsilon(1e-9));
    CHECK(ours.aspect_ratio.max == Approx(foam.figures.at("Max aspect ratio")).epsilon(1e-9));
    CHECK(ours.total_volume == Approx(foam.figures.at("Total volume")).epsilon(1e-9));
  }
}
