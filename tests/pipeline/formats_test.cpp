// One mesh in every format, as each format's own programs read it.
#include <fstream>
#include <map>
#include <sstream>

#include "core/export/cgns_file.hpp"
#include "core/export/read_mesh.hpp"
#include "core/export/write_cgns.hpp"
#include "core/export/write_gmsh.hpp"
#include "core/export/write_plot3d.hpp"
#include "core/export/write_polymesh.hpp"
#include "core/export/write_su2.hpp"
#include "tests/catch.hpp"
#include "tests/export/peers.hpp"
#include "tests/export/sample_meshes.hpp"

using namespace flowcage;
using namespace flowcage::tests;
namespace fs = std::filesystem;

namespace {

const std::string foam = "WM_PROJECT_DIR=/usr/share/openfoam ";

/// Cells, volume and the patches by name with their numbers of faces are those of `mesh`. Gmsh and OpenFOAM
/// write about 16 and 12 digits.
void check_same_mesh(const HexView& read, const HexView& mesh) {
  CHECK(read.cell_count() == mesh.cell_count());
  CHECK(read.points().size() == mesh.points().size());
  CHECK(enclosed_volume(read) == Approx(enclosed_volume(mesh)).epsilon(1e-9));
  REQUIRE(read.patches().size() == mesh.patches().size());
  for (const BoundaryPatch& patch : mesh.patches()) {
    std::string name = patch.name;
    std::replace(name.begin(), name.end(), ' ', '_');
    CAPTURE(name);
    const auto same = std::find_if(read.patches().begin(), read.patches().end(),
                                   [&](const BoundaryPatch& p) { return p.name == name; });
    REQUIRE(same != read.patches().end());
    CHECK(same->quads.size() == patch.quads.size());
  }
}

void run_quietly(const std::string& command) {
  const PeerRun said = run(command);
  CAPTURE(command, said.output);
  REQUIRE(said.exit_code == 0);
  CHECK(said.output.find("Error") == std::string::npos);
  CHECK(said.output.find("Warning") == std::string::npos);
}

struct Sample {
  const char* name;
  HexMesh mesh;
};

std::vector<Sample> samples() {
  std::vector<Sample> all;
  all.push_back({"box", perturbed_box({5, 4, 3}, 0.04)});
  all.push_back({"half sphere", sphere_shell(6, 4, 4, true)});
  all.push_back({"shuffled sphere", shuffled(sphere_shell(4, 3, 4), 11)});
  return all;
}

}  // namespace

TEST_CASE("Gmsh, gmshToFoam and meshio read the .msh and .su2 written") {
  const bool have_gmsh = have_program("gmsh"), have_foam = have_program("gmshToFoam");
  const bool have_meshio = have_python_module("meshio");
  for (const auto& [name, mesh] : samples()) {
    CAPTURE(name);
    const ScratchFolder folder;
    const fs::path msh = folder.path() / "a.msh", su2 = folder.path() / "a.su2";
    {
      std::ofstream gmsh_file(msh), su2_file(su2);
      const auto notes = write_gmsh(gmsh_file, mesh);
      CHECK(notes == write_su2(su2_file, mesh));
      CHECK(notes.size() == (std::string(name) == "box" ? 1 : 0));  // "symmetry plane"
    }
    check_same_mesh(read_mesh(msh), mesh);
    check_same_mesh(read_mesh(su2), mesh);
    const HexMesh from_su2 = read_mesh(su2);
    CHECK(std::equal(mesh.points().begin(), mesh.points().end(), from_su2.points().begin()));
    if (have_gmsh) {
      for (const char* format : {"msh22", "msh41"}) {
        CAPTURE(format);
        const fs::path out = folder.path() / (std::string(format) + ".msh");
        run_quietly("gmsh '" + msh.string() + "' -save -format " + format + " -o '" + out.string() + "'");
        check_same_mesh(read_mesh(out), mesh);
      }
    }
    if (have_foam) {
      const fs::path case_folder = folder.path() / "case";
      fs::create_directory(case_folder);
      write_case_files(case_folder, "case.foam");
      run(foam + "gmshToFoam -case '" + case_folder.string() + "' '" + msh.string() + "'");
      check_same_mesh(read_mesh(case_folder), mesh);
    }
    if (have_meshio) {
      const PeerRun said =
          run("/usr/bin/python3 -c 'import meshio,sys\n"
              "for f in sys.argv[1:]:\n"
              "  m = meshio.read(f)\n"
              "  print(sum(len(c.data) for c in m.cells if c.type == \"hexahedron\"),"
              " sum(len(c.data) for c in m.cells if c.type == \"quad\"))' '" +
              msh.string() + "' '" + su2.string() + "'");
      std::size_t quads = 0;
      for (const BoundaryPatch& patch : mesh.patches()) quads += patch.quads.size();
      const std::string line = std::to_string(mesh.cell_count()) + " " + std::to_string(quads) + "\n";
      CAPTURE(said.output);
      CHECK(said.output.find(line) != said.output.rfind(line));
    }
  }
}

