// What VTK, meshio and gmsh read from the files written.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <sstream>

#include "core/export/read_mesh.hpp"
#include "core/export/write_surface.hpp"
#include "core/export/write_vtm.hpp"
#include "core/export/write_vtu.hpp"
#include "core/mesh/hex_adjacency.hpp"
#include "core/quality/jacobian.hpp"
#include "core/quality/quality_report.hpp"
#include "tests/catch.hpp"
#include "tests/export/peers.hpp"
#include "tests/export/sample_meshes.hpp"

using namespace flowcage;
using namespace flowcage::tests;

namespace {

std::map<std::string, double> read_with(const std::string& reader, const std::filesystem::path& file) {
  const PeerRun said = run("/usr/bin/python3 " FLOWCAGE_TEST_SOURCES "/pipeline/read_vtk.py " + reader +
                           " '" + file.string() + "'");
  CAPTURE(said.output);
  REQUIRE(said.exit_code == 0);
  std::map<std::string, double> values;
  std::istringstream lines(said.output);
  for (std::string line; std::getline(lines, line);) {
    const auto space = line.rfind(' ');
    REQUIRE(space != std::string::npos);
    values[line.substr(0, space)] = std::stod(line.substr(space + 1));
  }
  return values;
}

Cage outer_surface(const HexMesh& mesh) {
  Cage surface;
  surface.points.assign(mesh.points().begin(), mesh.points().end());
  for (std::size_t i = 0; i < mesh.patches().size(); ++i) {
    const BoundaryPatch& patch = mesh.patches()[i];
    surface.patch_names.push_back(patch.name);
    for (const auto& quad : patch.quads) {
      surface.faces.push_row(quad);
      surface.face_patch.push_back(static_cast<Index>(i));
    }
  }
  return surface;
}

}  // namespace

TEST_CASE("VTK and meshio read the VTU written, with its patches and fields") {
  struct Sample {
    const char* name;
    HexMesh mesh;
  };
  const std::vector<Sample> samples{{"box", perturbed_box({5, 4, 3}, 0.04)},
                                    {"half sphere", sphere_shell(8, 6, 4, true)},
                                    {"shuffled sphere", shuffled(sphere_shell(6, 5, 4), 11)}};
  const bool have_vtk = have_python_module("vtk"), have_meshio = have_python_module("meshio");
  for (const auto& [name, mesh] : samples) {
    CAPTURE(name);
    const ScratchFolder folder;
    const auto file = folder.path() / "mesh.vtu";
    const HexAdjacency adjacency = build_hex_adjacency(mesh);
    const QualityReport report = measure_quality(mesh, adjacency);
    const std::vector<float> jacobians = scaled_jacobians(mesh);
    std::vector<float> on_quads(static_cast<std::size_t>(adjacency.boundary_faces()), 0.25F);
    std::vector<float> on_points(mesh.points().size(), 0.5F);
    {
      std::ofstream out(file, std::ios::binary);
      write_vtu(
          out, mesh,
          {{{"scaled_jacobian", jacobians, {}}, {"deviation", {}, on_quads}}, {{"distance", on_points}}});
    }
    for (const std::string reader : {"vtk", "meshio"}) {
      if (!(reader == "vtk" ? have_vtk : have_meshio)) continue;
      CAPTURE(reader);
      auto values = read_with(reader, file);
      CHECK(values.at("points") == static_cast<double>(mesh.points().size()));
      CHECK(values.at("hexes") == static_cast<double>(mesh.cell_count()));
      CHECK(values.at("quads") == static_cast<double>(adjacency.boundary_faces()));
      CHECK(values.at("volume") == Approx(enclosed_volume(mesh)).epsilon(1e-12));
      CHECK(values.at("volume") == Approx(report.total_volume).epsilon(0.01));
      for (std::size_t i = 0; i < mesh.patches().size(); ++i) {
        std::string patch = mesh.patches()[i].name;
        std::replace(patch.begin(), patch.end(), ' ', '_');
        CHECK(values.at("patch:" + patch) == static_cast<double>(i));
        CHECK(values.at("faces:" + patch) == static_cast<double>(mesh.patches()[i].quads.size()));
      }
      if (reader == "meshio") continue;
      CHECK(values.at("cell_min:patchId") == -1);
      CHECK(values.at("cell_min:scaled_jacobian") == Approx(report.scaled_jacobian.min).epsilon(1e-6));
      CHECK(values.at("quad_sum:deviation") ==
            Approx(0.25 * static_cast<double>(on_quads.size())).epsilon(1e-12));
      CHECK(std::isnan(values.at("cell_min:deviation")));
      CHECK(values.at("point_sum:distance") ==
            Approx(0.5 * static_cast<double>(on_points.size())).epsilon(1e-12));
      // Verdict's own figures, of all hexes
      CHECK(values.at("scaled_jacobian_min") == Approx(report.scaled_jacobian.min).epsilon(1e-12));
      CHECK(values.at("scaled_jacobian_mean") == Approx(report.scaled_jacobian.mean).epsilon(1e-12));
    }
  }
}

