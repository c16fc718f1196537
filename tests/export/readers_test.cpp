#include <fstream>
#include <functional>
#include <random>
#include <sstream>

#include "core/base/error.hpp"
#include "core/base/parallel.hpp"
#include "core/export/hex_from_faces.hpp"
#include "core/export/patch_names.hpp"
#include "core/export/read_block_dict.hpp"
#include "core/export/read_mesh.hpp"
#include "core/export/write_polymesh.hpp"
#include "core/export/write_vtu.hpp"
#include "core/mesh/visit_cells.hpp"
#include "core/quality/quality_report.hpp"
#include "tests/catch.hpp"
#include "tests/export/peers.hpp"
#include "tests/export/sample_meshes.hpp"

using namespace flowcage;
using namespace flowcage::tests;

namespace {

std::filesystem::path write_foam(const ScratchFolder& folder, const HexMesh& mesh, bool binary) {
  PolyMeshSettings settings;
  settings.binary = binary;
  settings.block_zones = true;
  write_openfoam_case(folder.path(), mesh, build_hex_adjacency(mesh), settings);
  return folder.path() / "constant/polyMesh";
}

std::string vtu_text(const HexMesh& mesh) {
  std::ostringstream out;
  write_vtu(out, mesh);
  return out.str();
}

void write_text(const std::filesystem::path& file, const std::string& text) {
  std::filesystem::remove(
      file);  // some file systems bring a file that is truncated to the disk, which is slow
  std::ofstream(file, std::ios::binary) << text;
}

std::string replaced(std::string text, const std::string& old, const std::string& fresh) {
  const auto at = text.find(old);
  REQUIRE(at != std::string::npos);
  return text.replace(at, old.size(), fresh);
}

void check_same(const HexMesh& a, const HexMesh& b) {
  REQUIRE(a.cell_count() == b.cell_count());
  CHECK(std::equal(a.points().begin(), a.points().end(), b.points().begin(), b.points().end()));
  const QualityReport qa = measure_quality(a, build_hex_adjacency(a));
  const QualityReport qb = measure_quality(b, build_hex_adjacency(b));
  CHECK(qa.scaled_jacobian.min == Approx(qb.scaled_jacobian.min).epsilon(1e-13));
  CHECK(qa.non_orthogonality.max == Approx(qb.non_orthogonality.max).epsilon(1e-10).margin(3e-6));
  CHECK(qa.total_volume == Approx(qb.total_volume).epsilon(1e-14));
  REQUIRE(a.patches().size() == b.patches().size());
  for (std::size_t i = 0; i < a.patches().size(); ++i) {
    CHECK(a.patches()[i].type == b.patches()[i].type);
    CHECK(a.patches()[i].owner == b.patches()[i].owner);
  }
}

// Changes bytes of a text: flips, cuts, doubles, and swaps digits, as a fuzzer does.
std::string mutated(std::string text, std::mt19937& random) {
  const int changes = 1 + static_cast<int>(random() % 3);
  for (int i = 0; i < changes && !text.empty(); ++i) {
    // Mostly near the beginning, where headers and sizes are.
    const std::size_t reach = random() % 3 == 0 ? text.size() : std::min<std::size_t>(text.size(), 1500);
    const std::size_t at = random() % reach, length = 1 + random() % 20;
    switch (random() % 7) {
      case 0:
        text[at] = static_cast<char>(random());
        break;
      case 1:
        text.erase(at, length);
        break;
      case 2:
        text.insert(at, text.substr(random() % text.size(), length));
        break;
      case 3:
        text.resize(at);
        break;
      case 4: {
        const auto digit = text.find_first_of("0123456789", at);
        if (digit != std::string::npos) text[digit] = static_cast<char>('0' + random() % 10);
        break;
      }
      case 5: {
        const auto digit = text.find_first_of("0123456789", at);
        if (digit != std::string::npos) text.insert(digit, "99999999999999999999", random() % 20);
        break;
      }
      default: {
        const char* const special = "(){};<>/\"= _-\n";
        text.insert(at, 1, special[random() % 14]);
      }
    }
  }
  return text;
}

}  // namespace

TEST_CASE("A polyMesh reads back as it was, ASCII and binary the same") {
  const std::vector<HexMesh> meshes{box_mesh({1, 1, 1}), perturbed_box({4, 3, 5}, 0.03),
                                    sphere_shell(6, 4, 3, true), shuffled(sphere_shell(4, 3, 3), 1)};
  for (const HexMesh& mesh : meshes) {
    const ScratchFolder ascii, binary;
    const HexMesh a = read_polymesh(write_foam(ascii, mesh, false));
    const HexMesh b = read_mesh(write_foam(binary, mesh, true).parent_path().parent_path() / "case.foam");
    check_same(a, mesh);
    check_same(b, mesh);
    for (std::size_t i = 0; i < mesh.patches().size(); ++i) {
      CHECK(a.patches()[i].quads == mesh.patches()[i].quads);
      CHECK(b.patches()[i].quads == mesh.patches()[i].quads);
    }
  }
}

