#include <fmt/format.h>

#include <limits>
#include <map>
#include <numeric>

#include "core/export/cgns_file.hpp"
#include "core/export/complete_boundary.hpp"
#include "core/export/file_text.hpp"
#include "core/export/patch_names.hpp"
#include "core/export/read_mesh.hpp"
#include "core/mesh/hex_numbering.hpp"

namespace flowcage {
namespace {

constexpr const char* remake = "check the file with cgnscheck, and write it again";
constexpr int base = 1;
using Name = std::array<char, 33>;  // CGNS names have at most 32 characters
using Ijk = std::array<Offset, 3>;

/// A zone as the file has it; `first` is its first point in the list of all zones' points.
struct Zone {
  std::string name;
  ZoneType_t type{};
  Ijk points{1, 1, 1};
  Offset first = 0, cells = 0;

  Offset point_count() const { return points[0] * points[1] * points[2]; }
  Offset at(const Ijk& ijk) const { return first + ijk[0] + points[0] * (ijk[1] + points[1] * ijk[2]); }
};

class CgnsReader {
 public:
  explicit CgnsReader(const std::filesystem::path& path)
      : file_(path, CgnsFile::Use::read, path.string()),
        fn_(file_.number()),
        bytes_(static_cast<Offset>(std::filesystem::file_size(path))) {}

  HexMesh read() {
    read_zones();
    read_families();
    if (zones_.front().type == Unstructured) {
      read_elements();
    } else {
      read_structured();
    }
    std::erase_if(patches_, [](const BoundaryPatch& patch) { return patch.quads.empty(); });
    return complete_boundary(std::move(points_), std::move(hexes_), std::move(patches_));
  }

 private:
  void read_zones() {
    int bases = 0, count = 0, cell_dimension = 0, dimension = 0;
    Name name{};
    file_.check(cg_nbases(fn_, &bases));
    if (bases != 1) file_.fail(fmt::format("has {} bases, not one", bases), "give a file with one base");
    file_.check(cg_base_read(fn_, base, name.data(), &cell_dimension, &dimension));
    if (cell_dimension != 3 || dimension != 3) {
      file_.fail("the mesh is not three-dimensional", "give a three-dimensional mesh of hexes");
    }
    file_.check(cg_nzones(fn_, base, &count));
    if (count < 1) file_.fail("holds no zones", remake);
    for (int z = 1; z <= count; ++z) {
      Zone zone;
      std::array<cgsize_t, 9> size{};
      file_.check(cg_zone_type(fn_, base, z, &zone.type));
      file_.check(cg_zone_read(fn_, base, z, name.data(), size.data()));
      zone.name = name.data();
      const int axes = zone.type == Structured ? 3 : 1;
      for (int d = 0; d < axes; ++d) {
        zone.points[d] = size[d];
        require_room(size[d], 4, fmt::format("zone {}", zone.name));
      }
      require_room(zone.point_count(), 12, fmt::format("zone {}", zone.name));
      zone.cells = size[1];
      zone.first = static_cast<Offset>(points_.size());
      if (zone.type == Unstructured && count > 1) {
        file_.fail(fmt::format("has {} zones, of which {} is unstructured", count, zone.name),
                   "give structured zones, or one unstructured zone");
      }
      read_points(zone, z);
      zones_.push_back(zone);
    }
  }

  /// A number of things that the file claims to have, of `least` bytes each.
  void require_room(Offset count, Offset least, const std::string& what) const {
    if (count >= 1 && count <= std::numeric_limits<Index>::max() && count <= bytes_ / least) return;
    file_.fail(fmt::format("{} claims {} points or elements, in a file of {} bytes", what, count, bytes_),
               remake);
  }

  void read_points(const Zone& zone, int z) {
    const Offset count = zone.point_count();
    points_.resize(points_.size() + static_cast<std::size_t>(count));
    std::vector<double> values(static_cast<std::size_t>(count));
    const std::array<cgsize_t, 3> low{1, 1, 1};
    std::array<cgsize_t, 3> high{};
    for (int d = 0; d < 3; ++d) high[d] = static_cast<cgsize_t>(zone.points[d]);
    int d = 0;
    for (const char* name : {"CoordinateX", "CoordinateY", "CoordinateZ"}) {
      file_.check(cg_coord_read(fn_, base, z, name, RealDouble, low.data(), high.data(), values.data()));
      for (Offset p = 0; p < count; ++p) points_[zone.first + p][d] = values[p];
      ++d;
    }
    for (Offset p = 0; p < count; ++p) {
      if (points_[zone.first + p].allFinite()) continue;
      file_.fail(fmt::format("point {} of zone {} is not finite", p + 1, zone.name), remake);
    }
  }