TEST_CASE("VTK reads the VTM written, block by block, and it reads back as it was") {
  const bool have_vtk = have_python_module("vtk");
  for (const bool half : {false, true}) {
    CAPTURE(half);
    const HexMesh mesh = half ? sphere_shell(8, 6, 4, true) : shuffled(sphere_shell(6, 5, 4), 11);
    const ScratchFolder folder;
    const auto file = folder.path() / "a & b.vtm";
    const BlockMesh blocks = blocks_of_cells(mesh);
    const StructuredBlocks merged = merge_blocks(blocks);
    const std::vector<float> jacobians = scaled_jacobians(mesh);
    std::vector<float> on_points(mesh.points().size(), 0.5F);
    {
      AtomicFolder pieces(vtm_folder(file), "", vtm_entries(vtm_folder(file)));
      std::ofstream out(file, std::ios::binary);
      write_vtm(out, pieces, "a & b_vtm", blocks, merged,
                {{{"scaled_jacobian", jacobians, {}}}, {{"distance", on_points}}});
      pieces.commit();
    }
    const HexMesh read = read_mesh(file);
    REQUIRE(read.cell_count() == mesh.cell_count());
    CHECK(std::ranges::equal(read.points(), mesh.points()));
    const auto sorted_cells = [](const HexMesh& m) {  // turned cells are the same cells
      std::vector<HexPoints> cells(static_cast<std::size_t>(m.cell_count()));
      m.read_cells(0, cells);
      for (HexPoints& cell : cells) std::ranges::sort(cell);
      return cells;
    };
    CHECK(sorted_cells(read) == sorted_cells(mesh));
    CHECK(scaled_jacobians(read).size() == jacobians.size());
    REQUIRE(read.patches().size() == mesh.patches().size());
    for (std::size_t i = 0; i < mesh.patches().size(); ++i) {
      CHECK(read.patches()[i].name == mesh.patches()[i].name);
      CHECK(read.patches()[i].type == mesh.patches()[i].type);
      CHECK(read.patches()[i].quads.size() == mesh.patches()[i].quads.size());
    }
    if (!have_vtk) continue;
    auto values = read_with("vtk", file);
    CHECK(values.at("group:blocks") == static_cast<double>(merged.blocks.size()));
    CHECK(values.at("group:patches") == static_cast<double>(mesh.patches().size()));
    CHECK(values.at("points") == static_cast<double>(mesh.points().size()));
    CHECK(values.at("hexes") == static_cast<double>(mesh.cell_count()));
    CHECK(values.at("volume") == Approx(enclosed_volume(mesh)).epsilon(1e-12));
    CHECK(values.at("jacobian_min") == Approx(*std::ranges::min_element(jacobians)).epsilon(1e-6));
    for (std::size_t i = 0; i < mesh.patches().size(); ++i) {
      const BoundaryPatch& patch = mesh.patches()[i];
      CHECK(values.at("faces:" + patch.name) == static_cast<double>(patch.quads.size()));
      CHECK(values.at("patch:" + patch.name) == static_cast<double>(i));
    }
  }
}

