#include "core/export/write_surface.hpp"

#include <fmt/format.h>

#include <limits>
#include <utility>

#include "core/export/patch_names.hpp"
#include "core/export/vtk_xml.hpp"

namespace flowcage {
namespace {

void append_triangle(std::string& bytes, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 normal = (b - a).cross(c - a).normalized();
  for (const Vec3* v : {&normal, &a, &b, &c}) {
    for (int d = 0; d < 3; ++d) append_raw(bytes, static_cast<float>((*v)[d]));
  }
  append_raw(bytes, std::uint16_t{0});
}

}  // namespace

std::vector<std::string> write_vtp(std::ostream& out, const Cage& surface,
                                   const std::vector<VtkPointField>& point_fields) {
  auto [names, notes] = legal_patch_names(surface.patch_names);
  const auto& faces = surface.faces;
  std::string xml =
      vtk_file_header("PolyData") + "<PolyData>\n" + patch_field_data(names, {}) +
      fmt::format(
          "<Piece NumberOfPoints=\"{}\" NumberOfVerts=\"0\" NumberOfLines=\"0\" NumberOfStrips=\"0\" "
          "NumberOfPolys=\"{}\">\n<PointData>\n",
          surface.points.size(), faces.size());
  AppendedArrays arrays;
  for (const VtkPointField& field : point_fields) {
    if (field.values.size() != surface.points.size()) {
      throw Error(ErrorKind::internal,
                  fmt::format("field {} has {} values for {} points", field.name, field.values.size(),
                              surface.points.size()),
                  "report this to the authors of flowcage");
    }
    xml += arrays.declare("Float32", field.name, 1, {array_part(field.values)});
  }
  xml += "</PointData>\n<CellData>\n";
  xml += arrays.declare("Int32", "patchId", 1, {array_part(std::span<const Index>(surface.face_patch))});
  xml +=
      "</CellData>\n<Points>\n" +
      arrays.declare("Float64", "Points", 3, {array_part(std::span<const Vec3>(surface.points))}) +
      "</Points>\n<Polys>\n" +
      arrays.declare("Int32", "connectivity", 1, {array_part(std::span<const Index>(faces.values))}) +
      arrays.declare("Int64", "offsets", 1, {array_part(std::span<const Offset>(faces.offsets).subspan(1))}) +
      "</Polys>\n</Piece>\n</PolyData>\n";
  out << xml;
  arrays.write(out);
  out << "</VTKFile>\n";
  return std::move(notes);
}

void write_stl(std::ostream& out, const Cage& surface) {
  Offset triangles = 0;
  for (Index f = 0; f < surface.faces.size(); ++f) triangles += surface.faces.row_size(f) - 2;
  if (triangles > Offset{std::numeric_limits<std::uint32_t>::max()}) {
    throw Error(ErrorKind::output, fmt::format("{} triangles are more than an STL file holds", triangles),
                "write VTP instead");
  }
  // Readers take a file for ASCII if it begins with "solid".
  std::string head = "binary STL of flowcage";
  head.resize(80, ' ');
  append_raw(head, static_cast<std::uint32_t>(triangles));
  out << head;
  write_ranges(out, surface.faces.size(), 8192, [&](Offset begin, Offset end, std::string& bytes) {
    for (auto f = static_cast<Index>(begin); f < end; ++f) {
      const auto row = surface.faces[f];
      const auto p = [&](std::size_t i) -> const Vec3& { return surface.points[row[i]]; };
      const bool other = row.size() == 4 && (p(1) - p(3)).squaredNorm() < (p(0) - p(2)).squaredNorm();
      if (other) {
        append_triangle(bytes, p(0), p(1), p(3));
        append_triangle(bytes, p(1), p(2), p(3));
        continue;
      }
      for (std::size_t i = 1; i + 1 < row.size(); ++i) append_triangle(bytes, p(0), p(i), p(i + 1));
    }
  });
}

}  // namespace flowcage