TEST_CASE("Blocks are merged as far as they fit, and the mesh stays") {
  for (const auto& [name, mesh] : samples()) {
    CAPTURE(name);
    const BlockMesh cells = blocks_of_cells(mesh);
    const StructuredBlocks merged = merge_blocks(cells);
    Offset total = 0;
    for (const StructuredBlock& block : merged.blocks) {
      const auto [ni, nj, nk] = block.cells();
      total += Offset{ni} * nj * nk;
      const auto corner = [&](Index i, Index j, Index k) {
        return mesh.points()[point_number(cells, block, {i, j, k})];
      };
      const Vec3 origin = corner(0, 0, 0);
      CHECK((corner(1, 0, 0) - origin).cross(corner(0, 1, 0) - origin).dot(corner(0, 0, 1) - origin) > 0);
    }
    CHECK(total == mesh.cell_count());
    // A box is one block. Round a sphere: a ring of four sides, and a block at each end. Round half of it a
    // strip over the top is as large as the ring and comes first; it leaves a block at each side.
    if (std::string(name) == "box") CHECK(merged.blocks.size() == 1);
    if (std::string(name) == "half sphere") CHECK(merged.blocks.size() == 3);
    if (std::string(name) == "shuffled sphere") CHECK(merged.blocks.size() == 3);
    std::vector<std::size_t> faces(mesh.patches().size(), 0);
    for (const BlockWindow& window : merged.windows) {
      const int d = window.face / 2;
      CHECK(window.low[d] == window.high[d]);
      std::size_t count = 1;
      for (int e = 0; e < 3; ++e) count *= e == d ? 1 : window.high[e] - window.low[e];
      if (window.patch != no_index) faces[window.patch] += count;
      if (window.donor == no_index) continue;
      // Both ends of the window are the same points as the donor's.
      CHECK(point_number(cells, merged.blocks[window.block], window.low) ==
            point_number(cells, merged.blocks[window.donor], window.donor_low));
      CHECK(point_number(cells, merged.blocks[window.block], window.high) ==
            point_number(cells, merged.blocks[window.donor], window.donor_high));
    }
    for (std::size_t i = 0; i < faces.size(); ++i) CHECK(faces[i] == mesh.patches()[i].quads.size());
  }
}

TEST_CASE("cgnscheck has nothing to say of the CGNS files, and they read back as they were") {
  const bool have_cgnscheck = have_program("cgnscheck");
  for (const auto& [name, mesh] : samples()) {
    CAPTURE(name);
    const ScratchFolder folder;
    const fs::path structured = folder.path() / "structured.cgns", unstructured = folder.path() / "one.cgns";
    const BlockMesh cells = blocks_of_cells(mesh);
    write_cgns(structured, cells, merge_blocks(cells));
    write_cgns_unstructured(unstructured, mesh);
    for (const fs::path& file : {structured, unstructured}) {
      CAPTURE(file);
      const HexMesh read = read_mesh(file);
      check_same_mesh(read, mesh);
      for (std::size_t i = 0; i < mesh.patches().size(); ++i) {
        CHECK(read.patches()[i].type == mesh.patches()[i].type);
      }
      if (!have_cgnscheck) continue;
      const PeerRun said = run("cgnscheck '" + file.string() + "'");
      CAPTURE(said.output);
      CHECK(said.exit_code == 0);
      CHECK(said.output.find("WARNING") == std::string::npos);
      CHECK(said.output.find("ERROR") == std::string::npos);
      CHECK(said.output.find("checking") != std::string::npos);
    }
    const std::string text = read_text(unstructured);
    for (const std::size_t length : {std::size_t{0}, std::size_t{100}, text.size() / 2}) {
      std::ofstream(folder.path() / "cut.cgns", std::ios::binary) << text.substr(0, length);
      try {
        read_mesh(folder.path() / "cut.cgns");
        FAIL("was read");
      } catch (const Error& e) {
        CHECK(e.kind() == ErrorKind::input);
        CHECK(std::string(e.what()).starts_with((folder.path() / "cut.cgns").string()));
      }
    }
  }
}

