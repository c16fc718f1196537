// A PNG file as it is read again: independent of what wrote it.
#pragma once
#include <png.h>

#include <array>
#include <cstdint>
#include <filesystem>
#include <set>
#include <vector>

namespace flowcage::tests {

struct PngImage {
  int width = 0, height = 0;  ///< 0: no readable PNG
  std::vector<std::array<std::uint8_t, 3>> pixels{};

  std::size_t colors() const { return std::set(pixels.begin(), pixels.end()).size(); }
};

inline PngImage read_png(const std::filesystem::path& file) {
  png_image header{};
  header.version = PNG_IMAGE_VERSION;
  if (png_image_begin_read_from_file(&header, file.c_str()) == 0) return {};
  header.format = PNG_FORMAT_RGB;
  PngImage image{static_cast<int>(header.width), static_cast<int>(header.height)};
  image.pixels.resize(std::size_t{header.width} * header.height);
  if (png_image_finish_read(&header, nullptr, image.pixels.data(), 0, nullptr) == 0) return {};
  return image;
}

}  // namespace flowcage::tests
