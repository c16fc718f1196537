#include "core/export/file_text.hpp"

#include <algorithm>
#include <cerrno>
#include <fstream>
#include <system_error>

#include "core/base/error.hpp"

namespace flowcage {

std::string read_whole_file(const std::filesystem::path& file) {
  std::error_code failed;
  const auto status = std::filesystem::status(file, failed);
  if (!std::filesystem::exists(status)) {
    throw input_error(file.string(), 0, "no such file", "check the name");
  }
  if (std::filesystem::is_directory(status)) {
    throw input_error(file.string(), 0, "is a folder, not a file", "name a file in it");
  }
  errno = 0;
  std::ifstream stream(file, std::ios::binary);
  std::string text;
  if (stream) {
    const auto size = std::filesystem::file_size(file, failed);
    if (!failed) {
      text.resize(size);
      stream.read(text.data(), static_cast<std::streamsize>(size));
      text.resize(static_cast<std::size_t>(stream.gcount()));
      if (text.size() == size) return text;
    }
  }
  throw input_error(file.string(), 0,
                    "cannot be read: " + std::generic_category().message(errno != 0 ? errno : EIO),
                    "check that it is a regular file which you may read");
}

long line_of(std::string_view text, std::size_t position) {
  const auto end = text.begin() + static_cast<std::ptrdiff_t>(std::min(position, text.size()));
  return 1 + static_cast<long>(std::count(text.begin(), end, '\n'));
}

std::string excerpt(std::string_view text, std::size_t position) {
  std::string result;
  for (std::size_t i = position; i < text.size() && result.size() < 40; ++i) {
    const auto c = static_cast<unsigned char>(text[i]);
    if (c == '\n' || c == '\r') break;
    result += c >= 32 && c < 127 ? text[i] : '?';
  }
  return result;
}

std::string lower_extension(const std::filesystem::path& file) {
  std::string extension = file.extension().string();
  for (char& c : extension) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  return extension;
}

}  // namespace flowcage