TEST_CASE("MIXED sections of CGNS are read; what is no hex or quad in them is refused") {
  const HexMesh mesh = perturbed_box({3, 2, 2}, 0.04);
  std::vector<HexPoints> cells(static_cast<std::size_t>(mesh.cell_count()));
  mesh.read_cells(0, cells);
  const auto write = [&](const fs::path& path, ElementType_t first_type) {
    std::vector<cgsize_t> data, offsets{0};
    const auto put = [&](ElementType_t type, const auto& points) {
      data.push_back(type);
      for (const Index p : points) data.push_back(p + 1);
      offsets.push_back(static_cast<cgsize_t>(data.size()));
    };
    put(first_type, std::vector<Index>(cells[0].begin(), cells[0].begin() + (first_type == TETRA_4 ? 4 : 2)));
    for (const HexPoints& cell : cells) put(HEXA_8, cell);
    for (const BoundaryPatch& patch : mesh.patches()) {
      for (const auto& quad : patch.quads) put(QUAD_4, quad);
    }
    CgnsFile file(path, CgnsFile::Use::write, "test");
    const int fn = file.number();
    int base = 0, zone = 0, number = 0;
    file.check(cg_base_write(fn, "base", 3, 3, &base));
    const auto points = static_cast<cgsize_t>(mesh.points().size());
    const std::array<cgsize_t, 3> size{points, static_cast<cgsize_t>(cells.size()), 0};
    file.check(cg_zone_write(fn, base, "zone", size.data(), Unstructured, &zone));
    int d = 0;
    for (const char* name : {"CoordinateX", "CoordinateY", "CoordinateZ"}) {
      std::vector<double> values;
      for (const Vec3& p : mesh.points()) values.push_back(p[d]);
      file.check(cg_coord_write(fn, base, zone, RealDouble, name, values.data(), &number));
      ++d;
    }
    file.check(cg_poly_section_write(fn, base, zone, "all", MIXED, 1,
                                     static_cast<cgsize_t>(offsets.size()) - 1, 0, data.data(),
                                     offsets.data(), &number));
    // Conditions name quads by their numbers in the section, behind the line and the hexes.
    auto next = static_cast<cgsize_t>(2 + cells.size());
    for (const BoundaryPatch& patch : mesh.patches()) {
      const std::array<cgsize_t, 2> range{next, next + static_cast<cgsize_t>(patch.quads.size()) - 1};
      std::string name = patch.name;
      std::replace(name.begin(), name.end(), ' ', '_');
      file.check(cg_boco_write(fn, base, zone, name.c_str(), BCWall, PointRange, 2, range.data(), &number));
      file.check(cg_boco_gridlocation_write(fn, base, zone, number, FaceCenter));
      next = range[1] + 1;
    }
    file.close();
  };
  const ScratchFolder folder;
  write(folder.path() / "mixed.cgns", BAR_2);
  check_same_mesh(read_mesh(folder.path() / "mixed.cgns"), mesh);
  write(folder.path() / "tetra.cgns", TETRA_4);
  CHECK_THROWS_WITH(read_mesh(folder.path() / "tetra.cgns"), contains_text("of type TETRA_4"));
}

