#include "cli/report/write_png.hpp"

#include <png.h>

#include "core/base/error.hpp"

namespace flowcage {

void write_png(std::ostream& out, const Image& image) {
  png_image header{};
  header.version = PNG_IMAGE_VERSION;
  header.format = PNG_FORMAT_RGB;
  header.width = static_cast<png_uint_32>(image.width);
  header.height = static_cast<png_uint_32>(image.height);
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(header);
  std::vector<char> bytes(size);
  if (png_image_write_to_memory(&header, bytes.data(), &size, 0, image.pixels.data(), 0, nullptr) == 0) {
    throw Error(ErrorKind::internal, std::string("PNG: ") + header.message, "report this defect");
  }
  out.write(bytes.data(), static_cast<std::streamsize>(size));
}

}  // namespace flowcage
