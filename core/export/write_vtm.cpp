#include "core/export/write_vtm.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "core/export/patch_names.hpp"
#include "core/export/vtk_xml.hpp"

namespace flowcage {
namespace {

using Ijk = std::array<Index, 3>;

/// Number n of a lattice of these sizes, i fastest.
Ijk lattice_place(Offset n, const Ijk& size) {
  return {static_cast<Index>(n % size[0]), static_cast<Index>(n / size[0] % size[1]),
          static_cast<Index>(n / size[0] / size[1])};
}

class PieceWriter {
 public:
  PieceWriter(AtomicFolder& folder, const BlockMesh& mesh, const VtuFields& fields)
      : folder_(folder), mesh_(mesh), fields_(fields) {}

  void block(const std::string& file, const StructuredBlock& block) const {
    const Ijk cells = block.cells(), points{cells[0] + 1, cells[1] + 1, cells[2] + 1};
    const Offset point_count = Offset{points[0]} * points[1] * points[2];
    const Offset cell_count = Offset{cells[0]} * cells[1] * cells[2];
    const auto point = [&](Offset n) { return point_number(mesh_, block, lattice_place(n, points)); };
    const auto cell = [&](Offset n) { return cell_number(mesh_, block, lattice_place(n, cells)); };
    AppendedArrays arrays;
    std::string xml = vtk_file_header("StructuredGrid");
    const std::string extent = fmt::format("0 {} 0 {} 0 {}", cells[0], cells[1], cells[2]);
    xml += fmt::format("<StructuredGrid WholeExtent=\"{0}\">\n<Piece Extent=\"{0}\">\n", extent);
    xml += point_data(arrays, point_count, point);
    xml += "<CellData GlobalIds=\"cellId\">\n" +
           arrays.declare("Int32", "cellId", 1, {computed_part<Index>(cell_count, cell)});
    for (const VtuCellField& field : fields_.cell_fields) {
      xml += arrays.declare("Float32", field.name, 1, {computed_part<float>(cell_count, [&](Offset n) {
                              return field.cells.empty() ? no_number : field.cells[cell(n)];
                            })});
    }
    xml += "</CellData>\n" + points_element(arrays, point_count, point) + "</Piece>\n</StructuredGrid>\n";
    store(file, xml, arrays);
  }

  /// `first_quad`: of the patch among the boundary quads of all patches.
  void patch(const std::string& file, std::size_t number, Offset first_quad,
             const std::string& field_data) const {
    const BoundaryPatch& patch = mesh_.patches()[number];
    std::vector<Index> used;  // the patch's points, ascending
    for (const auto& quad : patch.quads) used.insert(used.end(), quad.begin(), quad.end());
    std::sort(used.begin(), used.end());
    used.erase(std::unique(used.begin(), used.end()), used.end());
    std::vector<Index> own(mesh_.points().size(), no_index);
    for (std::size_t i = 0; i < used.size(); ++i) own[used[i]] = static_cast<Index>(i);

    const auto quads = static_cast<Offset>(patch.quads.size()), points = static_cast<Offset>(used.size());
    const auto point = [&](Offset n) { return used[n]; };
    AppendedArrays arrays;
    std::string xml = vtk_file_header("PolyData") + "<PolyData>\n" + field_data +
                      fmt::format(
                          "<Piece NumberOfPoints=\"{}\" NumberOfVerts=\"0\" NumberOfLines=\"0\" "
                          "NumberOfStrips=\"0\" NumberOfPolys=\"{}\">\n",
                          points, quads);
    xml += point_data(arrays, points, point);
    xml += "<CellData>\n" +
           arrays.declare("Int32", "patchId", 1,
                          {computed_part<Index>(quads, [&](Offset) { return static_cast<Index>(number); })});
    for (const VtuCellField& field : fields_.cell_fields) {
      xml += arrays.declare("Float32", field.name, 1, {computed_part<float>(quads, [&](Offset q) {
                              if (!field.boundary.empty()) return field.boundary[first_quad + q];
                              return field.cells.empty() ? no_number : field.cells[patch.owner[q]];
                            })});
    }
    xml += "</CellData>\n" + points_element(arrays, points, point) + "<Polys>\n" +
           arrays.declare(
               "Int32", "connectivity", 1,
               {computed_part<Index>(4 * quads, [&](Offset n) { return own[patch.quads[n / 4][n % 4]]; })}) +
           arrays.declare("Int64", "offsets", 1,
                          {computed_part<Offset>(quads, [](Offset q) { return 4 * (q + 1); })}) +
           "</Polys>\n</Piece>\n</PolyData>\n";
    store(file, xml, arrays);
  }