TEST_CASE("plot3dToFoam reads the Plot3D grid; its neutral map covers every outer face once") {
  const bool have_foam = have_program("plot3dToFoam");
  for (const auto& [name, mesh] : samples()) {
    CAPTURE(name);
    const ScratchFolder folder;
    const BlockMesh cells = blocks_of_cells(mesh);
    const StructuredBlocks merged = merge_blocks(cells);
    std::stringstream map;
    {
      std::ofstream grid(folder.path() / "a.xyz");
      write_plot3d(grid, cells, merged);
      write_neutral_map(map, cells, merged);
    }
    if (have_foam) {
      write_case_files(folder.path(), "case.foam");
      const PeerRun said = run(foam + "plot3dToFoam -noBlank -case '" + folder.path().string() + "' '" +
                               (folder.path() / "a.xyz").string() + "'");
      CAPTURE(said.output);
      const HexMesh read = read_mesh(folder.path());
      CHECK(read.cell_count() == mesh.cell_count());
      CHECK(read.points().size() == mesh.points().size());
      CHECK(enclosed_volume(read) == Approx(enclosed_volume(mesh)).epsilon(1e-9));
    }
    // The ranges of the map, read as a solver reads them.
    std::string line, patch;
    std::size_t outer = 0;
    std::map<std::string, std::size_t> faces;
    while (std::getline(map, line)) {
      std::istringstream words(line);
      std::string type;
      words >> type;
      if (type == "#") {
        words >> type >> patch;
      } else if (type == "WALL" || type == "FARFIELD" || type == "SYMMETRY" || type == "INFLOW" ||
                 type == "OUTFLOW") {
        std::size_t block = 0, face = 0, s1 = 0, e1 = 0, s2 = 0, e2 = 0;
        REQUIRE(words >> block >> face >> s1 >> e1 >> s2 >> e2);
        const auto size = merged.blocks.at(block - 1).cells();
        const std::array<int, 3> flat{2, 0, 1};
        const int d = flat[(face - 1) / 2];
        CHECK(e1 <= static_cast<std::size_t>(size[(d + 1) % 3]) + 1);
        CHECK(e2 <= static_cast<std::size_t>(size[(d + 2) % 3]) + 1);
        faces[patch] += (e1 - s1) * (e2 - s2);
        outer += (e1 - s1) * (e2 - s2);
      }
    }
    std::size_t quads = 0;
    for (const BoundaryPatch& p : mesh.patches()) quads += p.quads.size();
    CHECK(outer == quads);
    CHECK(faces[mesh.patches()[0].name] == mesh.patches()[0].quads.size());
  }
}

TEST_CASE("Damaged .msh and .su2 files are refused by name, never more") {
  const HexMesh mesh = box_mesh({2, 2, 2});
  const ScratchFolder folder;
  const auto write = [&](const fs::path& file, const std::string& text) {
    fs::remove(file);
    std::ofstream(file) << text;
  };
  const auto refused = [&](const fs::path& file, const std::string& text, const std::string& why) {
    write(file, text);
    CAPTURE(text);
    try {
      read_mesh(file);
      FAIL("was read");
    } catch (const Error& e) {
      CHECK(e.kind() == ErrorKind::input);
      CHECK(std::string(e.what()).starts_with(file.string()));
      CHECK(std::string(e.what()).find(why) != std::string::npos);
      CHECK_FALSE(e.remedy().empty());
    }
  };
  const fs::path msh = folder.path() / "a.msh", su2 = folder.path() / "a.su2";
  for (const fs::path& file : {msh, su2}) {
    std::ostringstream out;
    file == msh ? write_gmsh(out, mesh) : write_su2(out, mesh);
    const std::string text = out.str();
    // Cut anywhere, to the last word: refused.
    for (std::size_t length = 0; length + 18 < text.size(); length += 37) {
      refused(file, text.substr(0, length), "");
    }
  }
  const std::string head = "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n";
  refused(msh, "hello", "a section");
  refused(msh, "$MeshFormat\n4.1 1 8\n", "binary");
  refused(msh, "$MeshFormat\n4 0 8\n", "version is 4");
  refused(msh, head + "$Nodes\n1 2000000000 1 2000000000\n3 1 0 2000000000\n1\n", "but only");
  refused(msh, head + "$Elements\n1 1 1 1\n3 1 4 1\n1 1 2 3 4\n$EndElements\n", "tetrahedron");
  refused(msh, head + "$Elements\n1 1 1 1\n3 1 5 1\n1 1 2 3 4 5 6 7 8\n$EndElements\n", "no node 1");
  refused(msh, head, "holds no hexes");
  refused(su2, "NDIME= 2\n", "not three-dimensional");
  refused(su2, "NDIME=3\nNELEM=1\n10 0 1 2 3\n", "is no hex (VTK type 10)");
  refused(su2, "NDIME= 3\nNELEM= 1999999999\n12 0 1\n", "but only");
  refused(su2, "NDIME= 3\nNELEM= 1\n12 0 1 2 3 4 5 6 9\nNPOIN= 1\n0 0 0 0\nNMARK= 0\n",
          "but there are 1 points");
  refused(su2, "NDIME= 3\nNPOIN= 1\n0 0 nan 0\n", "not finite");
}
