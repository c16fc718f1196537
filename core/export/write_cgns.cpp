#include "core/export/write_cgns.hpp"

#include <fmt/format.h>

#include <limits>
#include <map>

#include "core/export/cgns_file.hpp"
#include "core/export/curved_order.hpp"
#include "core/export/patch_names.hpp"
#include "core/export/write_curved.hpp"
#include "core/mesh/visit_cells.hpp"

namespace flowcage {
namespace {

constexpr int dimension = 3;
constexpr std::array<const char*, 3> coordinates{"CoordinateX", "CoordinateY", "CoordinateZ"};

LengthUnits_t length_unit(const std::string& unit) {
  static const std::map<std::string, LengthUnits_t> units{
      {"m", Meter}, {"mm", Millimeter}, {"in", Inch}, {"ft", Foot}};
  return units.at(unit);
}

/// The library's own integer, which has 32 bits unless it was built with 64.
cgsize_t cgns_size(Offset value) {
  if (value <= std::numeric_limits<cgsize_t>::max()) return static_cast<cgsize_t>(value);
  throw Error(ErrorKind::output, fmt::format("CGNS: {} is more than this library's numbers hold", value),
              "write another format, or use a CGNS library with 64-bit numbers");
}

class CgnsWriter {
 public:
  CgnsWriter(const std::filesystem::path& path, const HexView& mesh, const CgnsSettings& settings)
      : file_(path, CgnsFile::Use::write, settings.shown_as),
        fn_(file_.number()),
        names_(legal_patch_names(mesh)) {
    file_.check(cg_base_write(fn_, "flowcage", dimension, dimension, &base_));
    file_.check(cg_goto(fn_, base_, "end"));
    file_.check(cg_dataclass_write(Dimensional));
    file_.check(cg_units_write(Kilogram, length_unit(settings.unit), Second, Kelvin, Degree));
    for (std::size_t i = 0; i < names_.names.size(); ++i) {
      int family = 0, condition = 0;
      file_.check(cg_family_write(fn_, base_, names_.names[i].c_str(), &family));
      file_.check(
          cg_fambc_write(fn_, base_, family, "FamBC", cgns_condition(mesh.patches()[i].type), &condition));
    }
  }

  int zone(const std::string& name, const std::vector<cgsize_t>& size, ZoneType_t type) {
    int zone = 0;
    file_.check(cg_zone_write(fn_, base_, name.c_str(), size.data(), type, &zone));
    return zone;
  }

  /// point(i) for the `count` points of a zone, in its order.
  template <typename Point>
  void points(int zone, Offset count, const Point& point) {
    std::vector<double> values(static_cast<std::size_t>(count));
    for (int d = 0; d < dimension; ++d) {
      for (Offset p = 0; p < count; ++p) values[p] = point(p)[d];
      int array = 0;
      file_.check(cg_coord_write(fn_, base_, zone, RealDouble, coordinates[d], values.data(), &array));
      file_.check(cg_goto(fn_, base_, "Zone_t", zone, "GridCoordinates_t", 1, "DataArray_t", array, "end"));
      const std::array<float, 5> length{0, 1, 0, 0, 0};
      file_.check(cg_exponents_write(RealSingle, length.data()));
    }
  }

  void condition(int zone, const std::string& name, Index patch, const std::vector<cgsize_t>& range,
                 bool at_faces) {
    int bc = 0;
    file_.check(
        cg_boco_write(fn_, base_, zone, name.c_str(), FamilySpecified, PointRange, 2, range.data(), &bc));
    if (at_faces) file_.check(cg_boco_gridlocation_write(fn_, base_, zone, bc, FaceCenter));
    file_.check(cg_goto(fn_, base_, "Zone_t", zone, "ZoneBC_t", 1, "BC_t", bc, "end"));
    file_.check(cg_famname_write(names_.names[patch].c_str()));
  }