  /// The families with a condition become patches, in their order.
  void read_families() {
    int count = 0;
    file_.check(cg_nfamilies(fn_, base, &count));
    for (int f = 1; f <= count; ++f) {
      Name name{}, bc_name{};
      int conditions = 0, geometries = 0;
      file_.check(cg_family_read(fn_, base, f, name.data(), &conditions, &geometries));
      if (conditions < 1) continue;
      BCType_t type{};
      file_.check(cg_fambc_read(fn_, base, f, 1, bc_name.data(), &type));
      patches_[patch_named(name.data())].type = patch_type_of(type);
    }
  }

  std::size_t patch_named(const std::string& name) {
    const auto [it, fresh] = patch_of_name_.try_emplace(name, patches_.size());
    if (fresh) patches_.push_back({name, foreign_patch_type(name), {}, {}});
    return it->second;
  }

  struct Condition {
    std::size_t patch = 0;
    PointSetType_t set{};
    std::vector<cgsize_t> points;
    GridLocation_t location{};
  };

  std::vector<Condition> read_conditions(int z, int index_size) {
    int count = 0;
    file_.check(cg_nbocos(fn_, base, z, &count));
    std::vector<Condition> result;
    for (int b = 1; b <= count; ++b) {
      Condition condition;
      Name name{}, family{};
      BCType_t type{};
      std::array<int, 3> normal{};
      cgsize_t points = 0, normals = 0;
      DataType_t data{};
      int data_sets = 0;
      file_.check(cg_boco_info(fn_, base, z, b, name.data(), &type, &condition.set, &points, normal.data(),
                               &normals, &data, &data_sets));
      require_room(points, 4, fmt::format("boundary condition {}", name.data()));
      condition.points.resize(static_cast<std::size_t>(points * index_size));
      file_.check(cg_boco_read(fn_, base, z, b, condition.points.data(), nullptr));
      file_.check(cg_boco_gridlocation_read(fn_, base, z, b, &condition.location));
      file_.check(cg_goto(fn_, base, "Zone_t", z, "ZoneBC_t", 1, "BC_t", b, "end"));
      const bool in_family = cg_famname_read(family.data()) == CG_OK;
      condition.patch = patch_named(in_family ? family.data() : name.data());
      if (type != FamilySpecified) patches_[condition.patch].type = patch_type_of(type);
      result.push_back(std::move(condition));
    }
    return result;
  }

  // Structured zones: the points that interfaces join become one.

  void read_structured() {
    same_as_.resize(points_.size());
    std::iota(same_as_.begin(), same_as_.end(), Offset{0});
    for (int z = 1; z <= static_cast<int>(zones_.size()); ++z) join_interfaces(z);
    std::vector<Index> number(points_.size(), no_index);
    std::vector<Vec3> points;
    for (std::size_t p = 0; p < number.size(); ++p) {
      Index& of_root = number[root(static_cast<Offset>(p))];
      if (of_root == no_index) {
        of_root = static_cast<Index>(points.size());
        points.push_back(points_[p]);
      }
      number[p] = of_root;
    }
    points_ = std::move(points);
    for (int z = 1; z <= static_cast<int>(zones_.size()); ++z) {
      const Zone& zone = zones_[z - 1];
      Ijk at{};
      for (at[2] = 0; at[2] + 1 < zone.points[2]; ++at[2]) {
        for (at[1] = 0; at[1] + 1 < zone.points[1]; ++at[1]) {
          for (at[0] = 0; at[0] + 1 < zone.points[0]; ++at[0]) {
            HexPoints hex{};
            for (int c = 0; c < 8; ++c) {
              const auto& corner = hex_corner_ijk[c];
              hex[c] = number[zone.at({at[0] + corner[0], at[1] + corner[1], at[2] + corner[2]})];
            }
            hexes_.push_back(hex);
          }
        }
      }
      read_windows(z, number);
    }
  }

  Offset root(Offset p) {
    while (same_as_[p] != p) p = same_as_[p] = same_as_[same_as_[p]];
    return p;
  }

  /// A range of points, checked: 0-based, low <= high.
  std::pair<Ijk, Ijk> checked_range(const Zone& zone, const cgsize_t* range, const std::string& what) const {
    Ijk low{}, high{};
    for (int d = 0; d < 3; ++d) {
      low[d] = std::min(range[d], range[d + 3]) - Offset{1};
      high[d] = std::max(range[d], range[d + 3]) - Offset{1};
      if (low[d] >= 0 && high[d] < zone.points[d]) continue;
      file_.fail(fmt::format("zone {}: {} reaches beyond the zone", zone.name, what), remake);
    }
    return {low, high};
  }

