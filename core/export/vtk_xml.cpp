#include "core/export/vtk_xml.hpp"

#include <fmt/format.h>

#include <utility>

namespace flowcage {

std::string AppendedArrays::declare(const std::string& type, const std::string& name, int components,
                                    std::vector<Part> parts) {
  std::string xml = fmt::format("<DataArray type=\"{}\" Name=\"{}\"", type, xml_escaped(name));
  if (components > 1) xml += fmt::format(" NumberOfComponents=\"{}\"", components);
  xml += fmt::format(" format=\"appended\" offset=\"{}\"/>\n", next_);
  next_ += header_bytes;
  for (const Part& part : parts) next_ += part.tuples * part.tuple_bytes;
  arrays_.push_back(std::move(parts));
  return xml;
}

void AppendedArrays::write(std::ostream& out) const {
  out << "<AppendedData encoding=\"raw\">\n_";
  for (const std::vector<Part>& parts : arrays_) {
    std::string size;
    std::uint64_t bytes = 0;
    for (const Part& part : parts) bytes += static_cast<std::uint64_t>(part.tuples * part.tuple_bytes);
    append_raw(size, bytes);
    out << size;
    for (const Part& part : parts) write_ranges(out, part.tuples, 32768, part.fill);
  }
  out << "\n</AppendedData>\n";
}

std::string xml_escaped(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    switch (c) {
      case '&':
        escaped += "&amp;";
        break;
      case '<':
        escaped += "&lt;";
        break;
      case '>':
        escaped += "&gt;";
        break;
      case '"':
        escaped += "&quot;";
        break;
      default:
        escaped += c;
    }
  }
  return escaped;
}

std::string vtk_file_header(const std::string& type, const std::string& version) {
  return fmt::format(
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"{}\" version=\"{}\" byte_order=\"LittleEndian\" "
      "header_type=\"UInt64\">\n",
      type, version);
}

std::string patch_field_data(const std::vector<std::string>& names, const std::vector<int>& types) {
  if (names.empty()) return {};
  std::string xml = "<FieldData>\n";
  for (std::size_t i = 0; i < names.size(); ++i) {
    xml += fmt::format(
        "<DataArray type=\"Int32\" Name=\"patch:{}\" NumberOfTuples=\"1\" format=\"ascii\">{}</DataArray>\n",
        xml_escaped(names[i]), i);
  }
  if (!types.empty()) {
    xml += fmt::format(
        "<DataArray type=\"Int32\" Name=\"patchTypes\" NumberOfTuples=\"{}\" "
        "format=\"ascii\">{}</DataArray>\n",
        types.size(), fmt::join(types, " "));
  }
  return xml + "</FieldData>\n";
}

}  // namespace flowcage
