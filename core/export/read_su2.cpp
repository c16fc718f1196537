#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "core/export/complete_boundary.hpp"
#include "core/export/file_text.hpp"
#include "core/export/patch_names.hpp"
#include "core/export/read_mesh.hpp"
#include "core/export/text_scanner.hpp"

namespace flowcage {
namespace {

constexpr const char* remake = "write the file again with the program that made it";
constexpr Offset vtk_vertex = 1, vtk_line = 3, vtk_quad = 9, vtk_hexahedron = 12;
constexpr std::size_t least_line = 4;  // bytes: "9 a\n"

class Su2Reader {
 public:
  explicit Su2Reader(const std::filesystem::path& file) : scanner_(file) {}

  HexMesh read() {
    while (!scanner_.at_end()) {
      std::string key(scanner_.word());
      if (key.starts_with('%')) {
        scanner_.line();
        continue;
      }
      take_value(key);
    }
    if (hexes_.empty() || points_.empty()) {
      scanner_.fail("holds no hexes and points (NELEM=, NPOIN=)", "give a three-dimensional mesh of hexes");
    }
    if (static_cast<Offset>(patches_.size()) != markers_ || !quads_follow_) {
      scanner_.fail(
          fmt::format("{} of {} markers are there (NMARK=)", patches_.size(), std::max<Offset>(markers_, 0)),
          "the file is cut off: write it again with the program that made it");
    }
    check_points(hexes_, "cell");
    for (const BoundaryPatch& patch : patches_) check_points(patch.quads, "a quad of " + patch.name);
    return complete_boundary(std::move(points_), std::move(hexes_), std::move(patches_));
  }

 private:
  /// KEY= VALUE, with or without space before the sign; the scanner stands before the value afterwards.
  void take_value(std::string key) {
    const auto sign = key.find('=');
    if (sign == std::string::npos) {
      if (scanner_.word() != "=") scanner_.fail(fmt::format("\"{}\" is no keyword", excerpt(key, 0)), remake);
    } else if (sign + 1 != key.size()) {
      scanner_.step_back(key.size() - sign - 1);
    }
    key.resize(std::min(sign, key.size()));
    if (key == "NDIME") {
      if (scanner_.integer("the dimension") != 3) {
        scanner_.fail("the mesh is not three-dimensional", "give a three-dimensional mesh of hexes");
      }
    } else if (key == "NELEM") {
      read_cells();
    } else if (key == "NPOIN") {
      read_points();
    } else if (key == "NMARK") {
      markers_ = scanner_.integer("the number of markers");
    } else if (key == "MARKER_TAG") {
      quads_follow_ = false;
      patches_.push_back({std::string(scanner_.word()), PatchType::wall, {}, {}});
      patches_.back().type = foreign_patch_type(patches_.back().name);
    } else if (key == "MARKER_ELEMS") {
      read_quads();
    } else if (key == "NZONE" && scanner_.integer("the number of zones") != 1) {
      scanner_.fail("has several zones", "give each zone as a file of its own");
    } else {
      scanner_.line();
    }
  }

  void read_points() {
    const Offset count = scanner_.count("the number of points", least_line);
    scanner_.line();  // some files say twice how many
    for (Offset p = 0; p < count; ++p) {
      points_.push_back(scanner_.point());
      scanner_.line();  // the point's number, which some files leave out
    }
  }

  void read_cells() {
    const Offset count = scanner_.count("the number of cells", least_line);
    for (Offset c = 0; c < count; ++c) {
      const Offset type = scanner_.integer("a cell's type");
      if (type != vtk_hexahedron) {
        scanner_.fail(fmt::format("cell {} is no hex (VTK type {})", c, type),
                      "flowcage reads meshes of linear hexes only");
      }
      hexes_.push_back(read_row<8>());
      scanner_.line();
    }
  }

  void read_quads() {
    if (patches_.empty()) scanner_.fail("MARKER_ELEMS stands before MARKER_TAG", remake);
    quads_follow_ = true;
    const Offset count = scanner_.count("the number of quads", least_line);
    for (Offset q = 0; q < count; ++q) {
      const Offset type = scanner_.integer("a type");
      if (type == vtk_quad) {
        patches_.back().quads.push_back(read_row<4>());
      } else if (type != vtk_vertex && type != vtk_line) {
        scanner_.fail(
            fmt::format("marker {} has an element of VTK type {}, no quad", patches_.back().name, type),
            "flowcage reads meshes of linear hexes only");
      }
      scanner_.line();
    }
  }

  template <std::size_t N>
  std::array<Index, N> read_row() {
    std::array<Index, N> row{};
    for (Index& p : row) {
      const Offset value = scanner_.integer("the number of a point");
      if (value < 0 || value > std::numeric_limits<Index>::max()) {
        scanner_.fail(fmt::format("there is no point {}", value), remake);
      }
      p = static_cast<Index>(value);
    }
    return row;
  }

  /// Points may stand behind the cells, so their numbers are checked at the end.
  template <typename Rows>
  void check_points(const Rows& rows, const std::string& what) const {
    for (std::size_t r = 0; r < rows.size(); ++r) {
      for (const Index p : rows[r]) {
        if (p < static_cast<Index>(points_.size())) continue;
        scanner_.fail(fmt::format("{} {} has point {}, but there are {} points", what, r, p, points_.size()),
                      remake);
      }
    }
  }

  TextScanner scanner_;
  std::vector<Vec3> points_;
  std::vector<HexPoints> hexes_;
  std::vector<BoundaryPatch> patches_;
  Offset markers_ = -1;       ///< as NMARK says
  bool quads_follow_ = true;  ///< each marker so far had its quads
};

}  // namespace

HexMesh read_su2(const std::filesystem::path& file) {
  return naming_file(file, [&] { return Su2Reader(file).read(); });
}

}  // namespace flowcage