  void interface(int zone, const std::string& name, const BlockWindow& window, const std::string& donor) {
    const std::vector<cgsize_t> range = range_of(window.low, window.high);
    const std::vector<cgsize_t> donor_range = range_of(window.donor_low, window.donor_high);
    int number = 0;
    file_.check(cg_1to1_write(fn_, base_, zone, name.c_str(), donor.c_str(), range.data(), donor_range.data(),
                              window.transform.data(), &number));
  }

  /// A section of elements of `nodes` points each: read(element, points) puts those of one there.
  template <typename Read>
  void section(int zone, const std::string& name, ElementType_t type, Offset first, Offset count,
               const Read& read) {
    int number = 0, nodes = 0;
    file_.check(cg_npe(type, &nodes));
    cgns_size(count * nodes);  // the library counts a section's points
    file_.check(cg_section_partial_write(fn_, base_, zone, name.c_str(), type, cgns_size(first),
                                         cgns_size(first + count - 1), 0, &number));
    std::vector<cgsize_t> points;
    for (Offset begin = 0; begin < count; begin += cell_grain) {
      const Offset n = std::min(cell_grain, count - begin);
      points.clear();
      for (Offset e = begin; e < begin + n; ++e) read(e, points);
      file_.check(cg_elements_partial_write(fn_, base_, zone, number, cgns_size(first + begin),
                                            cgns_size(first + begin + n - 1), points.data()));
    }
  }

  static std::vector<cgsize_t> range_of(const std::array<Index, 3>& low, const std::array<Index, 3>& high) {
    return {low[0] + 1, low[1] + 1, low[2] + 1, high[0] + 1, high[1] + 1, high[2] + 1};
  }

  const std::vector<std::string>& names() const { return names_.names; }
  std::vector<std::string> finish() {
    file_.close();
    return std::move(names_.notes);
  }