TEST_CASE("A VTU reads back as it was") {
  const ScratchFolder folder;
  const auto file = folder.path() / "mesh.vtu";
  const HexMesh mesh = shuffled(sphere_shell(6, 4, 3, true), 2);
  write_text(file, vtu_text(mesh));
  const HexMesh read = read_mesh(file);
  check_same(read, mesh);
  for (std::size_t i = 0; i < mesh.patches().size(); ++i) {
    CHECK(read.patches()[i].name == mesh.patches()[i].name);
  }
}

TEST_CASE("The bytes written do not depend on the number of threads") {
  const HexMesh mesh = perturbed_box({40, 30, 30}, 0.005);
  const auto bytes = [&](int threads) {
    set_thread_count(threads);
    std::string all = vtu_text(mesh);
    for (const bool binary : {true, false}) {
      const ScratchFolder folder;
      const auto poly_mesh = write_foam(folder, mesh, binary);
      for (const char* name : {"points", "faces", "owner", "neighbour", "boundary", "cellZones"}) {
        all += read_text(poly_mesh / name);
      }
    }
    set_thread_count(0);
    return all;
  };
  const std::string one = bytes(1);
  CHECK((one == bytes(2)));
  CHECK((one == bytes(7)));
}

TEST_CASE("A hex is found from its faces in any order and rotation") {
  std::mt19937 random(3);
  for (int round = 0; round < 200; ++round) {
    HexPoints cell{};
    for (int i = 0; i < 8; ++i) cell[i] = static_cast<Index>(i);
    std::shuffle(cell.begin(), cell.end(), random);
    std::array<std::array<Index, 4>, 6> faces;
    for (int f = 0; f < 6; ++f) {
      faces[f] = face_points(cell, f);
      std::rotate(faces[f].begin(), faces[f].begin() + random() % 4, faces[f].end());
    }
    std::shuffle(faces.begin(), faces.end(), random);
    const auto hex = hex_from_faces(faces);
    REQUIRE(hex);
    // The same outward faces, up to rotation: then the same oriented hex.
    for (int f = 0; f < 6; ++f) {
      const auto face = face_points(*hex, f);
      CHECK(std::any_of(faces.begin(), faces.end(), [&](auto given) {
        for (int i = 0; i < 4; ++i) {
          std::rotate(given.begin(), given.begin() + 1, given.end());
          if (given == face) return true;
        }
        return false;
      }));
    }
    auto flipped = faces;
    std::reverse(flipped[2].begin(), flipped[2].end());
    CHECK_FALSE(hex_from_faces(flipped));
    auto doubled = faces;
    doubled[random() % 6] = doubled[random() % 6];
    CHECK((doubled == faces || !hex_from_faces(doubled)));
  }
}

TEST_CASE("Patch names are legal in every format, unique, and stay where they can") {
  const auto result = legal_patch_names({"upper wing", "upper_wing", "2nd", "", "wall", "wall",
                                         std::string(50, 'x'), std::string(51, 'x'), "Flügel"});
  const std::vector<std::string> expected{
      "upper_wing_2", "upper_wing", "patch_2nd",          "patch",
      "wall",         "wall_2",     std::string(32, 'x'), std::string(30, 'x') + "_2",
      "Fl__gel"};
  CHECK(result.names == expected);
  CHECK(result.notes.size() == 7);
}

