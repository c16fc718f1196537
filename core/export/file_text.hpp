#pragma once
#include <filesystem>
#include <string>
#include <string_view>

#include "core/base/error.hpp"

namespace flowcage {

/// The bytes of a whole regular file. Throws Error(input).
std::string read_whole_file(const std::filesystem::path& file);

/// ".obj" of "WING.OBJ".
std::string lower_extension(const std::filesystem::path& file);

/// The number of the line that holds byte `position`, counted from 1.
long line_of(std::string_view text, std::size_t position);

/// At most 40 printable characters from `position`, for messages.
std::string excerpt(std::string_view text, std::size_t position);

/// Calls read(); an Error(input) that does not begin with the file's name, because it concerns the mesh as a
/// whole, is thrown again with it.
template <typename Read>
auto naming_file(const std::filesystem::path& file, const Read& read) {
  try {
    return read();
  } catch (const Error& e) {
    if (e.kind() != ErrorKind::input || std::string(e.what()).starts_with(file.string())) throw;
    throw input_error(file.string(), 0, e.what(), e.remedy());
  }
}

}  // namespace flowcage
