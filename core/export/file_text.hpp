#pragma once
#include <filesystem>
#include <string>
#include <string_view>

namespace flowcage {

/// The bytes of a whole regular file. Throws Error(input).
std::string read_whole_file(const std::filesystem::path& file);

/// The number of the line that holds byte `position`, counted from 1.
long line_of(std::string_view text, std::size_t position);

/// At most 40 printable characters from `position`, for messages.
std::string excerpt(std::string_view text, std::size_t position);

}  // namespace flowcage