TEST_CASE("What is wrong with a polyMesh is said with file and place") {
  const ScratchFolder folder;
  const HexMesh mesh = box_mesh({2, 2, 2});
  const auto poly_mesh = write_foam(folder, mesh, false);
  const auto broken = [&](const char* file, const std::string& old, const std::string& fresh) {
    const std::string text = read_text(poly_mesh / file);
    write_text(poly_mesh / file, replaced(text, old, fresh));
    std::string said;
    try {
      read_polymesh(folder.path());
      said = "read";
    } catch (const Error& e) {
      said = e.what();
      CHECK(e.kind() == ErrorKind::input);
      CHECK_FALSE(e.remedy().empty());
    }
    write_text(poly_mesh / file, text);
    return said;
  };
  using Catch::Contains;
  CHECK_THAT(broken("points", "27\n(", "27000000000\n("),
             Contains("points:") && Contains("claims 27000000000"));
  CHECK_THAT(broken("points", "(0.5 0 0)", "(0.5 nan 0)"),
             Contains("points:13") && Contains("finite number"));
  CHECK_THAT(broken("points", "(0.5 0 0)", "(0.5 0)"), Contains("points:13"));
  CHECK_THAT(broken("faces", "4(", "3("), Contains("faces:"));
  CHECK_THAT(broken("faces", "4(1 4 13 10)", "3(1 4 13)"), Contains("has 3 points: not a hex mesh"));
  CHECK_THAT(broken("faces", "4(1 4 13 10)", "4(1 4 13 100)"), Contains("uses point 100"));
  CHECK_THAT(broken("faces", "4(1 4 13 10)", "4(10 13 4 1)"), Contains("do not close to a hex"));
  CHECK_THAT(broken("owner", "36\n(\n0", "36\n(\n7"), Contains("six faces") || Contains("not close"));
  CHECK_THAT(broken("owner", "36\n(\n0", "36\n(\n2000000000"), Contains("is of cell 2000000000"));
  CHECK_THAT(broken("boundary", "nFaces          4", "nFaces          5"), Contains("boundary:"));
  CHECK_THAT(broken("boundary", "wall\n", "processor0\n"), Contains("read"));
  CHECK_THAT(broken("boundary", "type            wall", "type            processor"), Contains("decomposed"));
  CHECK_THAT(broken("points", "FoamFile", "FoamFil"), Contains("FoamFile header"));
  CHECK_THAT(broken("points", "ascii", "coded"), Contains("neither ascii nor binary"));
  std::filesystem::rename(poly_mesh / "owner", poly_mesh / "owner.gz");
  CHECK_THROWS_WITH(read_polymesh(folder.path()), Contains("owner.gz: is compressed"));
  CHECK_THROWS_WITH(read_polymesh(folder.path() / "system"), Contains("holds no OpenFOAM mesh"));
  CHECK_THROWS_WITH(read_mesh(folder.path() / "missing.vtu"), Contains("no such file"));
  CHECK_THROWS_WITH(read_mesh(folder.path() / "system/controlDict"), Contains("no mesh format"));
}

TEST_CASE("What is wrong with a VTU is said with file and place") {
  const ScratchFolder folder;
  const auto file = folder.path() / "mesh.vtu";
  const std::string text = vtu_text(box_mesh({2, 2, 2}));
  const auto broken = [&](const std::string& old, const std::string& fresh) {
    write_text(file, replaced(text, old, fresh));
    std::string said = "read";
    try {
      read_vtu(file);
    } catch (const Error& e) {
      said = e.what();
      CHECK(e.kind() == ErrorKind::input);
      CHECK(said.starts_with(file.string()));
    }
    return said;
  };
  using Catch::Contains;
  CHECK_THAT(broken("NumberOfPoints=\"27\"", "NumberOfPoints=\"2700000000000\""), Contains("mesh.vtu:"));
  CHECK_THAT(broken("UnstructuredGrid\"", "ImageData\""), Contains("holds a ImageData"));
  CHECK_THAT(broken("LittleEndian", "BigEndian"), Contains("big-endian"));
  CHECK_THAT(broken("</Cells>", "</Cell>"), Contains("closes nothing"));
  CHECK_THAT(broken("Name=\"offsets\"", "Name=\"ends\""), Contains("Cells/offsets is missing"));
  CHECK_THAT(broken("offset=\"0\"", "offset=\"100000000\""), Contains("outside of the file's"));
  CHECK_THAT(broken("header_type=\"UInt64\"", "header_type=\"UInt64\" compressor=\"vtkLZ4DataCompressor\""),
             Contains("vtkLZ4DataCompressor"));
  CHECK_THAT(broken("VTKFile", "html"), Contains("is no VTK XML file") || Contains("closes nothing"));
  write_text(file, text.substr(0, text.size() - 200));
  CHECK_THROWS_WITH(read_vtu(file), Contains("cut off") || Contains("claims"));
  write_text(file, "ISO-10303-21;\n");
  CHECK_THROWS_WITH(read_vtu(file), Contains("is no VTK XML file"));
  write_text(file, "");
  CHECK_THROWS_WITH(read_vtu(file), Contains("is no VTK XML file"));
}

TEST_CASE("Outer faces without a quad become a patch; foreign orientations are turned") {
  const ScratchFolder folder;
  const auto file = folder.path() / "mesh.vtu";
  const HexMesh mesh = box_mesh({3, 2, 2});
  auto patches = mesh.patches();
  patches.resize(1);
  for (auto& quad : patches[0].quads) std::reverse(quad.begin(), quad.end());
  std::vector<HexPoints> cells(12);
  mesh.read_cells(0, cells);
  write_text(file, vtu_text({{mesh.points().begin(), mesh.points().end()}, cells, patches}));
  const HexMesh read = read_vtu(file);
  REQUIRE(read.patches().size() == 2);
  CHECK(read.patches()[0].name == "wall");
  CHECK(read.patches()[1].name == "unassigned");
  CHECK(read.patches()[1].quads.size() == 32 - 4);
  CHECK(enclosed_volume(read) == Approx(1).epsilon(1e-14));
}

