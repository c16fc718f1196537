// One run of the program in every format: each format's own reader sees the same cells, volume and patches.
#include <cstdio>
#include <map>
#include <sstream>

#include "core/export/read_mesh.hpp"
#include "core/mesh/hex_adjacency.hpp"
#include "core/quality/quality_report.hpp"
#include "tests/catch.hpp"
#include "tests/cli/sphere_folder.hpp"
#include "tests/export/peers.hpp"
#include "tests/export/sample_meshes.hpp"

using namespace flowcage;
using namespace flowcage::tests;

namespace {

const std::string foam = "WM_PROJECT_DIR=/usr/share/openfoam ";

/// What a reader sees; a volume of 0 or no faces: it does not say.
struct Seen {
  double cells = 0, volume = 0;
  std::map<std::string, double> faces;
};

/// "name value" a line; other lines are passed over.
Seen read_with(const std::string& reader, const std::filesystem::path& file) {
  const PeerRun said = run("/usr/bin/python3 " FLOWCAGE_TEST_SOURCES "/pipeline/read_vtk.py " + reader +
                           " '" + file.string() + "'");
  CAPTURE(said.output);
  REQUIRE(said.exit_code == 0);
  Seen seen;
  std::istringstream lines(said.output);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string name;
    double value = 0;
    if (!(words >> name >> value)) continue;
    if (name == "hexes") seen.cells = value;
    if (name == "volume") seen.volume = value;
    if (name.starts_with("faces:")) seen.faces[name.substr(6)] = value;
  }
  return seen;
}

Seen seen_of(const HexMesh& mesh) {
  Seen seen{static_cast<double>(mesh.cell_count()), enclosed_volume(mesh), {}};
  for (const BoundaryPatch& patch : mesh.patches()) {
    seen.faces[patch.name] = static_cast<double>(patch.quads.size());
  }
  return seen;
}

/// checkMesh's own figures, with its table of patches ("    ball    96    98    ok ...").
Seen seen_by_check_mesh(const std::filesystem::path& case_folder) {
  const CheckMesh check = check_mesh(case_folder);
  CAPTURE(check.output);
  REQUIRE(check.figures.count("Total volume") == 1);
  Seen seen{check.figures.at("cells"), check.figures.at("Total volume"), {}};
  std::istringstream lines(check.output);
  bool table = false;
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string name;
    double faces = 0;
    if (table && words >> name >> faces) seen.faces[name] = faces;
    table = line.find("Surface topology") != std::string::npos || (table && !name.empty());
  }
  return seen;
}

/// Cells and faces of the families by the ranges that `cgnscheck -v` prints; REQUIREs that it finds no fault.
Seen seen_by_cgnscheck(const std::filesystem::path& file) {
  const PeerRun said = run("cgnscheck -v '" + file.string() + "'");
  CAPTURE(said.output);
  REQUIRE(said.exit_code == 0);
  REQUIRE(said.output.find("WARNING") == std::string::npos);
  REQUIRE(said.output.find("ERROR") == std::string::npos);
  Seen seen;
  double faces = 0;
  std::istringstream lines(said.output);
  for (std::string line; std::getline(lines, line);) {
    const auto from = [&line](const char* words) {
      const auto at = line.find(words);
      return at == std::string::npos ? nullptr : line.c_str() + at;
    };
    std::array<int, 6> n{};
    if (const char* text = from("Cell Size=[")) {
      const int read = std::sscanf(text, "Cell Size=[%d,%d,%d]", &n[0], &n[1], &n[2]);
      seen.cells += read == 3 ? double(n[0]) * n[1] * n[2] : n[0];
    } else if (const char* range = from("Range=[")) {
      const int read =
          std::sscanf(range, "Range=[%d:%d,%d:%d,%d:%d]", &n[0], &n[1], &n[2], &n[3], &n[4], &n[5]);
      faces = read == 2 ? n[1] - n[0] + 1 : 1;
      for (int d = 0; d < 6 && read == 6; d += 2) faces *= n[d] == n[d + 1] ? 1 : n[d + 1] - n[d];
    } else if (const char* family = from("Family=\"")) {
      const std::string name(family + 8);
      seen.faces[name.substr(0, name.find('"'))] += faces;
    }
  }
  return seen;
}

/// Faces of the patches by the ranges of a neutral map file.
std::map<std::string, double> faces_of_map(const std::string& text) {
  std::map<std::string, double> faces;
  std::istringstream lines(text);
  std::string patch;
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string type, word;
    words >> type;
    if (type == "#") {
      if (words >> word && word == "patch") words >> patch;
      continue;
    }
    int block = 0, face = 0, s1 = 0, e1 = 0, s2 = 0, e2 = 0;
    if (type == "ONE-TO-ONE" || !(words >> block >> face >> s1 >> e1 >> s2 >> e2)) continue;
    if (!patch.empty()) faces[patch] += double(e1 - s1) * (e2 - s2);
  }
  return faces;
}

}  // namespace

