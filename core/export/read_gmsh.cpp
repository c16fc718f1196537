#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <map>
#include <numeric>

#include "core/export/complete_boundary.hpp"
#include "core/export/file_text.hpp"
#include "core/export/patch_names.hpp"
#include "core/export/read_mesh.hpp"
#include "core/export/text_scanner.hpp"

namespace flowcage {
namespace {

constexpr const char* remake = "write the file again: gmsh IN.msh -save -format msh41 -o OUT.msh";
constexpr Offset gmsh_line = 1, gmsh_quad = 3, gmsh_hexahedron = 5, gmsh_point = 15;
constexpr std::size_t least_line = 4;  // bytes

const char* element_name(Offset type) {
  switch (type) {
    case 2:
      return "triangle";
    case 4:
      return "tetrahedron";
    case 6:
      return "prism";
    case 7:
      return "pyramid";
    case 10:
    case 12:
    case 16:
    case 17:
      return "curved quad or hex";
    default:
      return "element that is neither hex nor quad";
  }
}

/// A surface's physical group, or the surface itself where it has none.
using PatchKey = std::pair<bool, Offset>;

class GmshReader {
 public:
  explicit GmshReader(const std::filesystem::path& file) : scanner_(file) {}

  HexMesh read() {
    while (!scanner_.at_end()) {
      const std::string section(scanner_.word());
      if (!section.starts_with('$')) {
        scanner_.fail(fmt::format("a section ($...) is expected, not \"{}\"", excerpt(section, 0)), remake);
      }
      if (section == "$MeshFormat") {
        read_format();
      } else if (major_ == 0) {
        scanner_.fail("the file does not begin with $MeshFormat", "give a Gmsh mesh, format 2 or 4.1");
      } else if (section == "$PhysicalNames") {
        read_names();
      } else if (section == "$Entities") {
        read_entities();
      } else if (section == "$Nodes") {
        read_nodes();
      } else if (section == "$Elements") {
        read_elements();
      }
      find_end("$End" + section.substr(1));
    }
    if (hexes_.empty()) scanner_.fail("holds no hexes", "give a volume mesh of hexes");
    std::vector<BoundaryPatch> patches;
    for (auto& [key, patch] : patches_) patches.push_back(std::move(patch));
    return complete_boundary(std::move(points_), std::move(hexes_), std::move(patches));
  }

 private:
  void find_end(const std::string& end) {
    while (scanner_.word() != end) {
      if (scanner_.at_end()) scanner_.fail(fmt::format("the file ends before {}", end), remake);
    }
  }

  void read_format() {
    const double version = scanner_.real("the format's version");
    const bool ascii = scanner_.integer("0 (ASCII) or 1 (binary)") == 0;
    if (!(version >= 2 && version < 3) && version != 4.1) {
      scanner_.fail(fmt::format("the format's version is {}; flowcage reads 2 and 4.1", version), remake);
    }
    if (!ascii) {
      scanner_.fail("is a binary file; flowcage reads ASCII",
                    "gmsh IN.msh -save -format msh41 -setnumber Mesh.Binary 0 -o OUT.msh");
    }
    major_ = version < 3 ? 2 : 4;
    scanner_.integer("the size of numbers");
  }

  void read_names() {
    const Offset count = scanner_.count("the number of names", least_line);
    for (Offset i = 0; i < count; ++i) {
      const Offset dimension = scanner_.integer("a dimension");
      const Offset tag = scanner_.integer("the number of a physical group");
      const std::string_view rest = scanner_.line();
      const auto open = rest.find('"'), close = rest.rfind('"');
      if (open == std::string_view::npos || close == open)
        scanner_.fail("a name in \"\" is expected", remake);
      if (dimension == 2) names_[tag] = std::string(rest.substr(open + 1, close - open - 1));
    }
  }

  /// Keeps the first physical group of each surface.
  void read_entities() {
    std::array<Offset, 4> counts{};
    for (Offset& n : counts) n = scanner_.count("a number of entities", least_line);
    for (int dimension = 0; dimension < 4; ++dimension) {
      for (Offset i = 0; i < counts[dimension]; ++i) {
        const Offset tag = scanner_.integer("an entity's number");
        for (int n = 0; n < (dimension == 0 ? 3 : 6); ++n) scanner_.real("a bounding box");
        const Offset groups = scanner_.count("a number of groups", 2);
        for (Offset g = 0; g < groups; ++g) {
          const Offset group = scanner_.integer("a physical group");
          if (dimension == 2 && g == 0) group_of_surface_[tag] = group;
        }
        if (dimension == 0) continue;
        const Offset bounding = scanner_.count("a number of bounding entities", 2);
        for (Offset b = 0; b < bounding; ++b) scanner_.integer("a bounding entity");
      }
    }
  }

