#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <map>

#include "core/export/complete_boundary.hpp"
#include "core/export/file_text.hpp"
#include "core/export/read_mesh.hpp"
#include "core/export/vtk_xml_reader.hpp"

namespace flowcage {
namespace {

constexpr const char* remake = "write the file again with the program that made it";
constexpr std::int64_t vertex = 1, line = 3, pixel = 8, quad = 9, voxel = 11, hexahedron = 12;

const char* cell_name(std::int64_t type) {
  switch (type) {
    case 5:
      return "triangle";
    case 7:
      return "polygon";
    case 10:
      return "tetrahedron";
    case 13:
      return "wedge";
    case 14:
      return "pyramid";
    case 25:
    case 29:
    case 72:
      return "curved hex";
    case 42:
      return "polyhedron";
    default:
      return "cell that is neither hex nor quad";
  }
}

class VtuReader {
 public:
  explicit VtuReader(const std::string& file) : xml_(file, "UnstructuredGrid") {
    for (const auto& element : xml_.elements()) {
      if (element.name == "Piece" && element.attribute("NumberOfCells") != "0") {
        if (piece_) {
          xml_.fail(element, "has several pieces", "merge them: in ParaView, filter Merge Blocks, then save");
        }
        piece_ = &element;
      }
      if (element.name == "DataArray" && (element.parent == "FieldData" || piece_)) {
        arrays_.emplace(element.parent + "/" + element.attribute("Name"), &element);
        if (element.parent == "Points" && !points_array_) points_array_ = &element;
      }
    }
    if (!piece_) xml_.fail(xml_.elements()[0], "holds no cells", "give a volume mesh");
  }

  HexMesh read() {
    read_points();
    read_cells();
    read_patches();
    return complete_boundary(std::move(points_), std::move(hexes_), std::move(patches_));
  }

 private:
  using Element = VtkXmlFile::Element;

  const Element& array(const std::string& key) const {
    const auto it = arrays_.find(key);
    if (it == arrays_.end()) xml_.fail(*piece_, fmt::format("array {} is missing", key), remake);
    return *it->second;
  }

  void read_points() {
    if (!points_array_) xml_.fail(*piece_, "the points are missing", remake);
    const std::vector<double> values = xml_.read_reals(*points_array_);
    if (values.size() % 3 != 0 || values.size() / 3 > std::numeric_limits<Index>::max() ||
        std::to_string(values.size() / 3) != piece_->attribute("NumberOfPoints")) {
      xml_.fail(
          *points_array_,
          fmt::format("{} coordinates for {} points", values.size(), piece_->attribute("NumberOfPoints")),
          remake);
    }
    points_.resize(values.size() / 3);
    for (std::size_t p = 0; p < points_.size(); ++p) {
      points_[p] = Vec3(values[3 * p], values[3 * p + 1], values[3 * p + 2]);
      if (!points_[p].allFinite()) {
        xml_.fail(*points_array_, fmt::format("point {} is not finite", p), remake);
      }
    }
  }

