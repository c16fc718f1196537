#pragma once
#include <ostream>

#include "cli/report/raster.hpp"

namespace flowcage {

/// Writes a PNG of 8 bits a channel, without times or comments. Throws Error(internal) if libpng fails, and
/// what the stream throws.
void write_png(std::ostream& out, const Image& image);

}  // namespace flowcage