  void join_interfaces(int z) {
    const Zone& zone = zones_[z - 1];
    int count = 0;
    file_.check(cg_n1to1(fn_, base, z, &count));
    for (int n = 1; n <= count; ++n) {
      Name name{}, donor_name{};
      std::array<cgsize_t, 6> range{}, donor_range{};
      std::array<int, 3> transform{};
      file_.check(cg_1to1_read(fn_, base, z, n, name.data(), donor_name.data(), range.data(),
                               donor_range.data(), transform.data()));
      const auto donor = std::find_if(zones_.begin(), zones_.end(),
                                      [&](const Zone& other) { return other.name == donor_name.data(); });
      const std::string what = fmt::format("interface {}", name.data());
      if (donor == zones_.end()) {
        file_.fail(fmt::format("zone {}: {} joins the unknown zone {}", zone.name, what, donor_name.data()),
                   remake);
      }
      const auto [low, high] = checked_range(zone, range.data(), what);
      checked_range(*donor, donor_range.data(), what);
      Ijk at{};
      for (at[2] = low[2]; at[2] <= high[2]; ++at[2]) {
        for (at[1] = low[1]; at[1] <= high[1]; ++at[1]) {
          for (at[0] = low[0]; at[0] <= high[0]; ++at[0]) {
            Ijk there{donor_range[0] - Offset{1}, donor_range[1] - Offset{1}, donor_range[2] - Offset{1}};
            for (int d = 0; d < 3; ++d) {
              const Offset axis = std::abs(Offset{transform[d]}) - 1, steps = at[d] + 1 - range[d];
              if (axis >= 0 && axis < 3) there[axis] += transform[d] > 0 ? steps : -steps;
            }
            for (int d = 0; d < 3; ++d) {
              if (there[d] >= 0 && there[d] < donor->points[d]) continue;
              file_.fail(fmt::format("zone {}: the transform of {} leads out of zone {}", zone.name, what,
                                     donor->name),
                         remake);
            }
            const Offset a = root(zone.at(at)), b = root(donor->at(there));
            same_as_[std::max(a, b)] = std::min(a, b);
          }
        }
      }
    }
  }

  void read_windows(int z, const std::vector<Index>& number) {
    const Zone& zone = zones_[z - 1];
    for (const Condition& condition : read_conditions(z, 3)) {
      BoundaryPatch& patch = patches_[condition.patch];
      if (condition.set != PointRange || condition.points.size() != 6 || condition.location != Vertex) {
        file_.fail(
            fmt::format("zone {}: the boundary condition of {} is no range of points", zone.name, patch.name),
            "write boundary conditions as PointRange at vertices");
      }
      const auto [low, high] = checked_range(zone, condition.points.data(), "the condition of " + patch.name);
      int flat = -1, flats = 0;
      for (int d = 0; d < 3; ++d) {
        if (low[d] != high[d]) continue;
        flat = d;
        ++flats;
      }
      if (flats != 1) {
        file_.fail(fmt::format("zone {}: the condition of {} is no part of a face", zone.name, patch.name),
                   remake);
      }
      const int u = flat == 0 ? 1 : 0, v = flat == 2 ? 1 : 2;
      for (Offset y = low[v]; y < high[v]; ++y) {
        for (Offset x = low[u]; x < high[u]; ++x) {
          std::array<Index, 4> quad{};
          for (int c = 0; c < 4; ++c) {
            Ijk at = low;
            at[u] = x + (c == 1 || c == 2 ? 1 : 0);
            at[v] = y + (c >= 2 ? 1 : 0);
            quad[c] = number[zone.at(at)];
          }
          patch.quads.push_back(quad);
        }
      }
    }
  }

  // One unstructured zone.

  static bool is_passed_over(ElementType_t type) { return type == NODE || type == BAR_2; }

  void require_hex_or_quad(const std::string& section, ElementType_t type) const {
    if (type == HEXA_8 || type == QUAD_4) return;
    file_.fail(fmt::format("section {} holds elements of type {}", section, cg_ElementTypeName(type)),
               "flowcage reads HEXA_8 and QUAD_4 only, in sections of their own or MIXED");
  }

  [[noreturn]] void section_ends(const std::string& section, Offset element, Offset count) const {
    file_.fail(fmt::format("section {} ends in element {} of {}", section, element + 1, count), remake);
  }