  void read_nodes() {
    std::vector<Offset> tags;
    std::vector<Vec3> points;
    if (major_ == 2) {
      const Offset count = scanner_.count("the number of nodes", least_line);
      for (Offset i = 0; i < count; ++i) {
        tags.push_back(scanner_.integer("a node's number"));
        points.push_back(scanner_.point());
      }
    } else {
      const Offset blocks = scanner_.count("the number of node blocks", least_line);
      for (int n = 0; n < 3; ++n) scanner_.integer("a number of nodes");
      for (Offset b = 0; b < blocks; ++b) {
        const Offset dimension = scanner_.integer("a dimension");
        scanner_.integer("an entity's number");
        const bool parametric = scanner_.integer("0 or 1 (parametric)") != 0;
        const Offset count = scanner_.count("the number of nodes of a block", least_line);
        for (Offset i = 0; i < count; ++i) tags.push_back(scanner_.integer("a node's number"));
        for (Offset i = 0; i < count; ++i) {
          points.push_back(scanner_.point());
          for (Offset u = 0; parametric && u < dimension; ++u) scanner_.real("a parameter");
        }
      }
    }
    std::vector<std::size_t> order(tags.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return tags[a] < tags[b]; });
    for (const std::size_t i : order) {
      if (!tags_.empty() && tags_.back() == tags[i]) {
        scanner_.fail(fmt::format("node {} is given twice", tags[i]), remake);
      }
      tags_.push_back(tags[i]);
      points_.push_back(points[i]);
    }
  }

  void read_elements() {
    if (major_ == 2) {
      const Offset count = scanner_.count("the number of elements", least_line);
      for (Offset i = 0; i < count; ++i) {
        scanner_.integer("an element's number");
        const Offset type = scanner_.integer("an element's type");
        const Offset tags = scanner_.count("an element's number of tags", 2);
        Offset group = 0, surface = 0;
        for (Offset t = 0; t < tags; ++t) {
          const Offset tag = scanner_.integer("an element's tag");
          if (t == 0) group = tag;
          if (t == 1) surface = tag;
        }
        read_element(type, group != 0 ? PatchKey{false, group} : PatchKey{true, surface});
      }
      return;
    }
    const Offset blocks = scanner_.count("the number of element blocks", least_line);
    for (int n = 0; n < 3; ++n) scanner_.integer("a number of elements");
    for (Offset b = 0; b < blocks; ++b) {
      scanner_.integer("a dimension");
      const Offset surface = scanner_.integer("an entity's number");
      const Offset type = scanner_.integer("an element's type");
      const Offset count = scanner_.count("the number of elements of a block", least_line);
      const auto group = group_of_surface_.find(surface);
      const PatchKey key =
          group != group_of_surface_.end() ? PatchKey{false, group->second} : PatchKey{true, surface};
      for (Offset i = 0; i < count; ++i) {
        scanner_.integer("an element's number");
        read_element(type, key);
      }
    }
  }

  void read_element(Offset type, const PatchKey& key) {
    if (type == gmsh_hexahedron) {
      hexes_.push_back(read_row<8>());
    } else if (type == gmsh_quad) {
      const auto quad = read_row<4>();
      const auto [it, fresh] = patches_.try_emplace(key);
      if (fresh) {
        const auto name = names_.find(key.second);
        it->second.name = key.first              ? fmt::format("surface{}", key.second)
                          : name != names_.end() ? name->second
                                                 : fmt::format("group{}", key.second);
        it->second.type = foreign_patch_type(it->second.name);
      }
      it->second.quads.push_back(quad);
    } else if (type == gmsh_point) {
      read_row<1>();
    } else if (type == gmsh_line) {
      read_row<2>();
    } else {
      scanner_.fail(fmt::format("has a {} (Gmsh type {})", element_name(type), type),
                    "flowcage reads meshes of linear hexes only");
    }
  }

  template <std::size_t N>
  std::array<Index, N> read_row() {
    std::array<Index, N> row{};
    for (Index& p : row) {
      const Offset tag = scanner_.integer("the number of a node");
      const auto at = std::lower_bound(tags_.begin(), tags_.end(), tag);
      if (at == tags_.end() || *at != tag) scanner_.fail(fmt::format("there is no node {}", tag), remake);
      p = static_cast<Index>(at - tags_.begin());
    }
    return row;
  }

  TextScanner scanner_;
  int major_ = 0;  ///< of the format's version; 0 before it is known
  std::map<Offset, std::string> names_;
  std::map<Offset, Offset> group_of_surface_;
  std::vector<Offset> tags_;  ///< of the points, ascending
  std::vector<Vec3> points_;
  std::vector<HexPoints> hexes_;
  std::map<PatchKey, BoundaryPatch> patches_;
};

}  // namespace

HexMesh read_gmsh(const std::filesystem::path& file) {
  return naming_file(file, [&] { return GmshReader(file).read(); });
}

}  // namespace flowcage
