#include "core/export/write_vtu.hpp"

#include <fmt/format.h>

#include <limits>
#include <utility>

#include "core/export/patch_names.hpp"
#include "core/export/vtk_xml.hpp"
#include "core/mesh/visit_cells.hpp"

namespace flowcage {
namespace {

using Part = AppendedArrays::Part;
constexpr std::uint8_t vtk_quad = 9, vtk_hexahedron = 12;

void require_size(const std::string& name, std::size_t size, std::size_t wanted) {
  if (size == wanted) return;
  throw Error(ErrorKind::internal, fmt::format("field {} has {} values for {} places", name, size, wanted),
              "report this to the authors of flowcage");
}

class VtuWriter {
 public:
  VtuWriter(const HexView& mesh, const VtuFields& fields) : mesh_(mesh), fields_(fields) {
    for (const BoundaryPatch& patch : mesh.patches()) quads_ += static_cast<Offset>(patch.quads.size());
  }

  std::vector<std::string> write(std::ostream& out) {
    check_field_sizes(fields_, mesh_, quads_);
    std::vector<int> types;
    for (const BoundaryPatch& patch : mesh_.patches()) types.push_back(static_cast<int>(patch.type));
    auto [names, notes] = legal_patch_names(mesh_);
    std::string xml = vtk_file_header("UnstructuredGrid") + "<UnstructuredGrid>\n" +
                      patch_field_data(names, types) +
                      fmt::format("<Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">\n",
                                  mesh_.points().size(), mesh_.cell_count() + quads_);
    AppendedArrays arrays;
    xml += "<PointData>\n";
    for (const VtkPointField& field : fields_.point_fields) {
      xml += arrays.declare("Float32", field.name, 1, {array_part(field.values)});
    }
    xml += "</PointData>\n<CellData>\n" + arrays.declare("Int32", "patchId", 1, patch_ids());
    for (const VtuCellField& field : fields_.cell_fields) {
      xml += arrays.declare("Float32", field.name, 1, cell_field(field));
    }
    xml += "</CellData>\n<Points>\n" + arrays.declare("Float64", "Points", 3, {array_part(mesh_.points())}) +
           "</Points>\n<Cells>\n" + arrays.declare("Int32", "connectivity", 1, connectivity()) +
           cell_ends(arrays) + arrays.declare("UInt8", "types", 1, types_of_cells()) +
           "</Cells>\n</Piece>\n</UnstructuredGrid>\n";
    out << xml;
    arrays.write(out);
    out << "</VTKFile>\n";
    return std::move(notes);
  }

 private:
  std::vector<Part> connectivity() const {
    std::vector<Part> parts;
    parts.push_back(
        {mesh_.cell_count(), sizeof(HexPoints), [this](Offset begin, Offset end, std::string& bytes) {
           visit_cells(mesh_, begin, end, [&](Offset, const HexPoints& cell) { append_raw(bytes, cell); });
         }});
    for (const BoundaryPatch& patch : mesh_.patches()) parts.push_back(array_part(std::span(patch.quads)));
    return parts;
  }

  // VTK's "offsets": where each cell's points end.
  std::string cell_ends(AppendedArrays& arrays) const {
    const Offset cells = mesh_.cell_count();
    const auto end_of_hex = [](Offset c) { return 8 * (c + 1); };
    const auto end_of_quad = [cells](Offset q) { return 8 * cells + 4 * (q + 1); };
    if (8 * cells + 4 * quads_ <= std::numeric_limits<std::int32_t>::max()) {
      return arrays.declare(
          "Int32", "offsets", 1,
          {computed_part<std::int32_t>(cells, end_of_hex), computed_part<std::int32_t>(quads_, end_of_quad)});
    }
    return arrays.declare(
        "Int64", "offsets", 1,
        {computed_part<std::int64_t>(cells, end_of_hex), computed_part<std::int64_t>(quads_, end_of_quad)});
  }

  std::vector<Part> types_of_cells() const {
    return {computed_part<std::uint8_t>(mesh_.cell_count(), [](Offset) { return vtk_hexahedron; }),
            computed_part<std::uint8_t>(quads_, [](Offset) { return vtk_quad; })};
  }

  std::vector<Part> patch_ids() const {
    std::vector<Part> parts{computed_part<Index>(mesh_.cell_count(), [](Offset) { return no_index; })};
    for (std::size_t i = 0; i < mesh_.patches().size(); ++i) {
      parts.push_back(computed_part<Index>(static_cast<Offset>(mesh_.patches()[i].quads.size()),
                                           [i](Offset) { return static_cast<Index>(i); }));
    }
    return parts;
  }

  std::vector<Part> cell_field(const VtuCellField& field) const {
    const auto none = [](Offset) { return std::numeric_limits<float>::quiet_NaN(); };
    std::vector<Part> parts;
    if (field.cells.empty()) {
      parts.push_back(computed_part<float>(mesh_.cell_count(), none));
    } else {
      parts.push_back(array_part(field.cells));
    }
    if (!field.boundary.empty()) {
      parts.push_back(array_part(field.boundary));
      return parts;
    }
    for (const BoundaryPatch& patch : mesh_.patches()) {
      const auto count = static_cast<Offset>(patch.quads.size());
      if (field.cells.empty()) {
        parts.push_back(computed_part<float>(count, none));
      } else {
        parts.push_back(
            computed_part<float>(count, [&patch, &field](Offset q) { return field.cells[patch.owner[q]]; }));
      }
    }
    return parts;
  }

  const HexView& mesh_;
  const VtuFields& fields_;
  Offset quads_ = 0;
};

}  // namespace

void check_field_sizes(const VtuFields& fields, const HexView& mesh, Offset quads) {
  for (const VtkPointField& field : fields.point_fields) {
    require_size(field.name, field.values.size(), mesh.points().size());
  }
  for (const VtuCellField& field : fields.cell_fields) {
    if (!field.cells.empty()) {
      require_size(field.name, field.cells.size(), static_cast<std::size_t>(mesh.cell_count()));
    }
    if (!field.boundary.empty()) {
      require_size(field.name, field.boundary.size(), static_cast<std::size_t>(quads));
      continue;
    }
    for (const BoundaryPatch& patch : mesh.patches()) {  // a quad takes its owner's value
      require_size("owner of patch " + patch.name, patch.owner.size(), patch.quads.size());
    }
  }
}

std::vector<std::string> write_vtu(std::ostream& out, const HexView& mesh, const VtuFields& fields,
                                   Progress* progress) {
  if (progress) progress->step("write VTU", 0);
  std::vector<std::string> notes = VtuWriter(mesh, fields).write(out);
  if (progress) progress->step("write VTU", 1);
  return notes;
}

}  // namespace flowcage