TEST_CASE("Damaged VTM files are refused by name") {
  const HexMesh mesh = box_mesh({2, 2, 2});
  const ScratchFolder folder;
  const auto file = folder.path() / "a.vtm", pieces_folder = vtm_folder(file);
  const BlockMesh blocks = blocks_of_cells(mesh);
  {
    AtomicFolder pieces(pieces_folder, "", {});
    std::ofstream out(file, std::ios::binary);
    write_vtm(out, pieces, "a_vtm", blocks, merge_blocks(blocks));
    pieces.commit();
  }
  REQUIRE(read_mesh(file).cell_count() == 8);
  const std::string index = read_text(file), block = read_text(pieces_folder / "block1.vts");
  const auto refused = [&](const std::string& why) {
    CAPTURE(why);
    try {
      read_mesh(file);
      FAIL("was read");
    } catch (const Error& e) {
      CAPTURE(e.what());
      CHECK(e.kind() == ErrorKind::input);
      CHECK(std::string(e.what()).find(why) != std::string::npos);
      CHECK_FALSE(e.remedy().empty());
    }
  };
  const auto with = [&](const std::string& text, const std::string& old, const std::string& changed) {
    std::string copy = text;
    REQUIRE(copy.find(old) != std::string::npos);
    return copy.replace(copy.find(old), old.size(), changed);
  };
  const auto put = [](const std::filesystem::path& to, const std::string& text) {
    std::ofstream(to, std::ios::binary) << text;
  };
  put(file, with(index, "a_vtm/block1", "../a_vtm/block1"));
  refused("outside of its folder");
  put(file, with(index, "a_vtm/block1.vts", "a_vtm/block1.vtu"));
  refused("no .vts or .vtp");
  put(file, index.substr(0, index.size() / 2));
  refused("a.vtm");
  put(file, index);
  put(pieces_folder / "block1.vts", with(block, "\"pointId\" format", "\"other\" format"));
  refused("pointId is missing");
  put(pieces_folder / "block1.vts",
      with(block, "Extent=\"0 2 0 2 0 2\">\n<Point", "Extent=\"0 9 0 2 0 2\">\n<Point"));
  refused("does not fit");
  for (const std::size_t length : {std::size_t{0}, std::size_t{300}, block.size() / 2}) {
    put(pieces_folder / "block1.vts", block.substr(0, length));
    refused("block1.vts");
  }
}

TEST_CASE("Surfaces: VTP and STL as VTK, meshio and gmsh read them") {
  const HexMesh mesh = box_mesh({4, 3, 2}, [](const Vec3& p) { return Vec3(2 * p.x(), p.y(), p.z()); });
  Cage surface = outer_surface(mesh);
  surface.patch_names[0] = "a <\"wall\"> & more";
  const ScratchFolder folder;
  {
    const std::vector<float> deviation(surface.points.size(), 2);
    std::ofstream vtp(folder.path() / "surface.vtp", std::ios::binary);
    write_vtp(vtp, surface, {{"deviation", deviation}});
    std::ofstream stl(folder.path() / "surface.stl", std::ios::binary);
    write_stl(stl, surface);
  }
  if (have_python_module("vtk")) {
    auto values = read_with("vtk", folder.path() / "surface.vtp");
    CHECK(values.at("points") == 60);
    CHECK(values.at("polygons") == 2 * (12 + 8 + 6));
    CHECK(values.at("volume") == Approx(2).epsilon(1e-12));
    CHECK(values.at("point_sum:deviation") == 120);
    CHECK(values.at("faces:inlet") == 6);
    CHECK(values.at("patch:far") == 4);
  }
  if (have_python_module("meshio")) {
    CHECK(read_with("meshio", folder.path() / "surface.stl").at("triangles") == 4 * (12 + 8 + 6));
  }
  if (have_program("gmsh")) {
    const auto geo = folder.path() / "volume.geo";
    std::ofstream(geo) << "Merge \"surface.stl\";\nSurface Loop(1) = {1};\nVolume(1) = {1};\n"
                          "Printf(\"bounds %g %g\", General.MaxX, General.MaxY);\n";
    const PeerRun said =
        run("gmsh -3 '" + geo.string() + "' -o '" + (folder.path() / "v.msh").string() + "'");
    CAPTURE(said.output);
    CHECK(said.exit_code == 0);
    CHECK(said.output.find("Error") == std::string::npos);
    CHECK(said.output.find("bounds 2 1") != std::string::npos);  // gmsh could fill it: it is closed
  }
}

TEST_CASE("render.py draws a mesh without a display") {
  if (!have_python_module("vtk") || !have_program("xvfb-run")) return;
  const HexMesh mesh = sphere_shell(6, 5, 4, true);
  const ScratchFolder folder;
  const std::vector<float> jacobians = scaled_jacobians(mesh);
  {
    std::ofstream out(folder.path() / "mesh.vtu", std::ios::binary);
    write_vtu(out, mesh, {{{"scaled_jacobian", jacobians, {}}}, {}});
  }
  const std::string render =
      "env -u DISPLAY /usr/bin/python3 " FLOWCAGE_TEST_SOURCES "/../examples/render.py ";
  const auto picture = folder.path() / "mesh.png";
  const PeerRun drawn = run(render + (folder.path() / "mesh.vtu").string() + " " + picture.string());
  CAPTURE(drawn.output);
  CHECK(drawn.exit_code == 0);
  const std::string png = read_text(picture);
  CHECK(png.substr(1, 3) == "PNG");
  CHECK(png.size() > 20000);  // an empty picture of this size packs into less than 10 kB
  const PeerRun refused = run(render + (folder.path() / "missing.vtu").string() + " " + picture.string());
  CHECK(refused.exit_code != 0);
  CHECK(refused.output.find("is no readable VTU file") != std::string::npos);
}