 private:
  CgnsFile file_;
  int fn_ = 0, base_ = 0;
  PatchNames names_;
};

}  // namespace

std::string cgns_version() {
  return fmt::format("{}.{}.{}", CGNS_VERSION / 1000, CGNS_VERSION / 100 % 10, CGNS_VERSION / 10 % 10);
}

std::vector<std::string> write_cgns(const std::filesystem::path& file, const BlockMesh& mesh,
                                    const StructuredBlocks& blocks, const CgnsSettings& settings,
                                    Progress* progress) {
  if (progress) progress->step("write CGNS", 0);
  CgnsWriter writer(file, mesh, settings);
  const auto zone_name = [](Index block) { return fmt::format("block{}", block + 1); };
  for (std::size_t b = 0; b < blocks.blocks.size(); ++b) {
    const StructuredBlock& block = blocks.blocks[b];
    const auto [ni, nj, nk] = block.cells();
    const int zone = writer.zone(zone_name(static_cast<Index>(b)),
                                 {ni + 1, nj + 1, nk + 1, ni, nj, nk, 0, 0, 0}, Structured);
    const Offset row = ni + 1, layer = row * (nj + 1);
    writer.points(zone, layer * (nk + 1), [&, nj = nj](Offset p) {
      return mesh.points()[point_number(mesh, block,
                                        {static_cast<Index>(p % row), static_cast<Index>(p / row % (nj + 1)),
                                         static_cast<Index>(p / layer)})];
    });
    int number = 0;
    for (const BlockWindow& window : blocks.windows) {
      if (window.block != static_cast<Index>(b)) continue;
      ++number;
      if (window.patch != no_index) {
        writer.condition(zone, fmt::format("bc{}", number), window.patch,
                         CgnsWriter::range_of(window.low, window.high), false);
      } else {
        writer.interface(zone, fmt::format("interface{}", number), window, zone_name(window.donor));
      }
    }
    if (progress)
      progress->step("write CGNS", static_cast<double>(b + 1) / static_cast<double>(blocks.blocks.size()));
  }
  return writer.finish();
}

namespace {

/// One zone "mesh" of hexes and a section and condition a patch; quads(patch, q, points) and hexes(c, points)
/// append the points of one, from 1.
struct OneZone {
  ElementType_t hex = HEXA_8, quad = QUAD_4;
  Offset cells = 0;
  std::vector<Offset> quad_counts;
};

template <typename Hexes, typename Quads>
std::vector<std::string> write_one_zone(CgnsWriter& writer, const HexView& points, const OneZone& of,
                                        const Hexes& hexes, const Quads& quads) {
  const auto count = static_cast<Offset>(points.points().size());
  const int zone = writer.zone("mesh", {cgns_size(count), cgns_size(of.cells), 0}, Unstructured);
  writer.points(zone, count, [&](Offset p) { return points.points()[p]; });
  writer.section(zone, "hexes", of.hex, 1, of.cells, hexes);
  Offset first = of.cells + 1;
  for (std::size_t i = 0; i < of.quad_counts.size(); ++i) {
    const Offset own = of.quad_counts[i];
    if (own == 0) continue;
    writer.section(zone, writer.names()[i], of.quad, first, own,
                   [&](Offset q, std::vector<cgsize_t>& out) { quads(i, q, out); });
    writer.condition(zone, writer.names()[i], static_cast<Index>(i),
                     {cgns_size(first), cgns_size(first + own - 1)}, true);
    first += own;
  }
  return writer.finish();
}

}  // namespace

std::vector<std::string> write_cgns_unstructured(const std::filesystem::path& file, const HexView& mesh,
                                                 const CgnsSettings& settings, Progress* progress) {
  if (progress) progress->step("write CGNS", 0);
  CgnsWriter writer(file, mesh, settings);
  OneZone zone;
  zone.cells = mesh.cell_count();
  for (const BoundaryPatch& patch : mesh.patches()) {
    zone.quad_counts.push_back(static_cast<Offset>(patch.quads.size()));
  }
  const auto append = [](const auto& points, std::vector<cgsize_t>& out) {
    for (const Index p : points) out.push_back(p + 1);
  };
  auto notes = write_one_zone(
      writer, mesh, zone,
      [&](Offset c, std::vector<cgsize_t>& out) {
        HexPoints cell{};
        mesh.read_cells(c, {&cell, 1});
        append(cell, out);
      },
      [&](std::size_t i, Offset q, std::vector<cgsize_t>& out) { append(mesh.patches()[i].quads[q], out); });
  if (progress) progress->step("write CGNS", 1);
  return notes;
}

std::vector<std::string> write_curved_cgns(const std::filesystem::path& file, const CurvedMesh& mesh,
                                           const CgnsSettings& settings, Progress* progress) {
  if (progress) progress->step("write CGNS", 0);
  constexpr std::array<ElementType_t, 5> hex_type{ElementTypeNull, HEXA_8, HEXA_27, HEXA_64, HEXA_125};
  constexpr std::array<ElementType_t, 5> quad_type{ElementTypeNull, QUAD_4, QUAD_9, QUAD_16, QUAD_25};
  const CurvedOrder order = cgns_order(mesh.order);
  CgnsWriter writer(file, mesh.nodes, settings);
  OneZone zone{hex_type[mesh.order], quad_type[mesh.order], mesh.cell_count(), {}};
  std::vector<std::vector<Index>> quads;
  for (std::size_t i = 0; i < mesh.nodes.patches().size(); ++i) {
    quads.push_back(mesh.patch_quads(i));
    zone.quad_counts.push_back(static_cast<Offset>(quads.back().size()) / mesh.nodes_per_quad());
  }
  std::vector<Index> nodes(static_cast<std::size_t>(mesh.nodes_per_cell()));
  auto notes = write_one_zone(
      writer, mesh.nodes, zone,
      [&](Offset c, std::vector<cgsize_t>& out) {
        mesh.read_cell(c, nodes);
        for (const int at : order.hex) out.push_back(nodes[at] + 1);
      },
      [&](std::size_t i, Offset q, std::vector<cgsize_t>& out) {
        for (const int at : order.quad) out.push_back(quads[i][q * mesh.nodes_per_quad() + at] + 1);
      });
  if (progress) progress->step("write CGNS", 1);
  return notes;
}

}  // namespace flowcage