  void read_elements() {
    int sections = 0;
    file_.check(cg_nsections(fn_, base, 1, &sections));
    std::map<cgsize_t, std::array<Index, 4>> quads;  // by element number
    std::map<cgsize_t, std::size_t> patch_of;
    for (int s = 1; s <= sections; ++s) {
      Name name{};
      ElementType_t type{};
      cgsize_t first = 0, last = 0, size = 0;
      int boundary = 0, parents = 0;
      file_.check(cg_section_read(fn_, base, 1, s, name.data(), &type, &first, &last, &boundary, &parents));
      if (type != MIXED && is_passed_over(type)) continue;
      if (type != MIXED) require_hex_or_quad(name.data(), type);
      const Offset count = Offset{last} - first + 1;
      const int least = type == HEXA_8 ? 8 : type == QUAD_4 ? 4 : 2;  // a mixed one has a type and a node
      require_room(count, 4 * least, fmt::format("section {}", name.data()));
      file_.check(cg_ElementDataSize(fn_, base, 1, s, &size));
      require_room(size, 4, fmt::format("section {}", name.data()));
      if (type != MIXED && size != count * least) {
        file_.fail(fmt::format("section {} has {} points for {} elements", name.data(), size, count), remake);
      }
      std::vector<cgsize_t> data(static_cast<std::size_t>(size));
      if (type == MIXED) {
        std::vector<cgsize_t> offsets(static_cast<std::size_t>(count) + 1);
        file_.check(cg_poly_elements_read(fn_, base, 1, s, data.data(), offsets.data(), nullptr));
      } else {
        file_.check(cg_elements_read(fn_, base, 1, s, data.data(), nullptr));
      }
      std::size_t at = 0;
      for (Offset e = 0; e < count; ++e) {
        ElementType_t own = type;
        if (type == MIXED) {
          if (at == data.size()) section_ends(name.data(), e, count);
          own = static_cast<ElementType_t>(data[at++]);
        }
        int nodes = 0;
        if (own <= ElementTypeNull || own >= NofValidElementTypes || cg_npe(own, &nodes) != CG_OK ||
            nodes < 1 || data.size() - at < static_cast<std::size_t>(nodes)) {
          section_ends(name.data(), e, count);
        }
        const std::size_t begin = at;
        at += static_cast<std::size_t>(nodes);
        if (is_passed_over(own)) continue;
        require_hex_or_quad(name.data(), own);
        HexPoints row{};
        for (int n = 0; n < nodes; ++n) {
          const cgsize_t p = data[begin + n];
          if (p < 1 || p > static_cast<Offset>(points_.size())) {
            file_.fail(fmt::format("section {} uses point {} of {}", name.data(), p, points_.size()), remake);
          }
          row[n] = static_cast<Index>(p - 1);
        }
        if (own == HEXA_8) {
          hexes_.push_back(row);
          continue;
        }
        const auto number = static_cast<cgsize_t>(first + e);
        quads[number] = {row[0], row[1], row[2], row[3]};
        patch_of[number] = patch_named(name.data());
      }
    }
    if (hexes_.empty()) file_.fail("holds no hexes", "give a volume mesh of hexes");
    for (const Condition& condition : read_conditions(1, 1)) {
      const bool range = condition.set == PointRange || condition.set == ElementRange;
      const bool of_elements =
          condition.location != Vertex || condition.set == ElementRange || condition.set == ElementList;
      if (!of_elements) continue;  // the section's name stays
      const auto& points = condition.points;
      if (range && points.size() == 2) {
        for (auto it = patch_of.lower_bound(points[0]); it != patch_of.end() && it->first <= points[1];
             ++it) {
          it->second = condition.patch;
        }
      } else {
        for (const cgsize_t e : points) {
          const auto it = patch_of.find(e);
          if (it != patch_of.end()) it->second = condition.patch;
        }
      }
    }
    for (const auto& [element, quad] : quads) patches_[patch_of.at(element)].quads.push_back(quad);
  }

  CgnsFile file_;
  int fn_;
  Offset bytes_;  ///< of the file
  std::vector<Zone> zones_;
  std::vector<Vec3> points_;
  std::vector<Offset> same_as_;
  std::vector<HexPoints> hexes_;
  std::vector<BoundaryPatch> patches_;
  std::map<std::string, std::size_t> patch_of_name_;
};

}  // namespace

HexMesh read_cgns(const std::filesystem::path& file) {
  return naming_file(file, [&] { return CgnsReader(file).read(); });
}

}  // namespace flowcage