TEST_CASE("one run, all formats: cells, volume, patches and faces agree in every reader") {
  const SphereFolder folder("sphere.step", "left wing");
  std::string cage = folder.text_of("cage.obj");
  cage.replace(cage.find("f 5 6 8 7"), 9, "g plain\nf 5 6 8 7");  // one face and five: patches differ
  folder.put("cage.obj", cage);
  const ProgramRun made = folder.run(
      "mesh", {"--levels", "2",    "--tolerance", "1e-3", "--farfield-size", "2",  "-o",    "case", "-o",
               "m.vtu",    "-o",   "m.vtm",       "-o",   "m.cgns",          "-o", "m.msh", "-o",   "m.su2",
               "-o",       "m.xyz"});
  INFO(made.err);
  REQUIRE(made.exit_code == 0);
  const auto at = [&](const char* name) { return folder.path() / name; };
  REQUIRE(run_flowcage({"convert", "m.vtu", "--unstructured", "-o", "one.cgns"}, {.folder = folder.path()})
              .exit_code == 0);

  const HexMesh mesh = read_mesh(at("case"));
  const Seen wanted = seen_of(mesh);
  const QualityReport quality = measure_quality(mesh, build_hex_adjacency(mesh));
  REQUIRE(wanted.faces.size() == 3);
  CHECK(wanted.faces.at("left_wing") * 5 == wanted.faces.at("plain"));
  int readers = 0;
  // OpenFOAM sums pyramids to the faces' centroids, everyone else here cuts faces at the mean of their
  // corners.
  const auto agree = [&](const std::string& reader, const Seen& seen, double volume) {
    CAPTURE(reader);
    CHECK(seen.cells == wanted.cells);
    if (seen.volume != 0) CHECK(seen.volume == Approx(volume).epsilon(1e-9));
    if (!seen.faces.empty()) CHECK(seen.faces == wanted.faces);
    ++readers;
  };
  for (const char* name : {"m.vtu", "m.vtm", "m.cgns", "m.msh", "m.su2", "one.cgns"}) {
    agree(std::string("flowcage ") + name, seen_of(read_mesh(at(name))), wanted.volume);
  }
  CHECK(faces_of_map(folder.text_of("m.nmf")) == wanted.faces);
  if (have_program("checkMesh")) agree("checkMesh", seen_by_check_mesh(at("case")), quality.total_volume);
  if (have_program("cgnscheck")) {
    for (const char* name : {"m.cgns", "one.cgns"}) {
      agree(std::string("cgnscheck ") + name, seen_by_cgnscheck(at(name)), 0);
    }
  }
  if (have_program("gmsh")) {
    const PeerRun said =
        run("gmsh '" + at("m.msh").string() + "' -save -format msh41 -o '" + at("gmsh.msh").string() + "'");
    CAPTURE(said.output);
    REQUIRE(said.exit_code == 0);
    agree("gmsh", seen_of(read_mesh(at("gmsh.msh"))), wanted.volume);
  }
  if (have_python_module("vtk")) {
    for (const char* name : {"m.vtu", "m.vtm", "m.cgns", "one.cgns"}) {
      const Seen seen = read_with("vtk", at(name));
      CHECK(seen.volume > 0);
      agree(std::string("VTK ") + name, seen, wanted.volume);
    }
  }
  if (have_python_module("meshio")) {
    for (const char* name : {"m.vtu", "m.msh", "m.su2"}) {
      Seen seen = read_with("meshio", at(name));
      if (name == std::string("m.su2")) {  // meshio numbers SU2's markers in their order
        std::map<std::string, double> named;
        for (std::size_t i = 0; i < mesh.patches().size(); ++i) {
          named[mesh.patches()[i].name] = seen.faces["number" + std::to_string(i + 1)];
        }
        seen.faces = named;
      }
      CHECK(seen.volume > 0);
      agree(std::string("meshio ") + name, seen, wanted.volume);
    }
  }
  if (have_program("plot3dToFoam")) {
    const std::string grid = at("plot3d").string();
    std::filesystem::create_directory(grid);
    std::filesystem::copy(at("case") / "system", at("plot3d") / "system",
                          std::filesystem::copy_options::recursive);
    const PeerRun said =
        run(foam + "plot3dToFoam -noBlank -case '" + grid + "' '" + at("m.xyz").string() + "'");
    CAPTURE(said.output);
    REQUIRE(said.exit_code == 0);
    Seen seen = seen_by_check_mesh(grid);
    double faces = 0;
    for (const auto& [name, count] : seen.faces) faces += count;
    CHECK(faces == static_cast<double>(quality.boundary_faces));
    seen.faces.clear();  // it makes one patch of all
    agree("plot3dToFoam", seen, quality.total_volume);
  }
  if (have_program("gmshToFoam")) {
    const std::string case_folder = at("from_gmsh").string();
    std::filesystem::create_directory(case_folder);
    std::filesystem::copy(at("case") / "system", at("from_gmsh") / "system",
                          std::filesystem::copy_options::recursive);
    run(foam + "gmshToFoam -case '" + case_folder + "' '" + at("m.msh").string() + "'");
    agree("gmshToFoam", seen_by_check_mesh(case_folder), quality.total_volume);
  }
  INFO("readers that agree: " << readers);
  CHECK(readers >= 6);
}