  // Sorts the cells into hexes and quads; cell_of_quad_ keeps which cell data belong to a quad.
  void read_cells() {
    const Element& types_array = array("Cells/types");
    const auto types = xml_.read_integers(types_array);
    const auto ends = xml_.read_integers(array("Cells/offsets"));
    const auto corners = xml_.read_integers(array("Cells/connectivity"));
    if (std::to_string(types.size()) != piece_->attribute("NumberOfCells") || ends.size() != types.size()) {
      xml_.fail(types_array,
                fmt::format("{} types and {} offsets for {} cells", types.size(), ends.size(),
                            piece_->attribute("NumberOfCells")),
                remake);
    }
    std::int64_t begin = 0;
    for (std::size_t c = 0; c < types.size(); ++c) {
      const std::int64_t end = ends[c], type = types[c];
      if (end < begin || end > static_cast<std::int64_t>(corners.size())) {
        xml_.fail(array("Cells/offsets"),
                  fmt::format("cell {} has points {} to {} of {}", c, begin, end, corners.size()), remake);
      }
      const bool is_hex = type == hexahedron || type == voxel, is_quad = type == quad || type == pixel;
      if (!is_hex && !is_quad && type != vertex && type != line) {
        xml_.fail(types_array, fmt::format("cell {} is a {} (VTK type {})", c, cell_name(type), type),
                  "flowcage reads meshes of linear hexes only");
      }
      if ((is_hex && end - begin != 8) || (is_quad && end - begin != 4)) {
        xml_.fail(array("Cells/offsets"), fmt::format("cell {} has {} points", c, end - begin), remake);
      }
      std::array<Index, 8> points{};
      for (std::int64_t i = begin; i < end && (is_hex || is_quad); ++i) {
        if (corners[i] < 0 || corners[i] >= static_cast<std::int64_t>(points_.size())) {
          xml_.fail(
              array("Cells/connectivity"),
              fmt::format("cell {} uses point {}, but there are {} points", c, corners[i], points_.size()),
              remake);
        }
        points[i - begin] = static_cast<Index>(corners[i]);
      }
      if (type == voxel || type == pixel) std::swap(points[2], points[3]);
      if (type == voxel) std::swap(points[6], points[7]);
      if (is_hex) hexes_.push_back(points);
      if (is_quad) {
        quads_.push_back({points[0], points[1], points[2], points[3]});
        cell_of_quad_.push_back(c);
      }
      begin = end;
    }
    if (hexes_.empty()) xml_.fail(types_array, "holds no hexes", "give a volume mesh of hexes");
    cells_ = types.size();
  }

  void read_patches() {
    std::vector<std::int64_t> ids(cells_, 0);
    const bool have_ids = arrays_.count("CellData/patchId") != 0;
    if (have_ids) {
      ids = xml_.read_integers(array("CellData/patchId"));
      if (ids.size() != cells_) {
        xml_.fail(array("CellData/patchId"), fmt::format("{} values for {} cells", ids.size(), cells_),
                  remake);
      }
    }
    std::map<std::int64_t, BoundaryPatch> by_id;
    for (const auto& [key, element] : arrays_) {
      constexpr std::string_view prefix = "FieldData/patch:";
      if (!key.starts_with(prefix)) continue;
      const auto value = xml_.read_integers(*element);
      if (value.size() != 1) xml_.fail(*element, "a patch's array must hold one number, its id", remake);
      const auto [it, fresh] = by_id.try_emplace(value[0]);
      if (!fresh) {
        xml_.fail(*element,
                  fmt::format("patches {} and {} have the same id {}", it->second.name,
                              key.substr(prefix.size()), value[0]),
                  "give each patch an id of its own");
      }
      it->second.name = key.substr(prefix.size());
    }
    for (std::size_t q = 0; q < quads_.size(); ++q) {
      const std::int64_t id = ids[cell_of_quad_[q]];
      const auto [it, fresh] = by_id.try_emplace(id);
      if (fresh) it->second.name = have_ids ? fmt::format("patch{}", id) : "boundary";
      it->second.quads.push_back(quads_[q]);
    }
    std::vector<std::int64_t> types;
    if (arrays_.count("FieldData/patchTypes") != 0) types = xml_.read_integers(array("FieldData/patchTypes"));
    for (auto& [id, patch] : by_id) {
      const bool known = id >= 0 && id < static_cast<std::int64_t>(types.size()) && types[id] >= 0 &&
                         types[id] <= static_cast<int>(PatchType::outlet);
      if (known) patch.type = static_cast<PatchType>(types[id]);
      patches_.push_back(std::move(patch));
    }
  }

  VtkXmlFile xml_;
  const Element* piece_ = nullptr;
  const Element* points_array_ = nullptr;
  std::map<std::string, const Element*> arrays_;
  std::vector<Vec3> points_;
  std::vector<HexPoints> hexes_;
  std::vector<std::array<Index, 4>> quads_;
  std::vector<std::size_t> cell_of_quad_;
  std::size_t cells_ = 0;
  std::vector<BoundaryPatch> patches_;
};

}  // namespace

HexMesh read_vtu(const std::filesystem::path& file) {
  return naming_file(file, [&] { return VtuReader(file.string()).read(); });
}

}  // namespace flowcage
