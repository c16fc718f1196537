#include "occ_bridge/internal/sniff.hpp"

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string_view>

#include "core/base/error.hpp"

namespace flowcage::occ {

namespace {

namespace fs = std::filesystem;

std::string read_at(std::ifstream& in, std::streamoff from, std::size_t count) {
  std::string text(count, '\0');
  in.clear();
  in.seekg(from);
  in.read(text.data(), static_cast<std::streamsize>(count));
  text.resize(static_cast<std::size_t>(std::max<std::streamsize>(0, in.gcount())));
  return text;
}

/// True where a line has an IGES section letter in column 73, followed by its sequence number.
bool is_iges_line(std::string_view line, char section) {
  if (line.size() < 74 || line[72] != section) return false;
  const std::string_view number = line.substr(73, 7);
  return std::ranges::any_of(number, [](unsigned char c) { return std::isdigit(c) != 0; }) &&
         std::ranges::all_of(number, [](unsigned char c) { return std::isdigit(c) != 0 || c == ' '; });
}

template <typename Test>
bool any_line(std::string_view text, const Test& test) {
  while (!text.empty()) {
    const std::size_t end = std::min(text.find_first_of("\r\n"), text.size());
    if (test(text.substr(0, end))) return true;
    text.remove_prefix(std::min(text.size(), end + 1));
  }
  return false;
}

std::string problem_of(const std::string& file, std::string_view head) {
  std::string extension = fs::path(file).extension().string();
  std::ranges::transform(extension, extension.begin(), [](unsigned char c) { return std::tolower(c); });
  if (head.find('\0') != std::string_view::npos) return "a binary file, neither STEP nor IGES nor BREP";
  if (extension == ".step" || extension == ".stp") {
    return "no STEP file (the first line must be ISO-10303-21;)";
  }
  if (extension == ".iges" || extension == ".igs") {
    return "no IGES file (no start and global section in column 73)";
  }
  return "neither STEP nor IGES nor BREP";
}

}  // namespace

Sniff sniff_cad_file(const std::string& file) {
  std::error_code code;
  const fs::file_status status = fs::status(file, code);
  if (!fs::exists(status)) throw input_error(file, 0, "no such file", "check the path");
  if (fs::is_directory(status)) throw input_error(file, 0, "a folder, not a CAD file", "name the file in it");
  std::ifstream in(file, std::ios::binary);
  if (!in)
    throw input_error(file, 0, std::string("cannot be opened: ") + std::strerror(errno),
                      "check its permissions");
  in.seekg(0, std::ios::end);
  const std::streamoff size = in.tellg();
  if (size <= 0) throw input_error(file, 0, "empty file", "export it again from the CAD system");

  constexpr std::size_t window = 16384;
  const std::string head = read_at(in, 0, window);
  const std::string tail =
      read_at(in, std::max<std::streamoff>(0, size - static_cast<std::streamoff>(window)), window);

  std::string_view start = head;
  if (start.starts_with("\xEF\xBB\xBF")) start.remove_prefix(3);  // byte order mark
  start.remove_prefix(std::min(start.find_first_not_of(" \t\r\n"), start.size()));
  if (start.starts_with("ISO-10303-21")) {
    if (tail.find("END-ISO-10303-21") == std::string::npos) {
      throw input_error(file, 0, "the STEP file is cut off (no END-ISO-10303-21 at its end)",
                        "copy or export it again");
    }
    return {CadFormat::step, ""};
  }
  if (start.starts_with("DBRep_DrawableShape") || start.starts_with("CASCADE Topology V") ||
      head.find("\nCASCADE Topology V") != std::string::npos) {
    return {CadFormat::brep, ""};
  }
  const auto has = [](std::string_view text, char section) {
    return any_line(text, [&](std::string_view line) { return is_iges_line(line, section); });
  };
  if (has(head, 'S') || has(head, 'G')) {
    if (!has(tail, 'T')) {
      throw input_error(file, 0, "the IGES file is cut off (no terminate section at its end)",
                        "copy or export it again");
    }
    return {CadFormat::iges, ""};
  }
  return {CadFormat::unknown, problem_of(file, head)};
}

}  // namespace flowcage::occ