 private:
  static constexpr float no_number = std::numeric_limits<float>::quiet_NaN();

  /// point(n) is the mesh's number of the piece's point n.
  template <typename Point>
  std::string point_data(AppendedArrays& arrays, Offset count, const Point& point) const {
    std::string xml = "<PointData GlobalIds=\"pointId\">\n" +
                      arrays.declare("Int32", "pointId", 1, {computed_part<Index>(count, point)});
    for (const VtkPointField& field : fields_.point_fields) {
      const auto values = field.values;
      xml += arrays.declare(
          "Float32", field.name, 1,
          {computed_part<float>(count, [values, point](Offset n) { return values[point(n)]; })});
    }
    return xml + "</PointData>\n";
  }

  template <typename Point>
  std::string points_element(AppendedArrays& arrays, Offset count, const Point& point) const {
    const auto fill = [this, point](Offset begin, Offset end, std::string& bytes) {
      for (Offset n = begin; n < end; ++n) {
        const Vec3& p = mesh_.points()[point(n)];
        for (int d = 0; d < 3; ++d) append_raw(bytes, p[d]);
      }
    };
    return "<Points>\n" + arrays.declare("Float64", "Points", 3, {{count, sizeof(Vec3), fill}}) +
           "</Points>\n";
  }

  void store(const std::string& name, const std::string& xml, const AppendedArrays& arrays) const {
    const auto file = folder_.create(name);
    *file << xml;
    arrays.write(*file);
    *file << "</VTKFile>\n";
    file->close();
  }

  AtomicFolder& folder_;
  const BlockMesh& mesh_;
  const VtuFields& fields_;
};

}  // namespace

std::vector<std::string> write_vtm(std::ostream& index, AtomicFolder& folder, const std::string& folder_name,
                                   const BlockMesh& mesh, const StructuredBlocks& blocks,
                                   const VtuFields& fields, Progress* progress) {
  auto [names, notes] = legal_patch_names(mesh);
  std::vector<int> types;
  Offset quads = 0;
  for (const BoundaryPatch& patch : mesh.patches()) {
    types.push_back(static_cast<int>(patch.type));
    quads += static_cast<Offset>(patch.quads.size());
  }
  check_field_sizes(fields, mesh, quads);
  const std::string field_data = patch_field_data(names, types);
  const PieceWriter writer(folder, mesh, fields);
  std::string xml = vtk_file_header("vtkMultiBlockDataSet") + "<vtkMultiBlockDataSet>\n";
  const auto group = [&](int number, const char* name) {
    xml += fmt::format("<Block index=\"{}\" name=\"{}\">\n", number, name);
  };
  const auto piece = [&](std::size_t number, const std::string& name, const std::string& file) {
    xml += fmt::format("<DataSet index=\"{}\" name=\"{}\" file=\"{}/{}\"/>\n", number, xml_escaped(name),
                       xml_escaped(folder_name), file);
  };
  group(0, "blocks");
  for (std::size_t b = 0; b < blocks.blocks.size(); ++b) {
    if (progress)
      progress->step("write VTM", static_cast<double>(b) / static_cast<double>(blocks.blocks.size()));
    const std::string name = fmt::format("block{}", b + 1);
    writer.block(name + ".vts", blocks.blocks[b]);
    piece(b, name, name + ".vts");
  }
  xml += "</Block>\n";
  group(1, "patches");
  Offset first_quad = 0;
  for (std::size_t i = 0; i < names.size(); ++i) {
    writer.patch(names[i] + ".vtp", i, first_quad, field_data);
    piece(i, names[i], names[i] + ".vtp");
    first_quad += static_cast<Offset>(mesh.patches()[i].quads.size());
  }
  index << xml << "</Block>\n</vtkMultiBlockDataSet>\n</VTKFile>\n";
  if (progress) progress->step("write VTM", 1);
  return std::move(notes);
}

std::filesystem::path vtm_folder(const std::filesystem::path& file) {
  return file.parent_path() / (file.stem().string() + "_vtm");
}

std::vector<std::string> vtm_entries(const std::filesystem::path& folder) {
  std::vector<std::string> names;
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator(folder, ignored)) {
    const auto extension = entry.path().extension();
    if (extension == ".vts" || extension == ".vtp") names.push_back(entry.path().filename().string());
  }
  return names;
}

}  // namespace flowcage