TEST_CASE("Mutated files are read or refused, never worse") {
  const HexMesh mesh = box_mesh({2, 2, 1});
  std::mt19937 random(20240607);
  int read = 0, refused = 0;
  const auto attempt = [&](const std::filesystem::path& path) {
    try {
      read_mesh(path);
      ++read;
    } catch (const Error& e) {
      if (e.kind() != ErrorKind::input) FAIL(e.what());
      ++refused;
    }
  };
  for (const bool binary : {false, true}) {
    const ScratchFolder folder;
    const auto poly_mesh = write_foam(folder, mesh, binary);
    for (const char* name : {"points", "faces", "owner", "neighbour", "boundary"}) {
      const std::string good = read_text(poly_mesh / name);
      for (int i = 0; i < 300; ++i) {
        write_text(poly_mesh / name, mutated(good, random));
        attempt(folder.path());
      }
      write_text(poly_mesh / name, good);
    }
  }
  const ScratchFolder folder;
  const auto file = folder.path() / "mesh.vtu";
  const std::string good = vtu_text(mesh);
  for (int i = 0; i < 2000; ++i) {
    write_text(file, mutated(good, random));
    attempt(file);
  }
  CHECK(read + refused == 5000);
  CHECK(refused > 2000);
}

TEST_CASE("blockMeshDict: straight blocks are read, curved ones refused with their line") {
  const ScratchFolder scratch;
  const std::filesystem::path file = scratch.path() / "blockMeshDict";
  const auto read = [&](const std::string& text) {
    std::ofstream(file) << text;
    return read_block_dict(file);
  };
  const std::string head =
      "FoamFile { version 2.0; format ascii; class dictionary; object blockMeshDict; }\n"
      "convertToMeters 0.5; // half\n"
      "vertices ( (0 0 0) (9 9 9) (2 0 0) (2 2 0) (0 2 0)\n (0 0 4) (2 0 4) (2 2 4) (0 2 4) );\n";
  const std::string block = "blocks ( hex (0 2 3 4 5 6 7 8) zone (3 1 1) simpleGrading (1 2 1) );\n";
  const std::string patches =
      "boundary ( ball { type wall; faces ((0 4 3 2)); } left { type symmetryPlane; faces ((0 5 8 4)); }\n"
      " inflow { type patch; faces ((2 3 7 6)); } );\n";
  const DictBlocks dict = read(head + block + "edges ( line 0 2 ); /* none */\n" + patches +
                               "defaultPatch { name rest; type patch; }\nmergePatchPairs ();\n");
  CHECK(dict.in_metres);
  CHECK(dict.mesh.cell_count() == 1);
  REQUIRE(dict.mesh.points().size() == 8);  // one vertex is in no block
  CHECK(dict.mesh.points()[6] == Vec3(1, 1, 2));
  CHECK(enclosed_volume(dict.mesh) == Approx(2));
  REQUIRE(dict.notes.size() == 1);
  CHECK(dict.notes[0].find("numbers of cells and grading") != std::string::npos);
  REQUIRE(dict.mesh.patches().size() == 4);
  const std::array types{PatchType::wall, PatchType::symmetry, PatchType::inlet, PatchType::farfield};
  for (std::size_t p = 0; p < types.size(); ++p) CHECK(dict.mesh.patches()[p].type == types[p]);
  CHECK(dict.mesh.patches()[3].name == "rest");
  CHECK(dict.mesh.patches()[3].quads.size() == 3);
  const auto refused = [&](const std::string& text, const std::string& line, const std::string& reason) {
    std::string said;
    try {
      read(text);
    } catch (const Error& e) {
      said = e.kind() == ErrorKind::input ? e.what() : "";
    }
    CAPTURE(said, line, reason);
    CHECK(said.find("blockMeshDict:" + line + ":") != std::string::npos);
    CHECK(said.find(reason) != std::string::npos);
  };
  refused(head + block + "edges (\narc 0 2 (1 1 0) );\n", "7", "\"arc\"");
  refused(head + block + "faces ( project (0 2 3 4) ball );", "6", "faces");
  refused("vertices ( project (0 0 0) (ball) );", "1", "project");
  refused(head + "blocks ( hex (0 2 3 4 5 6 7 9) (1 1 1) );", "5", "no vertex 9");
  refused(head + "blocks ( hex (0 2 3 4 5 6 7 8) (1 0 1) );", "5", "number of cells");
  refused(head + "x $y;", "5", "macros");
  refused(head + "blocks ( hex (0 2 3", "5", "");
}
