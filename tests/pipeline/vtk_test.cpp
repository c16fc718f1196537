// What VTK, meshio and gmsh read from the files written.
#include <cmath>
#include <fstream>
#include <map>
#include <sstream>

#include "core/export/write_surface.hpp"
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
